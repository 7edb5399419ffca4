//! Tiles of a model of any size: 3D Tiles, from a plan whose tasks any number of processes may do.
//!
//! Reading order: `request` and `placement`, which say how tiles are to be; `model`, which opens
//! inputs; `room`, on the disk; `method`, by which tiles are made coarser; `hold`, the right to work
//! in a folder; `opened`, the tasks of a plan; `output` and `result`, where tiles go; `report` and
//! `fault`.

mod fault;
mod hold;
mod method;
mod model;
mod opened;
mod output;
mod placement;
mod report;
mod request;
mod result;
mod room;

use std::fs;
use std::io;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use meshlod_mesh::Bounds;
use meshlod_tiles::TilesError;
use meshlod_tiles::archive::is_archive;
use meshlod_tiles::errors::find_errors;
use meshlod_tiles::folder::Folder;
use meshlod_tiles::layout::Layout;
use meshlod_tiles::plan::{Look, Plan, TileOptions};
use meshlod_tiles::review::review;
use meshlod_tiles::source::{Source, Triangles};
use meshlod_tiles::survey::Survey;
use meshlod_tiles::tileset::finish;
use rayon::ThreadPoolBuilder;
use rayon::prelude::*;

use crate::jobs::{About, JobError, Remark, Watch};
use fault::{failure, failure_of_input};
use hold::Hold;
use method::Proven;
use result::{write_archive, write_folder};
use room::{Room, check_room};

pub use hold::{PlanFolder, TileRun};
pub use model::{TileFileError, TileFiles, TileModel};
pub use opened::TilePlan;
pub use output::{check_tiles_folder, tile_plan_folder};
pub use placement::{Globe, Up};
pub use report::{TileLevel, TilesReport, TilesetReport};
pub use request::TilesRequest;

/// Model that tiles are made of.
#[derive(Clone, Copy)]
pub struct TileInput<'a> {
    /// Its triangles.
    pub source: &'a dyn Source,
    /// Its materials and images.
    pub look: &'a Look,
    /// Text that is different for another model: what was made of the same one goes on.
    pub key: &'a str,
}

/// Makes the tiles of a model: a folder of `tileset.json` and what it names, or an archive of these
/// where the name of `out` ends in `.3tz`.
///
/// The work is planned and done in a folder `.plan` inside, or one beside the archive, which is
/// removed at the end. A call that was ended goes on from there. The bytes of the tileset depend on
/// the model and the request alone, whatever the number of threads.
///
/// # Errors
/// A request that has no meaning, a model without faces or extent, a disk with less room than is
/// needed, errors of the system, and a folder that holds other files or that another process is
/// working on.
pub fn tiles(
    input: TileInput<'_>,
    out: &Path,
    request: &TilesRequest,
    watch: &dyn Watch,
) -> Result<TilesReport, JobError> {
    let options = request.options()?;
    check_tiles_folder(out)?;
    let folder = Folder::new(tile_plan_folder(out));
    refuse_foreign(&folder)?;
    let _hold = Hold::new_plan(PlanFolder::new(folder.path()))?;
    let threads = request.threads(rayon::current_num_threads());
    let room = Room::OfRun { threads };
    if let Err(error) = plan_in_hold(input, &folder, (&options, room), watch) {
        // Nothing is left that a next run could go on from.
        folder.remove();
        if !is_archive(out) {
            let _ = fs::remove_dir(out);
        }
        return Err(error);
    }
    let plan = TilePlan::open(folder.path())?;
    plan.take_back(out);
    watch.stage("making tiles");
    let work = Work { plan: &plan, watch, done: AtomicUsize::new(0) };
    let pool = ThreadPoolBuilder::new().num_threads(threads).build().map_err(JobError::output)?;
    pool.install(|| work.make(plan.tasks() - 1, false))?;
    let report = assemble_in_hold(&plan, out, watch)?;
    folder.remove();
    Ok(report)
}

/// Plans the tiles of a model in a folder, unless that is done: counts and cuts its faces, and finds
/// the errors of the levels. Returns the number of tasks.
///
/// # Errors
/// As [`tiles`].
pub fn plan_tiles(
    input: TileInput<'_>,
    place: PlanFolder<'_>,
    request: &TilesRequest,
    watch: &dyn Watch,
) -> Result<usize, JobError> {
    let folder = Folder::new(place.path);
    let options = request.options()?;
    refuse_foreign(&folder)?;
    let _hold = Hold::new_plan(place)?;
    let planned = plan_in_hold(input, &folder, (&options, Room::OfSteps), watch);
    if planned.is_err() {
        folder.remove();
    }
    planned
}

/// Fails if a folder holds anything but files of a plan.
fn refuse_foreign(folder: &Folder) -> Result<(), JobError> {
    if !folder.is_foreign() {
        return Ok(());
    }
    let path = folder.path().display();
    let reason = format!("{path}: holds other files; name a new folder for the plan");
    Err(JobError::request("", reason))
}

/// Plans the tiles of a model in a folder that no other process works in.
fn plan_in_hold(
    input: TileInput<'_>,
    folder: &Folder,
    (options, room): (&TileOptions, Room),
    watch: &dyn Watch,
) -> Result<usize, JobError> {
    // A damaged plan is made again.
    if let Some(plan) = folder.plan().ok().flatten()
        && plan.key == input.key
        && plan.options == *options
    {
        return Ok(plan.tasks.len());
    }
    folder.forget_plan();
    folder.forget_tiles();
    folder.make().map_err(failure)?;
    watch.stage("counting faces");
    let source = Watched { source: input.source, watch };
    let ended = |error| if watch.is_cancelled() { JobError::Cancelled } else { failure(error) };
    let survey = Survey::of(&source, options.most_faces).map_err(ended)?;
    let model: (&dyn Source, _) = (&source, input.look);
    check_room(folder.path(), (&survey, model, options), room, watch)?;
    note_large_images(input.look, watch);
    watch.stage("cutting into tiles");
    let scratch = folder.scratch();
    let part = folder.path().join(format!(".pieces.{}-0", std::process::id()));
    let plan = Plan::of_survey(survey, model, options, &part).map_err(|error| {
        let _ = fs::remove_file(&part);
        ended(error)
    })?;
    fs::rename(&part, &scratch).map_err(|error| failure(TilesError::system(&scratch, error)))?;
    watch.stage("finding the errors of levels");
    let errors = find_errors(&plan, folder, &Proven::new(&plan)).map_err(failure)?;
    let plan = Plan { errors, key: input.key.to_owned(), ..plan };
    folder.write_plan(&plan, &input.look.images).map_err(failure)?;
    Ok(plan.tasks.len())
}

/// Remarks on images that are used at a lower resolution than they have.
fn note_large_images(look: &Look, watch: &dyn Watch) {
    let count = look.large_images();
    if count > 0 {
        let text = format!("used at a lower resolution: {} above 4096 by 4096", images(count));
        watch.remark(&Remark::new(About::Input, text));
    }
}

/// Does a task of a plan, unless it is done.
///
/// Any number of processes may do tasks at a time, also the same one: they write the same bytes.
/// # Errors
/// A task that there is not or that needs another one first, files that are not as they were
/// written, errors of the system, and a plan that is being made or finished.
pub fn run_tile_task(folder: &Path, task: usize) -> Result<(), JobError> {
    TilePlan::open(folder)?.run(task)
}

/// Checks that all tasks of a plan are done and that their tiles meet at every level, and makes the
/// tileset of them, in a folder or as an archive. The plan is removed.
///
/// # Errors
/// As [`assemble_tiles`].
pub fn finish_tiles(folder: &Path, out: &Path, watch: &dyn Watch) -> Result<TilesReport, JobError> {
    check_tiles_folder(out)?;
    let folder = Folder::new(folder);
    let _hold = Hold::alone(PlanFolder::new(folder.path()))?;
    let report = assemble_in_hold(&TilePlan::open(folder.path())?, out, watch)?;
    folder.remove();
    Ok(report)
}

/// Does what [`finish_tiles`] does, but keeps the plan: a call that was ended, by whatever, may be
/// repeated until [`TileRun::remove`] or [`remove_tile_plan`].
///
/// # Errors
/// A task that is not done, tiles that do not meet, files that are not as they were written, a folder
/// that holds other files, errors of the system, and a plan that another process is working on.
pub fn assemble_tiles(
    place: PlanFolder<'_>,
    out: &Path,
    watch: &dyn Watch,
) -> Result<TilesReport, JobError> {
    check_tiles_folder(out)?;
    let _hold = Hold::alone(place)?;
    assemble_in_hold(&TilePlan::open(place.path)?, out, watch)
}

/// Makes the tileset of a plan that no other process works on.
fn assemble_in_hold(
    opened: &TilePlan,
    out: &Path,
    watch: &dyn Watch,
) -> Result<TilesReport, JobError> {
    watch.stage("checking");
    opened.take_back(out);
    let (plan, folder) = (&opened.plan, &opened.folder);
    let finished = finish(plan, folder).map_err(failure)?;
    let written = match is_archive(out) {
        true => write_archive(&finished, folder, out),
        false => write_folder(&finished, folder, out),
    };
    written.map_err(failure)?;
    let lost = finished.lost_images(plan);
    if !lost.is_empty() {
        let text = format!("cannot be decoded, left out: {} ({})", images(lost.len()), few(&lost));
        watch.remark(&Remark::new(About::Output, text));
    }
    Ok(TilesReport::of(plan, &finished))
}

/// Removes the files of a plan, and its folder if nothing else is in it, unless another process is
/// working on it.
pub fn remove_tile_plan(folder: &Path) {
    let folder = Folder::new(folder);
    if let Ok(_hold) = Hold::alone(PlanFolder::new(folder.path())) {
        folder.remove();
    }
}

fn images(count: usize) -> String {
    format!("{count} image{}", if count == 1 { "" } else { "s" })
}

/// Lists the first of some names.
fn few(names: &[&str]) -> String {
    let shown = names[..names.len().min(3)].join(", ");
    if names.len() > 3 { shown + ", …" } else { shown }
}

/// Reads a tileset and all its tiles again, and checks them.
///
/// # Errors
/// A folder or archive without a tileset of ours.
pub fn check_tileset(path: &Path, watch: &dyn Watch) -> Result<TilesetReport, JobError> {
    watch.stage("reading tiles");
    Ok(TilesetReport::of(review(path).map_err(failure_of_input)?))
}

/// Source whose passes end when the job is cancelled.
struct Watched<'a> {
    source: &'a dyn Source,
    watch: &'a dyn Watch,
}

impl Source for Watched<'_> {
    fn layout(&self) -> &Layout {
        self.source.layout()
    }

    fn bounds(&self) -> io::Result<Bounds> {
        self.source.bounds()
    }

    fn triangles(&self, take: &mut dyn FnMut(&Triangles) -> io::Result<()>) -> io::Result<()> {
        self.source.triangles(&mut |some| match self.watch.is_cancelled() {
            true => Err(io::Error::other("cancelled")),
            false => take(some),
        })
    }
}

/// Work on all tasks of a plan.
struct Work<'a> {
    plan: &'a TilePlan,
    watch: &'a dyn Watch,
    done: AtomicUsize,
}

impl Work<'_> {
    /// Makes a tile after those that it is made from, whose meshes are then removed. Its own is
    /// wanted unless nothing is made from it.
    fn make(&self, task: usize, is_part: bool) -> Result<(), JobError> {
        if self.watch.is_cancelled() {
            return Err(JobError::Cancelled);
        }
        // Parts of what stands may be damaged, too.
        let stands = self.plan.stands(task, is_part)?;
        let make = |&part: &usize| self.make(part, !stands);
        self.plan.parts(task).par_iter().with_max_len(1).try_for_each(make)?;
        if !stands {
            self.plan.run_in_hold(task)?;
        }
        self.plan.forget_parts_in_hold(task);
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        self.watch.step(done, Some(self.plan.tasks()));
        Ok(())
    }
}

#[cfg(test)]
mod tests;
