//! A chain of levels by one method, each measured against the input.

use std::time::{Duration, Instant};

use meshlod::measure::{Distance, DistanceOptions, Quality, Surface, quality, surface_distance};
use meshlod::simplify::Simplifier;
use meshlod::{Mesh, Method, Options, Report, Target};

use crate::demo::counts::Counts;
use crate::failure::Failure;
use crate::session::Session;

/// The levels of a chain, as parts of the input's faces.
pub const RATIOS: [f64; 4] = [0.5, 0.25, 0.1, 0.03];

/// Samples each way, beside all vertices: the mean within about 0.2 %, and a page in seconds.
pub const SAMPLES: usize = 100_000;

/// Levels of one mesh by one method, finest first; each is made of the one before.
pub struct Chain {
    pub method: Method,
    pub levels: Vec<Level>,
}

/// A level and all that is measured of it.
pub struct Level {
    /// What was asked for.
    pub ratio: f64,
    pub mesh: Mesh,
    pub counts: Counts,
    pub report: Report,
    pub distance: Distance,
    pub quality: Quality,
    /// From the input to here: connecting and contracting, by the wall clock.
    pub time: Duration,
}

/// A mesh that chains are made of.
pub struct Original<'m> {
    pub name: &'static str,
    pub mesh: &'m Mesh,
    pub surface: Surface<'m>,
}

impl<'m> Original<'m> {
    pub fn new(name: &'static str, mesh: &'m Mesh) -> Result<Self, Failure> {
        let surface = Surface::new(mesh).map_err(|error| named(name, error))?;
        Ok(Self { name, mesh, surface })
    }

    /// All levels of a method, by one run.
    pub fn chain(&self, method: Method, session: &Session) -> Result<Chain, Failure> {
        let fail = |error| named(self.name, error);
        let options = Options { method, ..Options::default() };
        let start = Instant::now();
        let mut simplifier = Simplifier::new(self.mesh, &options).map_err(fail)?;
        let mut time = start.elapsed();
        let mut levels = Vec::new();
        for ratio in RATIOS {
            let to_go = simplifier.live_faces() - (self.mesh.faces.len() as f64 * ratio) as usize;
            let what = format!("{}: {} to {}%", self.name, method.name(), 100.0 * ratio);
            let mut watch = session.progress.contractions(&what, Some(to_go));
            let start = Instant::now();
            let report = simplifier.run(Target::Ratio(ratio), &mut watch).map_err(fail)?;
            time += start.elapsed();
            session.progress.stage(&format!("{}: measuring", self.name));
            levels.push(self.level(ratio, simplifier.level(), report, time)?);
        }
        Ok(Chain { method, levels })
    }

    fn level(
        &self,
        ratio: f64,
        mesh: Mesh,
        report: Report,
        time: Duration,
    ) -> Result<Level, Failure> {
        let fail = |error: &dyn std::fmt::Display| named(self.name, error);
        let surface = Surface::new(&mesh).map_err(|error| fail(&error))?;
        let options = DistanceOptions { samples: SAMPLES, ..DistanceOptions::default() };
        let distance =
            surface_distance(&self.surface, &surface, &options).map_err(|error| fail(&error))?;
        let quality = quality(&mesh).ok_or_else(|| fail(&"no faces are left"))?;
        let counts = Counts::of(&mesh);
        Ok(Level { ratio, mesh, counts, report, distance, quality, time })
    }
}

impl Level {
    /// What became of the volume, in percent of the input's.
    pub fn volume_change(&self, input: &Counts) -> f64 {
        100.0 * (self.counts.volume - input.volume) / input.volume.abs()
    }

    /// Whether the surface hangs together as the input's does.
    pub fn is_as_whole_as(&self, input: &Counts) -> bool {
        let of = |counts: &Counts| (counts.closed, counts.genus, counts.components);
        of(&self.counts) == of(input)
    }
}

fn named(name: &str, error: impl std::fmt::Display) -> Failure {
    Failure::new(format_args!("{name}: {error}"))
}
