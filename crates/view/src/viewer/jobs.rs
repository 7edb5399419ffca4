//! Background jobs: threads that report progress, can be cancelled, and send their news as
//! messages.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};

/// Running jobs, and the channel of their news.
#[derive(Debug)]
pub(crate) struct Jobs<N> {
    sender: Sender<(JobId, Outcome<N>)>,
    receiver: Receiver<(JobId, Outcome<N>)>,
    running: Vec<Job>,
    next: u64,
    wake: egui::Context,
}

/// Number of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct JobId(u64);

/// Job that runs.
#[derive(Debug)]
pub(crate) struct Job {
    pub id: JobId,
    /// Kind of work, to find jobs again.
    pub kind: JobKind,
    /// Line that the status bar shows.
    pub label: String,
    pub watch: Watch,
}

/// Kind of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum JobKind {
    Open,
    Simplify,
    Compare,
    Check,
    Color,
    Refine,
    Save,
}

/// Progress and cancellation of a job, shared with its thread.
#[derive(Clone, Debug, Default)]
pub(crate) struct Watch(Arc<JobState>);

#[derive(Debug, Default)]
struct JobState {
    is_cancelled: AtomicBool,
    /// Share of the work that is done, in millionths; 0 if it is not known.
    done: AtomicU64,
}

/// End of a job: news, `None` if it was cancelled, or an error message.
pub(crate) type Outcome<N> = Result<Option<N>, String>;

impl Watch {
    /// Returns true if the job should stop.
    pub fn is_cancelled(&self) -> bool {
        self.0.is_cancelled.load(Ordering::Relaxed)
    }

    pub fn cancel(&self) {
        self.0.is_cancelled.store(true, Ordering::Relaxed);
    }

    /// Sets the share of the work that is done, 0 to 1.
    pub fn set(&self, share: f64) {
        self.0.done.store((share.clamp(0.0, 1.0) * 1e6) as u64, Ordering::Relaxed);
    }

    /// Returns the share of the work that is done; `None` if it is not known.
    pub fn share(&self) -> Option<f32> {
        let done = self.0.done.load(Ordering::Relaxed);
        (done > 0).then_some(done as f32 / 1e6)
    }
}

/// Jobs of the library are watched as those of the viewer.
impl meshlod::jobs::Watch for Watch {
    fn step(&self, done: usize, of: Option<usize>) {
        if let Some(of) = of {
            self.set(done as f64 / of.max(1) as f64);
        }
    }

    fn is_cancelled(&self) -> bool {
        self.is_cancelled()
    }
}

impl<N: Send + 'static> Jobs<N> {
    /// Creates a list without jobs; `wake` is asked for a frame when news arrive.
    pub fn new(wake: &egui::Context) -> Self {
        let (sender, receiver) = channel();
        Self { sender, receiver, running: Vec::new(), next: 0, wake: wake.clone() }
    }

    /// Starts a job on its own thread. A panic becomes an error message.
    pub fn start(
        &mut self,
        kind: JobKind,
        label: impl Into<String>,
        work: impl FnOnce(&Watch) -> Outcome<N> + Send + 'static,
    ) -> JobId {
        let (id, watch) = (JobId(self.next), Watch::default());
        self.next += 1;
        let (sender, wake, seen) = (self.sender.clone(), self.wake.clone(), watch.clone());
        let run = move || {
            let outcome = catch_unwind(AssertUnwindSafe(|| work(&seen)));
            let outcome = outcome.unwrap_or_else(|_| Err("an internal error".into()));
            // Without a receiver the window is closed, and nobody waits.
            let _ = sender.send((id, outcome));
            wake.request_repaint();
        };
        let label = label.into();
        match std::thread::Builder::new().name("meshlod job".into()).spawn(run) {
            Ok(_) => self.running.push(Job { id, kind, label, watch }),
            Err(error) => {
                let _ = self.sender.send((id, Err(format!("{label}: {error}"))));
            }
        }
        id
    }

    /// Returns the outcome of a job that has ended since the last call; those of cancelled jobs are
    /// dropped.
    pub fn poll(&mut self) -> Option<(JobId, Outcome<N>)> {
        loop {
            let (id, outcome) = self.receiver.try_recv().ok()?;
            let at = self.running.iter().position(|job| job.id == id);
            let job = at.map(|at| self.running.remove(at));
            if job.is_none_or(|job| !job.watch.is_cancelled()) {
                return Some((id, outcome));
            }
        }
    }

    /// Returns the jobs that run and were not cancelled.
    pub fn running(&self) -> impl Iterator<Item = &Job> {
        self.running.iter().filter(|job| !job.watch.is_cancelled())
    }

    /// Returns the context that is asked for a frame when news arrive.
    pub fn waker(&self) -> &egui::Context {
        &self.wake
    }

    /// Returns true if a job of a kind runs.
    pub fn has(&self, kind: JobKind) -> bool {
        self.running().any(|job| job.kind == kind)
    }

    /// Cancels all jobs of a kind.
    pub fn cancel(&self, kind: JobKind) {
        self.running().filter(|job| job.kind == kind).for_each(|job| job.watch.cancel());
    }
}

impl<N> Drop for Jobs<N> {
    fn drop(&mut self) {
        self.running.iter().for_each(|job| job.watch.cancel());
    }
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;

    fn wait(jobs: &mut Jobs<u32>) -> Option<Outcome<u32>> {
        let end = Instant::now() + Duration::from_secs(5);
        while Instant::now() < end {
            if let Some((_, outcome)) = jobs.poll() {
                return Some(outcome);
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        None
    }

    #[test]
    fn news_errors_and_panics_arrive() {
        let mut jobs = Jobs::new(&egui::Context::default());
        jobs.start(JobKind::Check, "news", |_| Ok(Some(7)));
        assert_eq!(wait(&mut jobs), Some(Ok(Some(7))));
        jobs.start(JobKind::Check, "error", |_| Err("no".into()));
        assert_eq!(wait(&mut jobs), Some(Err("no".into())));
        jobs.start(JobKind::Check, "panic", |_| panic!("on purpose"));
        assert_eq!(wait(&mut jobs), Some(Err("an internal error".into())));
        assert_eq!(jobs.running().count(), 0);
    }

    #[test]
    fn a_cancelled_job_ends_and_its_news_are_dropped() {
        let mut jobs = Jobs::new(&egui::Context::default());
        jobs.start(JobKind::Simplify, "long", |watch| {
            let mut share = 0.0;
            while !watch.is_cancelled() {
                share += 0.001;
                watch.set(share);
                std::thread::sleep(Duration::from_millis(1));
            }
            Ok(Some(1))
        });
        jobs.cancel(JobKind::Check);
        assert!(jobs.has(JobKind::Simplify), "another kind");
        jobs.cancel(JobKind::Simplify);
        assert!(!jobs.has(JobKind::Simplify));
        let end = Instant::now() + Duration::from_secs(5);
        while !jobs.running.is_empty() && Instant::now() < end {
            assert_eq!(jobs.poll(), None);
            std::thread::sleep(Duration::from_millis(1));
        }
        assert!(jobs.running.is_empty(), "its thread has ended");
    }
}
