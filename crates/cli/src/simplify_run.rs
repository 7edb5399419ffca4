//! Simplification of a scene, with its time, report and measured distance.

use std::path::Path;
use std::time::{Duration, Instant};

use meshlod::measure::{Distance, DistanceOptions, PreparedSurface};
use meshlod::simplify::{History, Progressive, SimplifyError};
use meshlod::{
    Borders, ConditionedScene, Mesh, Options, Report, Scene, SceneError, SceneSimplifier, Target,
};

use crate::session::Session;
use crate::session::failure::Failure;

/// A simplified scene with its report.
pub struct Simplified {
    pub meshes: Vec<Mesh>,
    pub report: Report,
    pub measured: Option<Distance>,
    /// Progressive mesh of all levels, if contractions were recorded.
    pub sequence: Option<Progressive>,
}

/// A scene ready to be simplified, with the time that its conditioning took.
pub struct ReadyScene<'s> {
    pub scene: ConditionedScene<'s>,
    path: &'s Path,
    time: Duration,
}

impl<'s> ReadyScene<'s> {
    /// Conditions a scene that was read from `path`.
    pub fn new(
        scene: &'s Scene,
        options: &Options,
        borders: Borders,
        path: &'s Path,
        session: &Session,
    ) -> Result<Self, Failure> {
        session.progress.stage("building connectivity");
        let start = Instant::now();
        let scene =
            ConditionedScene::new(scene, options, borders).map_err(|e| at(path, &e.into()))?;
        Ok(Self { scene, path, time: start.elapsed() })
    }
}

/// A running simplification of a scene, with its progress label and elapsed time.
pub struct SimplifyRun<'s> {
    simplifier: SceneSimplifier<'s>,
    session: &'s Session,
    path: &'s Path,
    /// Label shown on the terminal.
    label: String,
    time: Duration,
    /// Recorded contractions, if wanted.
    history: Option<History>,
}

impl<'s> SimplifyRun<'s> {
    /// Builds the connectivity of the meshes of a scene.
    pub fn start(ready: &'s ReadyScene<'_>, session: &'s Session) -> Result<Self, Failure> {
        session.progress.stage("building connectivity");
        let path = ready.path;
        let start = Instant::now();
        let simplifier = SceneSimplifier::new(&ready.scene).map_err(|e| at(path, &e))?;
        let (label, time) = ("simplifying".into(), ready.time + start.elapsed());
        Ok(Self { simplifier, session, path, label, time, history: None })
    }

    /// Sets the label of the progress line.
    pub fn set_label(&mut self, label: String) {
        self.label = label;
    }

    /// Records every contraction from now on, for [`Self::into_sequence`].
    pub fn record(&mut self) {
        self.history = Some(History::default());
    }

    /// Returns all recorded levels as a progressive mesh; `None` unless the scene has exactly one
    /// mesh and every contraction was recorded.
    pub fn into_sequence(self) -> Option<Progressive> {
        Progressive::new(self.simplifier.into_only()?, self.history?)
    }

    /// Continues the simplification to the given target.
    pub fn simplify_to(&mut self, target: Target) -> Result<Report, Failure> {
        let now = self.simplifier.live_faces();
        let to_go = match target {
            Target::Faces(faces) => Some(now.saturating_sub(faces)),
            Target::Ratio(ratio) => {
                Some(now.saturating_sub((self.input_faces() as f64 * ratio) as usize))
            }
            Target::Error(_) => None,
        };
        let mut watch = self.session.progress.contractions(&self.label, to_go);
        let start = Instant::now();
        let report = match &mut self.history {
            Some(history) => self.simplifier.run(target, &mut (watch, history)),
            None => self.simplifier.run(target, &mut watch),
        };
        self.time += start.elapsed();
        report.map_err(|error| at(self.path, &error.into()))
    }

    /// Returns the number of faces of the input scene.
    pub fn input_faces(&self) -> usize {
        self.simplifier.input_faces()
    }

    /// Returns the meshes of the scene as simplified so far, and notes in their report what volume
    /// they were repaid.
    pub fn level(&self, report: &mut Report) -> Vec<Mesh> {
        self.simplifier.settled_level(&mut report.volume)
    }

    /// Returns the wall-clock time spent so far on connectivity and contractions.
    pub fn time(&self) -> Duration {
        self.time
    }
}

/// Original surface, and how levels are measured against it.
pub type Original<'s, 'm> = (&'s PreparedSurface<'m>, DistanceOptions);

/// Measures the distance of a level from the original; prints a warning and returns `None` if that
/// is not possible.
pub fn measure(
    original: Option<Original<'_, '_>>,
    scene: &Scene,
    level: &[Mesh],
    session: &Session,
) -> Option<Distance> {
    let (original, options) = original?;
    session.progress.stage("measuring");
    crate::text::distance::of_level(original, scene, level, &options)
        .inspect_err(|error| session.warn(format_args!("not measured: {error}")))
        .ok()
}

/// Replaces the meshes of a scene by simplified ones.
pub fn replace(scene: &mut Scene, level: Vec<Mesh>) {
    for (mesh, level) in scene.meshes.iter_mut().zip(level) {
        mesh.mesh = level;
    }
}

fn at(path: &Path, error: &SceneError) -> Failure {
    match error {
        SceneError::Whole(SimplifyError::BadTarget(_)) => Failure::usage(error),
        error => Failure::at(path, error),
    }
}
