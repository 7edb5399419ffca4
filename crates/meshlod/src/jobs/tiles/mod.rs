//! Tiles of a model of any size: 3D Tiles, from a plan whose tasks any number of processes may do.

mod method;
mod model;
mod opened;
mod output;
mod placement;
mod report;
mod request;

use std::fs;
use std::io;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use meshlod_io::{IoError, remove_abandoned, write_file};
use meshlod_mesh::Bounds;
use meshlod_tiles::TilesError;
use meshlod_tiles::errors::find_errors;
use meshlod_tiles::folder::Folder;
use meshlod_tiles::layout::Layout;
use meshlod_tiles::plan::{Look, Plan};
use meshlod_tiles::review::review;
use meshlod_tiles::source::{Source, Triangles};
use meshlod_tiles::tileset::finish;
use rayon::ThreadPoolBuilder;
use rayon::prelude::*;

use crate::jobs::{JobError, Watch};
use method::Proven;

pub use model::{TileFileError, TileFiles, TileModel};
pub use opened::TilePlan;
pub use output::{TilesLock, check_tiles_folder, tile_plan_folder};
pub use placement::{Globe, Up};
pub use report::{TileLevel, TilesReport, TilesetReport};
pub use request::TilesRequest;

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
/// folder that holds other files or that another process is working on.
pub fn tiles(
    input: TileInput<'_>,
    out: &Path,
    request: &TilesRequest,
    watch: &dyn Watch,
) -> Result<TilesReport, JobError> {
    request.options()?;
    check_tiles_folder(out)?;
    let _lock = TilesLock::take(out)?;
    let folder = Folder::new(tile_plan_folder(out));
    if let Err(error) = plan_tiles(input, folder.path(), request, watch) {
        // Nothing is left that a next run could go on from.
        folder.remove();
        let _ = fs::remove_dir(out);
        return Err(error);
    }
    let plan = TilePlan::open(folder.path())?;
    plan.take_back(out);
    watch.stage("making tiles");
    let work = Work { plan: &plan, watch, done: AtomicUsize::new(0) };
    let threads = request.threads(rayon::current_num_threads());
    let pool = ThreadPoolBuilder::new().num_threads(threads).build().map_err(JobError::output)?;
    pool.install(|| work.make(plan.tasks() - 1))?;
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
    let scratch = folder.scratch();
    remove_abandoned([&*scratch]);
    let part = folder.path().join(format!(".pieces.{}-0", std::process::id()));
    let source = Watched { source: input.source, watch };
    let plan = Plan::new(&source, input.look, &options, &part).map_err(|error| {
        let _ = fs::remove_file(&part);
        if watch.is_cancelled() { JobError::Cancelled } else { failure(error) }
    })?;
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
    TilePlan::open(folder)?.run(task)
}

/// Checks that all tasks of a plan are done and that their tiles meet at every level, and makes the
/// tileset of them. The plan is removed.
///
/// # Errors
/// As [`assemble_tiles`].
pub fn finish_tiles(folder: &Path, out: &Path, watch: &dyn Watch) -> Result<TilesReport, JobError> {
    let report = assemble_tiles(folder, out, watch)?;
    remove_tile_plan(folder);
    Ok(report)
}

/// Does what [`finish_tiles`] does, but keeps the plan: a call that was ended, by whatever, may be
/// repeated until [`remove_tile_plan`].
///
/// # Errors
/// A task that is not done, tiles that do not meet, a folder that holds other files, and errors of
/// the system.
pub fn assemble_tiles(
    folder: &Path,
    out: &Path,
    watch: &dyn Watch,
) -> Result<TilesReport, JobError> {
    watch.stage("checking");
    check_tiles_folder(out)?;
    let opened = TilePlan::open(folder)?;
    opened.take_back(out);
    let (plan, folder) = (&opened.plan, Folder::new(folder));
    let finished = finish(plan, &folder).map_err(failure)?;
    output::tidy(&folder, &finished.records);
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
    Ok(TilesReport::of(plan, &finished))
}

/// Removes the files of a plan, and its folder if nothing else is in it.
pub fn remove_tile_plan(folder: &Path) {
    Folder::new(folder).remove();
}

/// Reads a tileset and all its tiles again, and checks them.
///
/// # Errors
/// A folder without a tileset of ours.
pub fn check_tileset(folder: &Path, watch: &dyn Watch) -> Result<TilesetReport, JobError> {
    watch.stage("reading tiles");
    Ok(TilesetReport::of(review(folder).map_err(JobError::input)?))
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
    /// Makes a tile after those that it is made from, whose meshes are then removed.
    fn make(&self, task: usize) -> Result<(), JobError> {
        if self.watch.is_cancelled() {
            return Err(JobError::Cancelled);
        }
        if !self.plan.is_done(task) {
            let parts = self.plan.parts(task);
            parts.par_iter().with_max_len(1).try_for_each(|&part| self.make(part))?;
            self.plan.run(task)?;
        }
        self.plan.forget_parts(task);
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        self.watch.step(done, Some(self.plan.tasks()));
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
