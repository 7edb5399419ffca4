//! Chain of levels of one mesh by one method, with measurements.

use std::path::Path;
use std::time::Duration;

use meshlod::measure::{
    Distance, DistanceOptions, PreparedSurface, Quality, quality, surface_distance,
};
use meshlod::{Mesh, Method, Options, Report};

use crate::failure::Failure;
use crate::page::counts::Counts;
use crate::page::subject::Subject;
use crate::parse::LevelSize;
use crate::session::Session;
use crate::simplify_run::SimplifyRun;

/// Builder of a chain of levels.
pub struct ChainBuilder<'s> {
    subject: &'s Subject,
    original: &'s PreparedSurface<'s>,
    options: DistanceOptions,
    run: SimplifyRun<'s>,
    session: &'s Session,
    /// Label shown on the terminal.
    what: String,
}

/// Levels of one subject by one method, finest first; each is made from the one before.
pub struct Chain {
    pub method: Method,
    pub levels: Vec<Level>,
}

/// Figures of a level.
pub struct Level {
    /// Requested size.
    pub size: LevelSize,
    pub counts: Counts,
    pub report: Report,
    /// Distance from the input, or the reason why it was not measured.
    pub measured: Result<Distance, String>,
    pub quality: Option<Quality>,
    /// FLIP image error, if pictures were compared.
    pub flip: Option<f64>,
    /// Wall-clock time from the input to this level, for connectivity and contractions.
    pub time: Duration,
    /// File name in the folder of the page.
    pub file: String,
}

/// Level with its geometry.
pub struct LevelMesh {
    pub level: Level,
    /// Meshes that replace those of the scene.
    pub meshes: Vec<Mesh>,
    /// Flattened scene with these meshes.
    pub shown: Mesh,
}

/// Subject to simplify, and the options to measure it with.
#[derive(Clone, Copy)]
pub struct ChainSetup<'s> {
    pub subject: &'s Subject,
    pub original: &'s PreparedSurface<'s>,
    pub options: DistanceOptions,
    pub session: &'s Session,
}

impl<'s> ChainBuilder<'s> {
    /// Builds the connectivity of the subject's meshes; `what` labels the progress line.
    pub fn start(setup: ChainSetup<'s>, method: Method, what: String) -> Result<Self, Failure> {
        let ChainSetup { subject, original, options, session } = setup;
        let path = Path::new(&subject.name);
        let simplify = Options { method, ..Options::default() };
        session.progress.stage(&format!("{what}: building connectivity"));
        let run = SimplifyRun::start(&subject.scene, &simplify, path, session)?;
        Ok(Self { subject, original, options, run, session, what })
    }

    /// Simplifies to the next size and measures the level; `file` is the name it will have.
    pub fn next_level(&mut self, size: LevelSize, file: String) -> Result<LevelMesh, Failure> {
        self.run.set_label(format!("{} to {size}", self.what));
        let report = self.run.simplify_to(size.target())?;
        let meshes = self.run.level();
        self.session.progress.stage(&format!("{}: measuring", self.what));
        let shown = self.subject.shown_with(&meshes);
        let level = Level {
            size,
            counts: Counts::of(&shown),
            report,
            measured: self.distance_of(&shown),
            quality: quality(&shown),
            flip: None,
            time: self.run.time(),
            file,
        };
        Ok(LevelMesh { level, meshes, shown })
    }

    fn distance_of(&self, shown: &Mesh) -> Result<Distance, String> {
        let surface = PreparedSurface::new(shown).map_err(|error| error.to_string())?;
        surface_distance(self.original, &surface, &self.options).map_err(|error| error.to_string())
    }
}

impl Level {
    /// Returns the change of volume in percent; `None` if the input is open.
    pub fn volume_change(&self, input: &Counts) -> Option<f64> {
        let change = 100.0 * (self.counts.volume - input.volume) / input.volume.abs();
        (input.closed && change.is_finite()).then_some(change)
    }

    /// Returns true if closedness, genus and number of components are those of the input.
    pub fn has_topology_of(&self, input: &Counts) -> bool {
        let of = |counts: &Counts| (counts.closed, counts.genus, counts.components);
        of(&self.counts) == of(input)
    }

    /// Returns a measured length in percent of the diagonal.
    pub fn percent(&self, length: fn(&Distance) -> f64) -> Option<f64> {
        self.measured.as_ref().ok().map(|distance| distance.percent(length(distance)))
    }
}
