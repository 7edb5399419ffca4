//! Levels of one mesh made by one method, with their measurements.

use std::path::Path;
use std::time::{Duration, Instant};

use meshlod::measure::{
    Distance, DistanceOptions, PreparedSurface, Quality, quality, surface_distance,
};
use meshlod::scene::{ConditionedScene, SceneSimplifier};
use meshlod::{Borders, Mesh, Method, Options, Report, Target};

use crate::options::parse::LevelSize;
use crate::page::counts::Counts;
use crate::page::subject::Subject;
use crate::session::Session;
use crate::session::failure::Failure;

/// A scene ready to be simplified, with the time that its conditioning took.
pub struct ReadyScene<'s> {
    pub scene: ConditionedScene<'s>,
    time: Duration,
}

impl<'s> ReadyScene<'s> {
    /// Conditions the scene of a page.
    pub fn new(
        subject: &'s Subject,
        options: &Options,
        borders: Borders,
        session: &Session,
    ) -> Result<Self, Failure> {
        session.progress.stage("building connectivity");
        let start = Instant::now();
        let scene = ConditionedScene::new(&subject.scene, options, borders);
        let scene = scene.map_err(|error| Failure::at(Path::new(&subject.name), error))?;
        Ok(Self { scene, time: start.elapsed() })
    }
}

/// Builder of successive levels of one mesh by one method.
pub struct ChainBuilder<'s> {
    subject: &'s Subject,
    original: &'s PreparedSurface<'s>,
    options: DistanceOptions,
    simplifier: SceneSimplifier<'s>,
    time: Duration,
    session: &'s Session,
    /// Label shown on the terminal.
    what: String,
}

/// Successive levels of a mesh made by one method, finest first; each is made from the previous
/// one.
pub struct Chain {
    pub method: Method,
    pub levels: Vec<Level>,
}

/// Measurements of a simplified mesh.
pub struct Level {
    /// Requested number or ratio of faces.
    pub size: LevelSize,
    pub counts: Counts,
    pub report: Report,
    /// Distance from the original mesh, or the reason why it was not measured.
    pub measured: Result<Distance, String>,
    pub quality: Option<Quality>,
    /// FLIP image error against the original mesh, if pictures were compared.
    pub flip: Option<f64>,
    /// Wall-clock time from the original mesh to this level, for connectivity and contractions.
    pub time: Duration,
    /// Name of the mesh file in the folder of the page.
    pub file: String,
}

/// A simplified scene with its measurements.
pub struct LevelMesh {
    pub level: Level,
    /// Simplified meshes in the order of the scene's own, which they replace.
    pub meshes: Vec<Mesh>,
    /// The simplified scene, flattened to one mesh.
    pub shown: Mesh,
}

/// A mesh to simplify in several levels, and the options to measure them with.
#[derive(Clone, Copy)]
pub struct ChainSetup<'s> {
    pub subject: &'s Subject,
    pub original: &'s PreparedSurface<'s>,
    pub options: DistanceOptions,
    pub session: &'s Session,
}

impl<'s> ChainBuilder<'s> {
    /// Builds the connectivity of all meshes to be simplified; `what` is the label of the progress
    /// line.
    pub fn start(
        setup: ChainSetup<'s>,
        ready: &'s ReadyScene<'_>,
        what: String,
    ) -> Result<Self, Failure> {
        let ChainSetup { subject, original, options, session } = setup;
        session.progress.stage(&format!("{what}: building connectivity"));
        let start = Instant::now();
        let simplifier = SceneSimplifier::new(&ready.scene);
        let simplifier =
            simplifier.map_err(|error| Failure::at(Path::new(&subject.name), error))?;
        let time = ready.time + start.elapsed();
        Ok(Self { subject, original, options, simplifier, time, session, what })
    }

    /// Simplifies to the next size, that of `target` for the mesh at hand, and measures the result;
    /// `file` is the name of the file to be written.
    pub fn next_level(
        &mut self,
        size: LevelSize,
        target: Target,
        file: String,
    ) -> Result<LevelMesh, Failure> {
        let mut report = self.simplify_to(target, &format!("{} to {size}", self.what))?;
        let meshes = self.simplifier.settled_level(&mut report.volume);
        self.session.progress.stage(&format!("{}: measuring", self.what));
        let shown = self.subject.shown_with(&meshes);
        let level = Level {
            size,
            counts: Counts::of(&shown),
            report,
            measured: self.distance_of(&shown),
            quality: quality(&shown),
            flip: None,
            time: self.time,
            file,
        };
        Ok(LevelMesh { level, meshes, shown })
    }

    fn simplify_to(&mut self, target: Target, label: &str) -> Result<Report, Failure> {
        let now = self.simplifier.live_faces();
        let to_go = now.saturating_sub(target.faces_of(self.simplifier.input_faces()));
        let mut watch = self.session.progress.contractions(label, Some(to_go));
        let start = Instant::now();
        let report = self.simplifier.run(target, &mut watch);
        self.time += start.elapsed();
        report.map_err(|error| Failure::at(Path::new(&self.subject.name), error))
    }

    fn distance_of(&self, shown: &Mesh) -> Result<Distance, String> {
        let surface = PreparedSurface::new(shown).map_err(|error| error.to_string())?;
        surface_distance(self.original, &surface, &self.options).map_err(|error| error.to_string())
    }
}

impl Level {
    /// Returns the change of volume in percent; `None` if the original mesh is open.
    pub fn volume_change(&self, input: &Counts) -> Option<f64> {
        let change = 100.0 * (self.counts.volume - input.volume) / input.volume.abs();
        (input.closed && change.is_finite()).then_some(change)
    }

    /// Returns true if the level agrees with the original mesh in closedness, genus and number of
    /// components.
    pub fn has_topology_of(&self, input: &Counts) -> bool {
        let of = |counts: &Counts| (counts.closed, counts.genus, counts.components);
        of(&self.counts) == of(input)
    }

    /// Returns one of the measured distances in percent of the diagonal.
    pub fn percent(&self, length: fn(&Distance) -> f64) -> Option<f64> {
        self.measured.as_ref().ok().map(|distance| distance.percent(length(distance)))
    }
}
