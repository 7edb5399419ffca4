//! Search for the simplified mesh with fewest faces whose measured distance is within a bound.

use std::time::Duration;

use meshlod::measure::{DistanceOptions, PreparedSurface};
use meshlod::{Report, Scene, Target};

use crate::failure::Failure;
use crate::session::Session;
use crate::simplify_run::{ReadyScene, Simplified, SimplifyRun, measure};

/// Search for the simplified scene with fewest faces whose measured distance is within a bound.
pub struct BoundSearch<'s> {
    pub scene: &'s Scene,
    /// The scene, ready to be simplified.
    pub ready: &'s ReadyScene<'s>,
    /// Original scene, prepared for distance measurements.
    pub original: &'s PreparedSurface<'s>,
    /// Largest measured distance allowed, in world units.
    pub bound: f64,
    pub session: &'s Session,
}

/// Number of halvings of the estimate bound before the search gives up.
const HALVINGS: usize = 12;

/// Growth of the estimate bound from level to level; four steps undo a halving.
const STEP: f64 = 1.189_207_115_002_721;

/// Limit of steps where no halving has set one: an estimate is never that far above the distance.
const MOST_STEPS: usize = 32;

impl BoundSearch<'_> {
    /// Finds the simplified scene and returns it with the total simplification time.
    ///
    /// The estimated error differs from the measured distance but grows with it. The bound on the
    /// estimate starts at the wanted distance and is halved, in fresh runs, until the level
    /// measures within; from there that run continues in small steps to the last level that does.
    pub fn run(&self) -> Result<(Simplified, Duration), Failure> {
        let mut estimate = self.bound;
        let mut time = Duration::ZERO;
        let mut halvings = 0;
        loop {
            let mut run = SimplifyRun::start(self.ready, self.session)?;
            let level = self.level(&mut run, estimate)?;
            let within = self.is_within(&level);
            if within || halvings == HALVINGS {
                let steps = if halvings == 0 { MOST_STEPS } else { 3 };
                let level = match within {
                    true => self.advance_within(&mut run, level, estimate, steps)?,
                    false => unreached(level),
                };
                return Ok((level, time + run.time()));
            }
            time += run.time();
            estimate /= 2.0;
            halvings += 1;
        }
    }

    /// Returns the last level within the bound, at most `steps` steps further.
    fn advance_within(
        &self,
        run: &mut SimplifyRun<'_>,
        mut best: Simplified,
        mut estimate: f64,
        steps: usize,
    ) -> Result<Simplified, Failure> {
        for _ in 0..steps {
            estimate *= STEP;
            let next = self.level(run, estimate)?;
            if !self.is_within(&next) {
                break;
            }
            best = next;
        }
        Ok(best)
    }

    fn level(&self, run: &mut SimplifyRun<'_>, estimate: f64) -> Result<Simplified, Failure> {
        let mut report = run.simplify_to(Target::Error(estimate))?;
        let meshes = run.level(&mut report);
        let original = (self.original, DistanceOptions::default());
        let measured = measure(Some(original), self.scene, &meshes, self.session);
        Ok(Simplified { meshes, report, measured, sequence: None })
    }

    fn is_within(&self, level: &Simplified) -> bool {
        level.measured.is_some_and(|distance| distance.max() <= self.bound)
    }
}

fn unreached(level: Simplified) -> Simplified {
    Simplified { report: Report { reached: false, ..level.report }, ..level }
}
