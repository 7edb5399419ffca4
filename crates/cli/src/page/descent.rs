//! The way down from a mesh by one method, with a level at every stop.

use std::path::Path;
use std::time::Duration;

use meshlod::measure::{Distance, DistanceOptions, Quality, Surface, quality, surface_distance};
use meshlod::{Mesh, Method, Options, Report};

use crate::amounts::Size;
use crate::failure::Failure;
use crate::page::counts::Counts;
use crate::page::subject::Subject;
use crate::reduce::Engine;
use crate::session::Session;

/// A subject that is being made coarser.
pub struct Descent<'s> {
    subject: &'s Subject,
    original: &'s Surface<'s>,
    options: DistanceOptions,
    engine: Engine<'s>,
    session: &'s Session,
    /// What the terminal says is at work.
    what: String,
}

/// Levels of one subject by one method, finest first; each is made of the one before.
pub struct Chain {
    pub method: Method,
    pub levels: Vec<Level>,
}

/// All figures of a level.
pub struct Level {
    /// What was asked for.
    pub size: Size,
    pub counts: Counts,
    pub report: Report,
    /// Its distance from the input, or why there is none.
    pub measured: Result<Distance, String>,
    pub quality: Option<Quality>,
    /// How different it looks, where pictures were compared.
    pub flip: Option<f64>,
    /// From the input to here: connecting and contracting, by the wall clock.
    pub time: Duration,
    /// The name of its file, in the folder of the page.
    pub file: String,
}

/// A level and its geometry.
pub struct Made {
    pub level: Level,
    /// In the place of the scene's.
    pub meshes: Vec<Mesh>,
    /// What the scene shows with them.
    pub shown: Mesh,
}

/// What is measured, and how.
#[derive(Clone, Copy)]
pub struct Bench<'s> {
    pub subject: &'s Subject,
    pub original: &'s Surface<'s>,
    pub options: DistanceOptions,
    pub session: &'s Session,
}

impl<'s> Descent<'s> {
    /// Connects the subject's meshes; `what` is at work, as the terminal shall say.
    pub fn start(bench: Bench<'s>, method: Method, what: String) -> Result<Self, Failure> {
        let Bench { subject, original, options, session } = bench;
        let path = Path::new(&subject.name);
        let manner = Options { method: Some(method), ..Options::default() };
        session.progress.stage(&format!("{what}: building connectivity"));
        let engine = Engine::start(&subject.scene, &manner, path, session)?;
        Ok(Self { subject, original, options, engine, session, what })
    }

    /// Goes on to a size; `file` is where the level will be.
    pub fn go_on(&mut self, size: Size, file: String) -> Result<Made, Failure> {
        self.engine.call(format!("{} to {size}", self.what));
        let report = self.engine.run(size.target())?;
        let meshes = self.engine.level();
        self.session.progress.stage(&format!("{}: measuring", self.what));
        let shown = self.subject.shown_with(&meshes);
        let level = Level {
            size,
            counts: Counts::of(&shown),
            report,
            measured: self.distance_of(&shown),
            quality: quality(&shown),
            flip: None,
            time: self.engine.time(),
            file,
        };
        Ok(Made { level, meshes, shown })
    }

    fn distance_of(&self, shown: &Mesh) -> Result<Distance, String> {
        let surface = Surface::new(shown).map_err(|error| error.to_string())?;
        surface_distance(self.original, &surface, &self.options).map_err(|error| error.to_string())
    }
}

impl Level {
    /// What became of the volume, in percent of the input's; `None` where the input is open and has
    /// none.
    pub fn volume_change(&self, input: &Counts) -> Option<f64> {
        let change = 100.0 * (self.counts.volume - input.volume) / input.volume.abs();
        (input.closed && change.is_finite()).then_some(change)
    }

    /// Whether the surface hangs together as the input's does.
    pub fn is_as_whole_as(&self, input: &Counts) -> bool {
        let of = |counts: &Counts| (counts.closed, counts.genus, counts.components);
        of(&self.counts) == of(input)
    }

    /// A measured length in percent of the diagonal.
    pub fn percent(&self, length: fn(&Distance) -> f64) -> Option<f64> {
        self.measured.as_ref().ok().map(|distance| distance.percent(length(distance)))
    }
}
