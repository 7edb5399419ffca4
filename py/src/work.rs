//! Work without the GIL that Ctrl-C stops and that reports its progress.
//!
//! The work runs on a pool of threads. The calling thread waits for it without the GIL, and wakes
//! up now and then to let Python handle signals and to call the progress callback. If either
//! raises, the exception is passed on at once, and the work ends at its next contraction, or else
//! by itself: it owns all that it uses. Only work that is putting a file into its place is waited
//! for, so that nothing is written after an exception.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::process;
use std::sync::atomic::{AtomicU8, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use meshlod::jobs;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Time between two looks at signals and progress. Finished work is noticed at once.
pub const TICK: Duration = Duration::from_millis(50);

/// Callback that is told the part of the work that is done, from 0 to 1.
pub struct Progress {
    /// Callback in Python.
    pub callback: Py<PyAny>,
    /// Number of faces to remove; `None` if it is not known.
    pub faces: Option<usize>,
}

/// Work that may still be cancelled.
const RUNNING: u8 = 0;

/// Work that nobody waits for any more.
const CANCELLED: u8 = 1;

/// Work that is putting a file into its place.
const COMMITTED: u8 = 2;

/// State that the work shares with the thread that waits for it.
#[derive(Default)]
struct Shared {
    /// [`RUNNING`], from which work gets to one of the two others and no further.
    state: AtomicU8,
    /// Number of faces removed so far.
    gone: AtomicUsize,
}

impl Shared {
    /// Moves running work to another state, and returns false if it is in one already.
    fn move_to(&self, state: u8) -> bool {
        let order = Ordering::Relaxed;
        self.state.compare_exchange(RUNNING, state, order, order).is_ok()
    }
}

/// Watch of a job that keeps how much is done, and ends the work if nobody waits for it any more.
#[derive(Clone)]
pub struct Watch(Arc<Shared>);

/// Payload with which cancelled work unwinds.
struct Cancelled;

impl jobs::Watch for Watch {
    fn step(&self, done: usize, _: Option<usize>) {
        self.0.gone.store(done, Ordering::Relaxed);
    }

    fn is_cancelled(&self) -> bool {
        self.0.state.load(Ordering::Relaxed) == CANCELLED
    }
}

impl Watch {
    /// Sets how much is done, and ends the work if nobody waits for it any more.
    pub fn reach(&self, done: usize) {
        self.0.gone.store(done, Ordering::Relaxed);
        self.check();
    }

    /// Sets how much is done, unless more is done already: for steps that several threads count.
    pub fn rise_to(&self, done: usize) {
        self.0.gone.fetch_max(done, Ordering::Relaxed);
    }

    /// Ends the work if it has been cancelled; from here on its end is waited for. To be called
    /// right before a file is put into its place.
    pub fn commit(&self) {
        self.0.move_to(COMMITTED);
        self.check();
    }

    /// Ends the work if it has been cancelled, by unwinding to where it was started.
    fn check(&self) {
        if self.0.state.load(Ordering::Relaxed) == CANCELLED {
            // No panic: nothing is printed.
            resume_unwind(Box::new(Cancelled));
        }
    }
}

/// Runs `work` on the pool, without the GIL, and returns its result.
///
/// # Errors
/// The exception of a signal handler or of the callback; a panic of the work, a defect here.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<Progress>,
    work: impl FnOnce(&mut Watch) -> T + Send + 'static,
) -> PyResult<T> {
    run_until(py, progress, Until::Raised, work)
}

/// Runs `work` as [`run`] does, but an exception waits until the work, which is cancelled, has
/// ended: for work that writes files from its start to its end.
///
/// # Errors
/// As [`run`].
pub fn run_to_end<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<Progress>,
    work: impl FnOnce(&mut Watch) -> T + Send + 'static,
) -> PyResult<T> {
    run_until(py, progress, Until::Ended, work)
}

/// Moment at which an exception is passed on.
#[derive(PartialEq)]
enum Until {
    /// At once, unless a file is being put into its place.
    Raised,
    /// At the end of the work.
    Ended,
}

fn run_until<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<Progress>,
    until: Until,
    work: impl FnOnce(&mut Watch) -> T + Send + 'static,
) -> PyResult<T> {
    let shared = Arc::new(Shared::default());
    let mut watch = Watch(Arc::clone(&shared));
    let (sender, mut receiver) = channel();
    pool()?.spawn(move || {
        let result = catch_unwind(AssertUnwindSafe(|| work(&mut watch)));
        // Nobody waits for cancelled work.
        let _ = sender.send(result);
    });
    loop {
        let (result, back) = py.detach(move || (receiver.recv_timeout(TICK), receiver));
        receiver = back;
        let seen = match result {
            Ok(Ok(value)) => {
                if let Some(progress) = &progress {
                    progress.callback.call1(py, (1.0,))?;
                }
                return Ok(value);
            }
            Ok(Err(payload)) => return Err(defect(&*payload)),
            Err(RecvTimeoutError::Disconnected) => return Err(defect(&())),
            Err(RecvTimeoutError::Timeout) => look(py, progress.as_ref(), &shared),
        };
        if let Err(raised) = seen {
            if !shared.move_to(CANCELLED) || until == Until::Ended {
                // The file is nearly there, or the work about to end.
                let _ = py.detach(move || receiver.recv());
            }
            return Err(raised);
        }
    }
}

/// Lets Python handle signals, and reports progress.
fn look(py: Python<'_>, progress: Option<&Progress>, shared: &Shared) -> PyResult<()> {
    py.check_signals()?;
    if let Some(Progress { callback, faces: Some(faces) }) = progress {
        let gone = shared.gone.load(Ordering::Relaxed);
        let done = gone as f64 / (*faces).max(1) as f64;
        // 1 is said once, at the end.
        callback.call1(py, (done.min(0.999),))?;
    }
    Ok(())
}

fn defect(payload: &(dyn Any + Send)) -> PyErr {
    let text = payload.downcast_ref::<String>().map(String::as_str);
    let text = text.or(payload.downcast_ref::<&str>().copied()).unwrap_or("no message");
    PyRuntimeError::new_err(format!(
        "meshlod has a defect: {}; please report it with the input",
        text.replace(['\n', '\r'], " ")
    ))
}

/// Returns the pool of this process. A child made by `fork` has none of its parent's threads, and
/// gets a pool of its own.
///
/// Only threads that hold the GIL come here, as the one that forks does: no child is born with the
/// lock taken.
fn pool() -> PyResult<Arc<ThreadPool>> {
    static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);
    let mut known = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let process = process::id();
    if let Some((owner, pool)) = &*known
        && *owner == process
    {
        return Ok(Arc::clone(pool));
    }
    let pool = ThreadPoolBuilder::new().build().map_err(|error| {
        PyRuntimeError::new_err(format!("cannot start threads: {error}; set RAYON_NUM_THREADS"))
    })?;
    let pool = Arc::new(pool);
    // The pool of the parent cannot be shut down without its threads.
    std::mem::forget(known.replace((process, Arc::clone(&pool))));
    Ok(pool)
}
