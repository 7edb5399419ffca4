//! Tiles of a model of any size: 3D Tiles, from a plan whose tasks any number of processes may do.

mod fault;
mod hold;
mod method;
mod placement;
mod report;
mod request;
mod result;
mod room;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use meshlod_tiles::TilesError;
use meshlod_tiles::archive::is_archive;
use meshlod_tiles::errors::find_errors;
use meshlod_tiles::folder::Folder;
use meshlod_tiles::plan::{Look, Plan, TileOptions};
use meshlod_tiles::review::review;
use meshlod_tiles::source::Source;
use meshlod_tiles::survey::Survey;
use meshlod_tiles::task::run_task;
use meshlod_tiles::tileset::finish;
use rayon::ThreadPoolBuilder;
use rayon::prelude::*;

use crate::jobs::{About, JobError, Remark, Watch};
use fault::{failure, failure_of_input, no_plan};
use hold::Hold;
use method::Proven;
use result::{write_archive, write_folder};
use room::{Room, check_room};

pub use placement::{Globe, Up};
pub use report::{TileLevel, TilesReport, TilesetReport};
pub use request::TilesRequest;

/// Folder of the plan in that of the tileset, while this is made.
const PLAN: &str = ".plan";

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
/// needed, errors of the system, and a folder that another process is working on.
pub fn tiles(
    input: TileInput<'_>,
    out: &Path,
    request: &TilesRequest,
    watch: &dyn Watch,
) -> Result<TilesReport, JobError> {
    let options = request.options()?;
    let folder = Folder::new(plan_folder(out));
    let _hold = Hold::new_plan(&folder)?;
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
    let (plan, look) = planned(&folder)?;
    watch.stage("making tiles");
    let work = Work { plan: &plan, look: &look, folder: &folder, watch, done: AtomicUsize::new(0) };
    let pool = ThreadPoolBuilder::new().num_threads(threads).build().map_err(JobError::output)?;
    pool.install(|| work.make(plan.tasks.len() - 1, false))?;
    finish_in_hold(&folder, out, watch)
}

/// Returns the folder that a tileset is made in.
fn plan_folder(out: &Path) -> PathBuf {
    if !is_archive(out) {
        return out.join(PLAN);
    }
    let mut name = out.as_os_str().to_owned();
    name.push(PLAN);
    name.into()
}

/// Plans the tiles of a model in a folder, unless that is done: counts and cuts its faces, and finds
/// the errors of the levels. Returns the number of tasks.
///
/// # Errors
/// As [`tiles`].
pub fn plan_tiles(
    input: TileInput<'_>,
    folder: &Path,
    request: &TilesRequest,
    watch: &dyn Watch,
) -> Result<usize, JobError> {
    let folder = Folder::new(folder);
    let options = request.options()?;
    if folder.is_foreign() {
        let path = folder.path().display();
        let reason = format!("{path}: holds other files; name a new folder for the plan");
        return Err(JobError::request("", reason));
    }
    let _hold = Hold::new_plan(&folder)?;
    let planned = plan_in_hold(input, &folder, (&options, Room::OfSteps), watch);
    if planned.is_err() {
        folder.remove();
    }
    planned
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
    let model = (input.source, input.look);
    let survey = Survey::of(input.source, options.most_faces).map_err(failure)?;
    check_room(folder.path(), (&survey, model, options), room, watch)?;
    note_large_images(input.look, watch);
    watch.stage("cutting into tiles");
    let part = folder.path().join(format!("pieces-{}.part", std::process::id()));
    let plan = Plan::of_survey(survey, model, options, &part).map_err(failure)?;
    let scratch = folder.scratch();
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
        let text = format!("used at less resolution, larger than 4096 by 4096: {}", images(count));
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
    let folder = Folder::new(folder);
    let _hold = Hold::shared(&folder)?;
    let (plan, look) = planned(&folder)?;
    run_task((&plan, &look), &folder, task, &Proven::new(&plan)).map(drop).map_err(failure)
}

/// Checks that all tasks of a plan are done and that their tiles meet at every level, and makes the
/// tileset of them, in a folder or as an archive. The plan is removed.
///
/// # Errors
/// A task that is not done, tiles that do not meet, files that are not as they were written, errors
/// of the system, and a plan that another process is working on.
pub fn finish_tiles(folder: &Path, out: &Path, watch: &dyn Watch) -> Result<TilesReport, JobError> {
    let folder = Folder::new(folder);
    let _hold = Hold::alone(&folder)?;
    finish_in_hold(&folder, out, watch)
}

/// Finishes a plan that no other process works on.
fn finish_in_hold(folder: &Folder, out: &Path, watch: &dyn Watch) -> Result<TilesReport, JobError> {
    watch.stage("checking");
    let plan = plan_in(folder)?;
    let finished = finish(&plan, folder).map_err(failure)?;
    let written = match is_archive(out) {
        true => write_archive(&finished, folder, out),
        false => write_folder(&finished, folder, out),
    };
    written.map_err(failure)?;
    let lost = finished.lost_images(&plan);
    if !lost.is_empty() {
        let text = format!("cannot be decoded, left out: {} ({})", images(lost.len()), few(&lost));
        watch.remark(&Remark::new(About::Output, text));
    }
    let report = TilesReport::of(&plan, &finished);
    folder.remove();
    Ok(report)
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

/// Reads a plan and the materials of its model.
fn planned(folder: &Folder) -> Result<(Plan, Look), JobError> {
    let plan = plan_in(folder)?;
    let look = folder.look(&plan);
    Ok((plan, look))
}

fn plan_in(folder: &Folder) -> Result<Plan, JobError> {
    folder.plan().map_err(failure)?.ok_or_else(|| no_plan(folder))
}

/// Work on all tasks of a plan.
struct Work<'a> {
    plan: &'a Plan,
    look: &'a Look,
    folder: &'a Folder,
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
        let parts = self.plan.parts(task);
        let found = match is_part {
            true => self.folder.done(self.plan, task),
            false => self.folder.shown(self.plan, task),
        };
        if found.is_none() {
            let make = |&part: &usize| self.make(part, true);
            parts.par_iter().with_max_len(1).try_for_each(make)?;
            let method = Proven::new(self.plan);
            run_task((self.plan, self.look), self.folder, task, &method).map_err(failure)?;
        }
        for part in parts {
            self.folder.forget_mesh(self.plan.cell(part).map_err(failure)?);
        }
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        self.watch.step(done, Some(self.plan.tasks.len()));
        Ok(())
    }
}

#[cfg(test)]
mod tests;
