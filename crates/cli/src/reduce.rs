//! A scene made coarser, with the time it took and what it was measured to be off.

use std::path::Path;
use std::time::{Duration, Instant};

use meshlod::measure::{Distance, Surface};
use meshlod::simplify::{History, Progressive, Refusal, SimplifyError};
use meshlod::{Mesh, Options, Report, Scene, SceneError, SceneSimplifier, Target};
use serde_json::{Map, Value, json};

use crate::failure::Failure;
use crate::numbers::{count, faces, value};
use crate::session::Session;

/// A level of a scene.
pub struct Reduced {
    pub meshes: Vec<Mesh>,
    pub report: Report,
    pub measured: Option<Distance>,
    /// All levels on the way, where they are wanted.
    pub sequence: Option<Progressive>,
}

/// A simplifier and how long it has been at work.
pub struct Engine<'s> {
    simplifier: SceneSimplifier<'s>,
    session: &'s Session,
    path: &'s Path,
    /// What it does, as the terminal says.
    what: String,
    time: Duration,
    /// All contractions, where they are wanted.
    history: Option<History>,
}

impl<'s> Engine<'s> {
    /// Connects the meshes of `scene`, read from `path`.
    pub fn start(
        scene: &'s Scene,
        options: &Options,
        path: &'s Path,
        session: &'s Session,
    ) -> Result<Self, Failure> {
        session.progress.stage("building connectivity");
        let start = Instant::now();
        let simplifier = SceneSimplifier::new(scene, options).map_err(|e| at(path, &e))?;
        let what = "simplifying".into();
        Ok(Self { simplifier, session, path, what, time: start.elapsed(), history: None })
    }

    /// What the terminal says from here on.
    pub fn call(&mut self, what: String) {
        self.what = what;
    }

    /// Takes down every contraction from now on, for [`Self::into_sequence`].
    pub fn record(&mut self) {
        self.history = Some(History::default());
    }

    /// All levels that were passed; `None` unless the scene has one mesh and all was taken down.
    pub fn into_sequence(self) -> Option<Progressive> {
        Progressive::new(self.simplifier.into_only()?, self.history?)
    }

    /// Goes on to a target.
    pub fn run(&mut self, target: Target) -> Result<Report, Failure> {
        let now = self.simplifier.live_faces();
        let to_go = match target {
            Target::Faces(faces) => Some(now.saturating_sub(faces)),
            Target::Ratio(ratio) => {
                Some(now.saturating_sub((self.input_faces() as f64 * ratio) as usize))
            }
            Target::Error(_) => None,
        };
        let mut watch = self.session.progress.contractions(&self.what, to_go);
        let start = Instant::now();
        let report = match &mut self.history {
            Some(history) => self.simplifier.run(target, &mut (watch, history)),
            None => self.simplifier.run(target, &mut watch),
        };
        self.time += start.elapsed();
        report.map_err(|error| at(self.path, &error.into()))
    }

    /// Faces that the scene showed at first.
    pub fn input_faces(&self) -> usize {
        self.simplifier.input_faces()
    }

    /// The meshes as they are now.
    pub fn level(&self) -> Vec<Mesh> {
        self.simplifier.level()
    }

    /// Time spent in connecting and contracting, by the wall clock.
    pub fn time(&self) -> Duration {
        self.time
    }
}

/// Measures a level against the original, where that can be done.
pub fn measure(
    original: Option<&Surface<'_>>,
    scene: &Scene,
    level: &[Mesh],
    session: &Session,
) -> Option<Distance> {
    let original = original?;
    session.progress.stage("measuring");
    crate::distance::of_level(original, scene, level)
        .inspect_err(|error| session.warn(format_args!("not measured: {error}")))
        .ok()
}

/// Puts the meshes of a level in the place of those of the scene.
pub fn replace(scene: &mut Scene, level: Vec<Mesh>) {
    for (mesh, level) in scene.meshes.iter_mut().zip(level) {
        mesh.mesh = level;
    }
}

/// Why contractions were refused, and how often.
pub fn refusals_json(report: &Report) -> Value {
    let entry = |refusal: Refusal| (refusal.name().into(), report.refusals.count(refusal).into());
    Value::Object(Refusal::ALL.into_iter().map(entry).collect::<Map<String, Value>>())
}

/// The fields of a report that every verb gives.
pub fn report_json(report: &Report) -> Value {
    json!({
        "input_faces": report.input_faces,
        "output_faces": report.output_faces,
        "reached": report.reached,
        "error_estimate": report.error_estimate,
    })
}

/// One line that says why there are more faces than wanted.
pub fn why_not_reached(report: &Report) -> String {
    format!(
        "target not reached: no further contraction is possible at {} (refused: {})",
        faces(report.output_faces),
        report.refusals,
    )
}

/// Lines that say what was left out or kept in place; none for a clean mesh.
pub fn oddities(report: &Report) -> String {
    let mut text = String::new();
    let mut line = |number: usize, nouns: [&str; 2], what: &str| {
        let noun = nouns[usize::from(number != 1)];
        if number > 0 {
            text.push_str(&format!("{} {noun} {what}\n", count(number)));
        }
    };
    line(report.degenerate_faces, ["degenerate face", "degenerate faces"], "left out");
    line(report.duplicate_faces, ["duplicate face", "duplicate faces"], "left out");
    let vertices = ["vertex", "vertices"];
    let non_manifold = ["non-manifold vertex", "non-manifold vertices"];
    line(report.non_manifold_vertices, non_manifold, "kept in place");
    line(report.held.locked, vertices, "locked");
    line(report.held.protected, vertices, "protected");
    line(report.held.tied, vertices, "tied to others");
    line(report.vanished, ["small component", "small components"], "removed");
    text
}

/// Seconds as the verbs print them.
pub fn seconds_line(time: Duration) -> String {
    format!("simplify_seconds: {}\n", value(time.as_secs_f64()))
}

fn at(path: &Path, error: &SceneError) -> Failure {
    match error {
        SceneError::Whole(SimplifyError::BadTarget(_)) => Failure::usage(error),
        error => Failure::at(path, error),
    }
}
