//! Tiles of a model of any size: 3D Tiles, from a plan whose tasks any number of processes may do.

mod method;
mod placement;
mod report;
mod request;

use std::fs::{self, File};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use meshlod_io::{IoError, write_file};
use meshlod_tiles::TilesError;
use meshlod_tiles::errors::find_errors;
use meshlod_tiles::folder::Folder;
use meshlod_tiles::plan::{Look, Plan};
use meshlod_tiles::review::review;
use meshlod_tiles::source::Source;
use meshlod_tiles::task::run_task;
use meshlod_tiles::tileset::finish;
use rayon::ThreadPoolBuilder;
use rayon::prelude::*;

use crate::jobs::{JobError, Watch};
use method::Proven;

pub use placement::{Globe, Up};
pub use report::{TileLevel, TilesReport, TilesetReport};
pub use request::TilesRequest;

/// Folder of the plan in that of the tileset, while this is made.
const PLAN: &str = ".plan";

/// Folder of the contents in that of the tileset.
const TILES: &str = "tiles";

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

/// Makes the tiles of a model in a folder: `tileset.json` and what it names.
///
/// The work is planned and done in a folder `.plan` inside, which is removed at the end. A call that
/// was ended goes on from there. The bytes of the tileset depend on the model and the request alone,
/// whatever the number of threads.
///
/// # Errors
/// A request that has no meaning, a model without faces or extent, errors of the system, and a
/// folder that another process is working on.
pub fn tiles(
    input: TileInput<'_>,
    out: &Path,
    request: &TilesRequest,
    watch: &dyn Watch,
) -> Result<TilesReport, JobError> {
    request.options()?;
    let folder = Folder::new(out.join(PLAN));
    let _lock = locked(&folder)?;
    if let Err(error) = plan_tiles(input, folder.path(), request, watch) {
        // Nothing is left that a next run could go on from.
        folder.remove();
        let _ = fs::remove_dir(out);
        return Err(error);
    }
    let (plan, look) = planned(&folder)?;
    watch.stage("making tiles");
    let work = Work { plan: &plan, look: &look, folder: &folder, watch, done: AtomicUsize::new(0) };
    let threads = request.threads(rayon::current_num_threads());
    let pool = ThreadPoolBuilder::new().num_threads(threads).build().map_err(JobError::output)?;
    pool.install(|| work.make(plan.tasks.len() - 1))?;
    finish_tiles(folder.path(), out, watch)
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
    if let Some(plan) = folder.plan().map_err(failure)?
        && plan.key == input.key
        && plan.options == options
    {
        return Ok(plan.tasks.len());
    }
    if folder.is_foreign() {
        let path = folder.path().display();
        let reason = format!("{path}: holds other files; name a new folder for the plan");
        return Err(JobError::request("", reason));
    }
    folder.forget_tiles();
    folder.make().map_err(failure)?;
    watch.stage("cutting into tiles");
    let part = folder.path().join(format!("pieces-{}.part", std::process::id()));
    let plan = Plan::new(input.source, input.look, &options, &part).map_err(failure)?;
    let scratch = folder.scratch();
    fs::rename(&part, &scratch).map_err(|error| failure(TilesError::system(&scratch, error)))?;
    watch.stage("finding the errors of levels");
    let errors = find_errors(&plan, &folder, &Proven::new(&plan)).map_err(failure)?;
    let plan = Plan { errors, key: input.key.to_owned(), ..plan };
    folder.write_plan(&plan, &input.look.images).map_err(failure)?;
    Ok(plan.tasks.len())
}

/// Does a task of a plan, unless it is done.
///
/// # Errors
/// A task that there is not or that needs another one first, and errors of the system.
pub fn run_tile_task(folder: &Path, task: usize) -> Result<(), JobError> {
    let folder = Folder::new(folder);
    let (plan, look) = planned(&folder)?;
    run_task((&plan, &look), &folder, task, &Proven::new(&plan)).map(drop).map_err(failure)
}

/// Checks that all tasks of a plan are done and that their tiles meet at every level, and makes the
/// tileset of them. The plan is removed.
///
/// # Errors
/// A task that is not done, tiles that do not meet, and errors of the system.
pub fn finish_tiles(folder: &Path, out: &Path, watch: &dyn Watch) -> Result<TilesReport, JobError> {
    watch.stage("checking");
    let folder = Folder::new(folder);
    let plan = plan_in(&folder)?;
    let finished = finish(&plan, &folder).map_err(failure)?;
    let tiles = out.join(TILES);
    let system = |path: &Path| {
        let path = path.to_owned();
        move |error| failure(TilesError::system(&path, error))
    };
    fs::create_dir_all(out).map_err(system(out))?;
    if tiles.exists() {
        fs::remove_dir_all(&tiles).map_err(system(&tiles))?;
    }
    fs::rename(folder.content_folder(), &tiles).map_err(system(&tiles))?;
    for file in finished.files.iter().rev() {
        write_file(&out.join(&file.name), &file.text).map_err(JobError::output)?;
    }
    let report = TilesReport::of(&plan, &finished);
    folder.remove();
    Ok(report)
}

/// Reads a tileset and all its tiles again, and checks them.
///
/// # Errors
/// A folder without a tileset of ours.
pub fn check_tileset(folder: &Path, watch: &dyn Watch) -> Result<TilesetReport, JobError> {
    watch.stage("reading tiles");
    Ok(TilesetReport::of(review(folder).map_err(JobError::input)?))
}

/// Reads a plan and the materials of its model.
fn planned(folder: &Folder) -> Result<(Plan, Look), JobError> {
    let plan = plan_in(folder)?;
    let images = folder.images(&plan).map_err(failure)?;
    let (labels, materials) = (plan.labels.clone(), plan.materials.clone());
    let look = Look { labels, materials, images, ..Look::default() };
    Ok((plan, look))
}

fn plan_in(folder: &Folder) -> Result<Plan, JobError> {
    let none = || JobError::request("", format!("{}: no plan of tiles", folder.path().display()));
    folder.plan().map_err(failure)?.ok_or_else(none)
}

/// Locks a folder against other processes for as long as the file is open.
fn locked(folder: &Folder) -> Result<File, JobError> {
    folder.make().map_err(failure)?;
    let path = folder.lock_file();
    let file = File::create(&path).map_err(|error| failure(TilesError::system(&path, error)))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(_) => Err(JobError::output(format!(
            "{}: another process is making tiles here",
            path.display()
        ))),
    }
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
    /// Makes a tile after those that it is made from, whose meshes are then removed.
    fn make(&self, task: usize) -> Result<(), JobError> {
        if self.watch.is_cancelled() {
            return Err(JobError::Cancelled);
        }
        let cell = |task| self.plan.cell(task).map_err(failure);
        let parts = self.plan.parts(task);
        if self.folder.record(cell(task)?).is_none() {
            parts.par_iter().with_max_len(1).try_for_each(|&part| self.make(part))?;
            let method = Proven::new(self.plan);
            run_task((self.plan, self.look), self.folder, task, &method).map_err(failure)?;
        }
        for part in parts {
            self.folder.forget_mesh(cell(part)?);
        }
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        self.watch.step(done, Some(self.plan.tasks.len()));
        Ok(())
    }
}

/// Says which part of the job an error is about.
fn failure(error: TilesError) -> JobError {
    match error {
        TilesError::NoFaces | TilesError::NoExtent => JobError::input(error),
        TilesError::NoTask { .. } | TilesError::NotDone { .. } => JobError::request("", error),
        TilesError::Io(error @ IoError::Parse { .. }) => JobError::input(error),
        TilesError::Io(error) => JobError::output(error),
        error => JobError::output(error),
    }
}

#[cfg(test)]
mod tests;
