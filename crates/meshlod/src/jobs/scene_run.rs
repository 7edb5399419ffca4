//! Parts shared by the jobs that simplify a scene: preparation, a run, and how far it went.

use std::cell::OnceCell;
use std::time::{Duration, Instant};

use meshlod_io::{Node, Scene, SceneMesh};
use meshlod_measure::{
    Distance, DistanceOptions, MeasureError, PreparedSurface, SurfaceError, surface_distance,
};
use meshlod_mesh::Mesh;
use meshlod_simplify::{
    AttributeWeights, Digits, ExactVolumeError, Method, Options, Report, SimplifyError, Target,
};

use crate::jobs::copies::{Copies, Surfaces};
use crate::jobs::{About, Contractions, JobError, Remark, Watch};
use crate::scene::{ConditionedScene, FuseReport, SceneError, SceneSimplifier, conserve_volumes};
use crate::{Constraints, VertexLocking};

/// Fuses a scene, if that is asked for.
pub(super) fn fuse(scene: &mut Scene, is_wanted: bool, watch: &dyn Watch) -> Option<FuseReport> {
    is_wanted.then(|| {
        watch.stage("fusing");
        FuseReport::of(scene)
    })
}

/// Method of a run with what it weighs and keeps.
pub(super) struct RunChoice<'r> {
    pub method: Method,
    pub weights: AttributeWeights,
    pub boundary: Option<f64>,
    pub polish: bool,
    pub constraints: &'r Constraints,
}

impl RunChoice<'_> {
    /// Returns the options for a scene that is already fused.
    fn options(&self, scene: &Scene, watch: &dyn Watch) -> Result<Options, JobError> {
        let Self { method, weights, boundary: boundary_weight, polish, constraints } = *self;
        if matches!(constraints.locks, VertexLocking::Contacts(_)) {
            watch.stage("looking for contacts");
        }
        let options = Options { method, weights, boundary_weight, polish, ..Options::default() };
        constraints.options(scene, options).map_err(JobError::input)
    }

    /// Conditions a scene, and returns the time that it took.
    pub fn condition<'s>(
        &self,
        scene: &'s Scene,
        watch: &dyn Watch,
    ) -> Result<(ConditionedScene<'s>, Duration), JobError> {
        let options = self.options(scene, watch)?;
        watch.stage("building connectivity");
        let start = Instant::now();
        let ready = ConditionedScene::new(scene, &options, self.constraints.borders);
        Ok((ready.map_err(JobError::input)?, start.elapsed()))
    }

    /// Remarks on options that the method ignores.
    pub fn remark(&self, watch: &dyn Watch) {
        let (method, name) = (self.method, self.method.name());
        if self.weights != AttributeWeights::DEFAULT && !method.counts_attributes() {
            watch.remark(&Remark::field(
                "weight_…",
                format_args!("{name} ignores attributes; use lindstrom-turk, qem or qem-endpoint"),
            ));
        }
        if self.polish && method != Method::LindstromTurk {
            let reason = format_args!("{name} does not polish; use lindstrom-turk");
            watch.remark(&Remark::field("polish", reason));
        }
        if self.boundary.is_some() && !method.weighs_boundaries() {
            watch.remark(&Remark::field(
                "boundary",
                format_args!("{name} has no boundary weight; use lindstrom-turk or qem"),
            ));
        }
    }
}

/// A running simplification of a scene, with the time it took so far.
pub(super) struct SceneRun<'s> {
    simplifier: SceneSimplifier<'s>,
    watch: &'s dyn Watch,
    time: Duration,
}

impl<'s> SceneRun<'s> {
    /// Builds the connectivity of a scene whose conditioning took some time.
    pub fn start(
        ready: &'s ConditionedScene<'_>,
        time: Duration,
        watch: &'s dyn Watch,
    ) -> Result<Self, JobError> {
        watch.stage("building connectivity");
        let start = Instant::now();
        let simplifier = SceneSimplifier::new(ready).map_err(fault)?;
        Ok(Self { simplifier, watch, time: time + start.elapsed() })
    }

    /// Goes on to a target.
    pub fn simplify_to(&mut self, target: Target) -> Result<Report, JobError> {
        let now = self.simplifier.live_faces();
        let to_go = match target {
            Target::Faces(faces) => Some(now.saturating_sub(faces)),
            Target::Ratio(ratio) => {
                Some(now.saturating_sub((self.input_faces() as f64 * ratio) as usize))
            }
            Target::Error(_) => None,
        };
        self.watch.stage("simplifying");
        let start = Instant::now();
        let report = self.simplifier.run(target, &mut Contractions::new(self.watch, to_go));
        self.time += start.elapsed();
        report.map_err(|error| fault(error.into()))
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

    /// Returns the time spent so far on conditioning, connectivity and contractions.
    pub fn time(&self) -> Duration {
        self.time
    }
}

fn fault(error: SceneError) -> JobError {
    match error {
        SceneError::Whole(error @ SimplifyError::BadTarget(_)) => JobError::request("", error),
        error => JobError::input(error),
    }
}

/// Restores the volumes of the meshes of a level. Returns the largest relative deviation that is
/// left, or `None` if no mesh has a volume; remarks on meshes that could not be restored.
pub(super) fn restore_volumes(
    ready: &ConditionedScene<'_>,
    level: &mut [Mesh],
    digits: Digits,
    watch: &dyn Watch,
) -> Option<f64> {
    let found = conserve_volumes(ready, level, digits);
    let several = found.len() > 1;
    let mut worst: Option<f64> = None;
    for (i, residual) in found.into_iter().enumerate() {
        match residual {
            Ok(residual) => worst = Some(residual.after.abs().max(worst.unwrap_or(0.0))),
            Err(error) => watch.remark(&not_restored(&error, several.then_some(i))),
        }
    }
    worst
}

fn not_restored(error: &ExactVolumeError, mesh: Option<usize>) -> Remark {
    match mesh {
        Some(i) => Remark::field("exact_volume", format_args!("mesh {i}: {error}")),
        None => Remark::field("exact_volume", error),
    }
}

/// Replaces the meshes of a scene by those of a level.
pub(super) fn replace(scene: &mut Scene, level: Vec<Mesh>) {
    for (mesh, level) in scene.meshes.iter_mut().zip(level) {
        mesh.mesh = level;
    }
}

/// Joins the meshes of a scene into one surface in world space without attributes, with `meshes` in
/// place of its own.
pub(super) fn surface_of<'m>(scene: &Scene, meshes: impl IntoIterator<Item = &'m Mesh>) -> Mesh {
    let bare = |mesh: &Mesh| Mesh::new(mesh.positions.clone(), mesh.faces.clone());
    let meshes = meshes.into_iter().map(|m| SceneMesh { mesh: bare(m), ..SceneMesh::default() });
    Scene {
        meshes: meshes.collect(),
        nodes: scene.nodes.clone(),
        roots: scene.roots.clone(),
        ..Scene::default()
    }
    .into_mesh()
}

/// Joins the meshes of a scene into one surface in world space without attributes.
pub(super) fn own_surface(scene: &Scene) -> Mesh {
    surface_of(scene, scene.meshes.iter().map(|mesh| &mesh.mesh))
}

/// Returns the surface that a scene shows, as [`own_surface`] does; `whole` keeps it, unless it is a
/// mesh of the scene as it is.
pub(super) fn shown_surface<'m>(scene: &'m Scene, whole: &'m OnceCell<Mesh>) -> &'m Mesh {
    let as_it_is = Node::default().transform;
    match scene.instances()[..] {
        [only] if only.transform == as_it_is => &scene.meshes[only.mesh].mesh,
        _ => whole.get_or_init(|| own_surface(scene)),
    }
}

/// A scene from which levels are measured.
pub(super) struct Original<'m> {
    scene: &'m Scene,
    surface: OriginalSurface<'m>,
}

enum OriginalSurface<'m> {
    /// All that the scene shows, in world space.
    Whole(PreparedSurface<'m>),
    /// Meshes that the scene shows many times.
    Copies(Copies, Surfaces<'m>),
}

impl<'m> Original<'m> {
    /// Prepares a scene. `whole` keeps the surface that it shows, if that is needed.
    ///
    /// # Errors
    /// A surface that cannot be measured.
    pub fn new(scene: &'m Scene, whole: &'m OnceCell<Mesh>) -> Result<Self, SurfaceError> {
        let copies = Copies::of(scene);
        let surfaces = copies.as_ref().and_then(|copies| copies.prepare(|i| &scene.meshes[i].mesh));
        let surface = match copies.zip(surfaces) {
            Some((copies, surfaces)) => OriginalSurface::Copies(copies, surfaces),
            None => OriginalSurface::Whole(PreparedSurface::new(shown_surface(scene, whole))?),
        };
        Ok(Self { scene, surface })
    }

    /// Returns the number of faces that are measured.
    pub fn faces(&self) -> usize {
        match &self.surface {
            OriginalSurface::Whole(surface) => surface.mesh().faces.len(),
            OriginalSurface::Copies(_, surfaces) => {
                surfaces.iter().flatten().map(|surface| surface.mesh().faces.len()).sum()
            }
        }
    }

    /// Measures the distance of a level; remarks and returns `None` if that is not possible.
    pub fn measure(
        &self,
        options: &DistanceOptions,
        level: &[Mesh],
        watch: &dyn Watch,
    ) -> Option<Distance> {
        watch.stage("measuring");
        self.apart(options, level)
            .inspect_err(|error| {
                watch.remark(&Remark::new(About::Job, format_args!("not measured: {error}")));
            })
            .ok()
    }

    fn apart(&self, options: &DistanceOptions, level: &[Mesh]) -> Result<Distance, MeasureError> {
        let whole = |original: &PreparedSurface<'_>| {
            let level = surface_of(self.scene, level);
            let level = PreparedSurface::new(&level).map_err(MeasureError::Second)?;
            surface_distance(original, &level, options)
        };
        match &self.surface {
            OriginalSurface::Whole(original) => whole(original),
            OriginalSurface::Copies(copies, original) => match copies.prepare(|i| &level[i]) {
                Some(level) => copies.apart([original, &level], options),
                // Where nothing is left of a mesh, others are the closest.
                None => {
                    let original = own_surface(self.scene);
                    whole(&PreparedSurface::new(&original).map_err(MeasureError::First)?)
                }
            },
        }
    }
}
