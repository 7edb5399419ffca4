//! Threads that make the files of a batch, each on a pool of its own.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::thread;

use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::batch::file::{FileState, run_file};
use crate::batch::plan::FileJob;
use crate::batch::report::FileReport;
use crate::options::args::GlobalArgs;
use crate::recipe::Recipe;
use crate::session::STACK_BYTES;
use crate::session::failure::Failure;

/// Number of files at a time, and what each is run with.
pub struct Crew<'g> {
    jobs: usize,
    /// Threads for each file. How many they are decides about no byte.
    threads: usize,
    global: &'g GlobalArgs,
}

impl<'g> Crew<'g> {
    /// Divides the cores among `jobs` of the files at a time, by default one for each core: threads
    /// that share nothing waste nothing.
    pub fn new(jobs: Option<usize>, files: usize, global: &'g GlobalArgs) -> Self {
        let cores = thread::available_parallelism().map_or(1, usize::from);
        let jobs = jobs.unwrap_or(cores).min(files).max(1);
        Self { jobs, threads: global.threads.unwrap_or((cores / jobs).max(1)), global }
    }
}

/// Starts the threads of one file at a time.
///
/// # Errors
/// If the system has none left.
pub fn pool(threads: usize) -> Result<ThreadPool, Failure> {
    let pool = ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK_BYTES);
    pool.build().map_err(|error| Failure::new(format_args!("cannot start threads: {error}")))
}

/// Makes all files, the largest first, so that no long one is left for the end; tells of each when
/// it is done.
///
/// # Errors
/// If the system has no threads left, before the first file.
pub fn run_jobs(
    jobs: &[&FileJob],
    recipe: &Recipe,
    crew: &Crew<'_>,
    on_done: &mut dyn FnMut(usize, FileReport),
) -> Result<(), Failure> {
    let bytes = |job: &FileJob| FileState::of(&job.input).map_or(0, |state| state.bytes);
    let mut order: Vec<usize> = (0..jobs.len()).collect();
    order.sort_by_cached_key(|&at| std::cmp::Reverse(bytes(jobs[at])));
    let pools = (0..crew.jobs).map(|_| pool(crew.threads));
    let pools = pools.collect::<Result<Vec<_>, _>>()?;
    let queue = Queue { jobs, order, next: AtomicUsize::new(0), stopped: AtomicBool::new(false) };
    thread::scope(|scope| {
        let (sender, done) = channel();
        for pool in &pools {
            let (sender, queue) = (sender.clone(), &queue);
            scope.spawn(move || queue.work(pool, recipe, crew.global, &sender));
        }
        drop(sender);
        let _stop = StopOnDrop(&queue.stopped);
        for (at, report) in done {
            on_done(at, report);
        }
    });
    Ok(())
}

/// Files that wait for a thread.
struct Queue<'j> {
    jobs: &'j [&'j FileJob],
    order: Vec<usize>,
    next: AtomicUsize,
    /// Set where nobody waits for the rest any more.
    stopped: AtomicBool,
}

impl Queue<'_> {
    fn work(
        &self,
        pool: &ThreadPool,
        recipe: &Recipe,
        global: &GlobalArgs,
        done: &Sender<(usize, FileReport)>,
    ) {
        while let Some(&at) = self.order.get(self.next.fetch_add(1, Ordering::Relaxed)) {
            let job = self.jobs[at];
            if self.stopped.load(Ordering::Relaxed) {
                return;
            }
            let line = recipe.line(&[job.input.clone(), job.output.clone()]);
            let line = line.map(|mut line| {
                line.global = global.clone().or(line.global);
                line
            });
            let report = pool.install(|| run_file(line, job));
            if done.send((at, report)).is_err() {
                return;
            }
        }
    }
}

/// Has the threads begin no other file, also when the one that waits for them unwinds.
struct StopOnDrop<'s>(&'s AtomicBool);

impl Drop for StopOnDrop<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}
