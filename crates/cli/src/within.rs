//! The search for the coarsest level that measures within a bound.

use std::path::Path;
use std::time::Duration;

use meshlod::measure::Surface;
use meshlod::{Options, Report, Scene, Target};

use crate::failure::Failure;
use crate::reduce::{Engine, Reduced, measure};
use crate::session::Session;

/// What is searched, and for what.
pub struct Search<'s> {
    pub scene: &'s Scene,
    pub options: &'s Options,
    /// The scene's surface.
    pub original: &'s Surface<'s>,
    /// The greatest distance allowed, in world units.
    pub bound: f64,
    pub path: &'s Path,
    pub session: &'s Session,
}

/// How often the engine's own bound is halved before the search gives up.
const HALVINGS: usize = 12;

/// By what the engine's own bound grows from level to level. Four steps make a halving good.
const STEP: f64 = 1.189_207_115_002_721;

/// Steps without an upper end: the estimate cannot be that far above what is measured.
const MOST_STEPS: usize = 32;

impl Search<'_> {
    /// Finds it, and says how long the engine worked in all.
    ///
    /// The estimate of the engine is not the distance measured, but grows with it. So its bound
    /// starts at the wanted one and is halved, in fresh runs, until the level measures within; from
    /// there that run goes on in small steps to the last level that does.
    pub fn run(&self) -> Result<(Reduced, Duration), Failure> {
        let mut estimate = self.bound;
        let mut time = Duration::ZERO;
        let mut halvings = 0;
        loop {
            let mut engine = Engine::start(self.scene, self.options, self.path, self.session)?;
            let level = self.level(&mut engine, estimate)?;
            let within = self.is_within(&level);
            if within || halvings == HALVINGS {
                let steps = if halvings == 0 { MOST_STEPS } else { 3 };
                let level = match within {
                    true => self.go_on(&mut engine, level, estimate, steps)?,
                    false => unreached(level),
                };
                return Ok((level, time + engine.time()));
            }
            time += engine.time();
            estimate /= 2.0;
            halvings += 1;
        }
    }

    /// The last level within the bound, at most so many steps on.
    fn go_on(
        &self,
        engine: &mut Engine<'_>,
        mut best: Reduced,
        mut estimate: f64,
        steps: usize,
    ) -> Result<Reduced, Failure> {
        for _ in 0..steps {
            estimate *= STEP;
            let next = self.level(engine, estimate)?;
            if !self.is_within(&next) {
                break;
            }
            best = next;
        }
        Ok(best)
    }

    fn level(&self, engine: &mut Engine<'_>, estimate: f64) -> Result<Reduced, Failure> {
        let report = engine.run(Target::Error(estimate))?;
        let meshes = engine.level();
        let measured = measure(Some(self.original), self.scene, &meshes, self.session);
        Ok(Reduced { meshes, report, measured, sequence: None })
    }

    fn is_within(&self, level: &Reduced) -> bool {
        level.measured.is_some_and(|distance| distance.max() <= self.bound)
    }
}

fn unreached(level: Reduced) -> Reduced {
    Reduced { report: Report { reached: false, ..level.report }, ..level }
}
