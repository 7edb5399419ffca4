//! A running job: its stages, its contractions, and how it ends where it is cancelled.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use meshlod_simplify::Observe;

use crate::jobs::{JobError, Watch};

/// Observer of a simplification that reports the faces removed and ends it when it is cancelled.
pub(crate) struct Contractions<'w> {
    watch: &'w dyn Watch,
    gone: usize,
    /// Number of removed faces when the watch was last called.
    said: usize,
    /// Number of faces removed between two calls.
    pace: usize,
    /// Number of faces to remove, where it is known.
    of: Option<usize>,
}

/// Most faces removed between two calls of the watch: one costs more than a contraction.
const FACES_A_STEP: usize = 8192;

/// Number of calls of the watch in a short run.
const STEPS: usize = 100;

impl<'w> Contractions<'w> {
    pub(crate) fn new(watch: &'w dyn Watch, of: Option<usize>) -> Self {
        watch.step(0, of);
        let pace = of.map_or(FACES_A_STEP, |of| (of / STEPS).clamp(1, FACES_A_STEP));
        Self { watch, gone: 0, said: 0, pace, of }
    }
}

impl Observe for Contractions<'_> {
    fn needs_surface(&self) -> bool {
        false
    }

    fn gone(&mut self, faces: usize) {
        self.gone += faces;
        if self.gone >= self.said + self.pace {
            self.said = self.gone;
            self.watch.step(self.gone, self.of);
        }
        end_if_cancelled(self.watch);
    }
}

/// Begins a stage of a job, unless the job is cancelled.
pub(crate) fn begin(watch: &dyn Watch, stage: &str) -> Result<(), JobError> {
    watch.stage(stage);
    if watch.is_cancelled() { Err(JobError::Cancelled) } else { Ok(()) }
}

/// Payload with which a cancelled job unwinds.
struct Unwound;

/// Ends a job that runs under [`cancellable`], if it is cancelled, by unwinding to there.
pub(crate) fn end_if_cancelled(watch: &dyn Watch) {
    if watch.is_cancelled() {
        // No panic: nothing is printed.
        resume_unwind(Box::new(Unwound));
    }
}

/// Runs a job, and returns [`JobError::Cancelled`] if [`end_if_cancelled`] has ended it.
pub(crate) fn cancellable<T>(job: impl FnOnce() -> Result<T, JobError>) -> Result<T, JobError> {
    match catch_unwind(AssertUnwindSafe(job)) {
        Ok(done) => done,
        Err(payload) if payload.is::<Unwound>() => Err(JobError::Cancelled),
        Err(defect) => resume_unwind(defect),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use meshlod_samples as samples;
    use meshlod_simplify::{Options, Simplifier, Target};

    use super::*;

    /// Watch that cancels a job after some steps.
    struct After(AtomicUsize);

    impl Watch for After {
        fn step(&self, _: usize, _: Option<usize>) {
            let left = self.0.load(Ordering::Relaxed);
            self.0.store(left.saturating_sub(1), Ordering::Relaxed);
        }

        fn is_cancelled(&self) -> bool {
            self.0.load(Ordering::Relaxed) == 0
        }
    }

    fn run(steps: usize) -> Result<usize, JobError> {
        let mesh = samples::sphere(60_000);
        let watch = After(AtomicUsize::new(steps));
        cancellable(|| {
            let mut simplifier =
                Simplifier::new(&mesh, &Options::default()).map_err(JobError::input)?;
            let report = simplifier.run(Target::Faces(100), &mut Contractions::new(&watch, None));
            Ok(report.map_err(JobError::input)?.output_faces)
        })
    }

    #[test]
    fn a_job_ends_where_it_is_cancelled() {
        assert!(matches!(run(3), Err(JobError::Cancelled)));
        assert!(run(usize::MAX).unwrap() <= 100);
    }
}
