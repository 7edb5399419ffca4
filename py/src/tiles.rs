//! Tiles of models of any size: whole runs, and the steps that a cluster does.

use std::path::{Path, PathBuf, absolute};
use std::sync::{Arc, Mutex, PoisonError};

use meshlod::io::{Note, Weld};
use meshlod::jobs::{
    self, JobError, PlanFolder, Remark, TileFileError, TileFiles, TileModel, TilePlan, TileRun,
    TilesRequest, Watch as _,
};
use meshlod::{AnyFile, AnyFileError, IoError, ReadOptions, Scene};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::ThreadPoolBuilder;

use crate::errors::{raised, raised_by_file};
use crate::files::{not_opened, texts, unreadable};
use crate::report;
use crate::work::{Progress, Watch, run, run_to_end};

/// Resolution of reported progress.
const STEPS: usize = 1 << 20;

/// Request and options, by the names that Python gives them.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct TilesAsked {
    /// JSON of a [`TilesRequest`].
    request: String,
    /// Distance within which vertices are welded, in model units.
    weld: Option<f64>,
    /// Number of threads; `None` for those of the process.
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
}

/// Makes the tiles of a model in a folder; returns the report, and notes on what was left out.
///
/// # Errors
/// A request without meaning, inputs that cannot be used, and errors of the file system.
#[pyfunction]
pub fn tiles<'py>(
    py: Python<'py>,
    inputs: Vec<PathBuf>,
    out: PathBuf,
    asked: TilesAsked,
) -> PyResult<(Bound<'py, PyDict>, Vec<String>)> {
    let job = TilesJob::new(inputs, &asked)?;
    let out = absolute(out)?;
    let progress = asked.progress.map(|callback| Progress { callback, faces: Some(STEPS) });
    let (done, notes) = run_to_end(py, progress, move |watch| {
        let heard = Heard::new(watch);
        let work = || {
            jobs::check_tiles_folder(&out).map_err(|error| job.fault(error, &out))?;
            let model = job.open(&out, &heard)?;
            let done = jobs::tiles(model.input(), &out, &job.request, &heard);
            done.map_err(|error| job.fault(error, &out))
        };
        (on_threads(asked.threads, work), heard.notes())
    })?;
    Ok((report::of_json(py, &done.map_err(TilesFault::raised)?)?, notes))
}

/// Plans the tiles of a model in the folder of a run; returns notes on what was left out.
///
/// # Errors
/// As [`tiles`].
#[pyfunction]
pub fn plan_tiles(
    py: Python<'_>,
    inputs: Vec<PathBuf>,
    folder: PathBuf,
    asked: TilesAsked,
    key: String,
) -> PyResult<Vec<String>> {
    let job = TilesJob::new(inputs, &asked)?;
    let folder = absolute(folder)?;
    let (done, notes) = run_to_end(py, None, move |watch| {
        let heard = Heard::new(watch);
        let work = || {
            let model = job.open(&folder, &heard)?;
            let place = PlanFolder::of_run(&folder, &key);
            let done = jobs::plan_tiles(model.input(), place, &job.request, &heard);
            done.map_err(|error| job.fault(error, &folder))
        };
        (on_threads(asked.threads, work), heard.notes())
    })?;
    done.map_err(TilesFault::raised)?;
    Ok(notes)
}

/// Makes the tileset of a run's plan whose tasks are done; returns its report, and notes on what was
/// left out. The plan stays.
///
/// # Errors
/// A task that is not done, tiles that do not meet, and errors of the file system.
#[pyfunction]
pub fn assemble_tiles(
    py: Python<'_>,
    folder: PathBuf,
    out: PathBuf,
    key: String,
) -> PyResult<(Bound<'_, PyDict>, Vec<String>)> {
    let at = out.clone();
    let (done, notes) = run_to_end(py, None, move |watch| {
        let heard = Heard::new(watch);
        let place = PlanFolder::of_run(&folder, &key);
        (jobs::assemble_tiles(place, &out, &heard), heard.notes())
    })?;
    let report = done.map_err(|error| TilesFault::of_job(error, &at, &at).raised())?;
    Ok((report::of_json(py, &report)?, notes))
}

/// Returns the folder of the plan of a tileset, if tiles can go there.
///
/// # Errors
/// A folder that holds anything but tiles of ours.
#[pyfunction]
pub fn tile_plan_folder(out: PathBuf) -> PyResult<PathBuf> {
    let failed = |error| TilesFault::of_job(error, &out, &out).raised();
    jobs::check_tiles_folder(&out).map_err(failed)?;
    Ok(jobs::tile_plan_folder(&out))
}

/// Right to the folder of a plan, from before it is made until `end`.
#[pyclass(frozen, module = "meshlod._native")]
pub struct NativeTileRun(Mutex<Option<TileRun>>);

#[pymethods]
impl NativeTileRun {
    /// Takes a folder.
    #[new]
    fn new(py: Python<'_>, folder: PathBuf) -> PyResult<Self> {
        let begun = py.detach(|| TileRun::begin(&folder));
        let run = begun.map_err(|error| TilesFault::of_job(error, &folder, &folder).raised())?;
        Ok(Self(Mutex::new(Some(run))))
    }

    /// The key that its steps show.
    fn key(&self) -> String {
        let run = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        run.as_ref().map_or_else(String::new, |run| run.key().to_owned())
    }

    /// Gives the folder back; `done` removes the files of the plan before.
    fn end(&self, py: Python<'_>, done: bool) {
        let run = self.0.lock().unwrap_or_else(PoisonError::into_inner).take();
        py.detach(|| run.filter(|_| done).iter().for_each(TileRun::remove));
    }
}

/// Plan of tiles, opened once for many of its tasks.
#[pyclass(frozen, module = "meshlod._native")]
pub struct NativeTilePlan(Arc<TilePlan>);

#[pymethods]
impl NativeTilePlan {
    /// Opens the plan in a folder.
    #[new]
    fn new(py: Python<'_>, folder: PathBuf) -> PyResult<Self> {
        let at = folder.clone();
        let plan = run(py, None, move |_| TilePlan::open(&folder))?;
        Ok(Self(Arc::new(plan.map_err(|error| TilesFault::of_job(error, &at, &at).raised())?)))
    }

    /// For each task, the tasks that it needs done before.
    fn parts(&self) -> Vec<Vec<usize>> {
        (0..self.0.tasks()).map(|task| self.0.parts(task)).collect()
    }

    /// For each task, whether it is done.
    fn done(&self, py: Python<'_>) -> PyResult<Vec<bool>> {
        let is_done = |task: usize| self.0.is_done(task);
        let done: Result<Vec<bool>, JobError> =
            py.detach(|| (0..self.0.tasks()).map(is_done).collect());
        let path = Path::new("");
        done.map_err(|error| TilesFault::of_job(error, path, path).raised())
    }

    /// Number of faces from which a part of the model is divided.
    fn tile_faces(&self) -> usize {
        self.0.tile_faces()
    }

    /// False if another plan has been made in the folder since.
    fn is_current(&self) -> bool {
        self.0.is_current()
    }

    /// Does tasks one after another on one thread, unless they are done, and removes what is left of
    /// their parts.
    fn run(&self, py: Python<'_>, tasks: Vec<usize>) -> PyResult<()> {
        let plan = Arc::clone(&self.0);
        let done = run_to_end(py, None, move |watch| {
            on_threads(Some(1), || {
                for task in tasks {
                    if watch.is_cancelled() {
                        return Err(JobError::Cancelled.into());
                    }
                    plan.run(task)?;
                    plan.forget_parts(task);
                }
                Ok(())
            })
        })?;
        done.map_err(TilesFault::raised)
    }
}

/// Inputs and request of tiles.
struct TilesJob {
    inputs: Vec<PathBuf>,
    options: ReadOptions,
    request: TilesRequest,
}

impl TilesJob {
    fn new(inputs: Vec<PathBuf>, asked: &TilesAsked) -> PyResult<Self> {
        // The folder of the process may change while the work runs.
        let inputs = inputs.into_iter().map(absolute).collect::<Result<_, _>>()?;
        let weld = asked.weld.map_or(Weld::Exact, Weld::Within);
        let request = serde_json::from_str(&asked.request).map_err(raised)?;
        Ok(Self { inputs, options: ReadOptions { weld }, request })
    }

    fn open(&self, out: &Path, heard: &Heard) -> Result<TileModel, TilesFault> {
        TileModel::open(&self.inputs, out, &ReadFiles { options: &self.options, heard })
    }

    fn fault(&self, error: JobError, out: &Path) -> TilesFault {
        TilesFault::of_job(error, self.inputs.first().map_or(out, PathBuf::as_path), out)
    }
}

/// Does work on a number of threads of its own, or on those of the process.
fn on_threads<T: Send>(
    threads: Option<usize>,
    work: impl FnOnce() -> Result<T, TilesFault> + Send,
) -> Result<T, TilesFault> {
    let Some(threads) = threads else { return work() };
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(JobError::output)?.install(work)
}

/// Package as a reader of files.
struct ReadFiles<'a> {
    options: &'a ReadOptions,
    heard: &'a Heard,
}

impl TileFiles for ReadFiles<'_> {
    type Error = TilesFault;

    fn is_read_whole(&self, _: &Path) -> bool {
        matches!(self.options.weld, Weld::Within(_))
    }

    fn reading(&self) -> String {
        format!("{:?}", self.options)
    }

    fn read(&self, path: &Path) -> Result<Scene, TilesFault> {
        let scene = AnyFile::open(path, self.options).and_then(AnyFile::into_scene);
        let scene = scene.map_err(TilesFault::File)?;
        self.note(path, &scene.notes)?;
        Ok(scene)
    }

    fn note(&self, path: &Path, notes: &[Note]) -> Result<(), TilesFault> {
        texts(notes).iter().for_each(|note| self.warn(Some(path), note));
        Ok(())
    }

    fn warn(&self, path: Option<&Path>, text: &str) {
        self.heard.keep(match path {
            Some(path) => format!("{}: {text}", path.display()),
            None => text.to_owned(),
        });
    }
}

/// Watch that knows how many tiles there are once they are planned, and keeps what was said.
struct Heard {
    watch: Watch,
    notes: Mutex<Vec<String>>,
}

impl Heard {
    fn new(watch: &Watch) -> Self {
        Self { watch: watch.clone(), notes: Mutex::default() }
    }

    fn keep(&self, note: String) {
        self.notes.lock().unwrap_or_else(PoisonError::into_inner).push(note);
    }

    fn notes(self) -> Vec<String> {
        self.notes.into_inner().unwrap_or_else(PoisonError::into_inner)
    }
}

impl jobs::Watch for Heard {
    fn step(&self, done: usize, of: Option<usize>) {
        let part = of.map_or(0.0, |of| done as f64 / of.max(1) as f64);
        self.watch.rise_to((part * STEPS as f64) as usize);
    }

    fn is_cancelled(&self) -> bool {
        self.watch.is_cancelled()
    }

    fn remark(&self, remark: &Remark) {
        self.keep(remark.to_string());
    }
}

/// Reason why tiles were not made.
enum TilesFault {
    /// A file that cannot be read as a whole.
    File(AnyFileError),
    /// A file or folder that is no model.
    Model(TileFileError),
    /// An error of the system at a path that it names.
    System(IoError),
    /// Any other, in one line.
    Line(String),
}

impl TilesFault {
    /// Names the field, the input or the output that an error of the job is about.
    fn of_job(error: JobError, input: &Path, out: &Path) -> Self {
        match error {
            JobError::Request { field: "", reason } => Self::Line(reason),
            JobError::Request { field, reason } => Self::Line(format!("{field} {reason}")),
            JobError::Input(error) => Self::at(input, error),
            JobError::Output(error) => Self::at(out, error),
            error => Self::Line(error.to_string()),
        }
    }

    fn at(path: &Path, error: Box<dyn std::error::Error + Send + Sync>) -> Self {
        match error.downcast::<IoError>() {
            Ok(error) => Self::System(*error),
            Err(error) => Self::Line(format!("{}: {error}", path.display())),
        }
    }

    /// Makes an exception of it.
    fn raised(self) -> PyErr {
        match self {
            Self::File(error) => not_opened(error),
            Self::Model(TileFileError::Io(error)) => unreadable(error),
            Self::Model(error) => raised(error),
            Self::System(error) => raised_by_file(error),
            Self::Line(line) => raised(line),
        }
    }
}

impl From<TileFileError> for TilesFault {
    fn from(error: TileFileError) -> Self {
        Self::Model(error)
    }
}

impl From<JobError> for TilesFault {
    fn from(error: JobError) -> Self {
        match error {
            JobError::Output(error) => match error.downcast::<IoError>() {
                Ok(error) => Self::System(*error),
                Err(error) => Self::Line(error.to_string()),
            },
            error => Self::Line(error.to_string()),
        }
    }
}
