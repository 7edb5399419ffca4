//! Triangle strips of the levels of a scene, and strips that follow a cut.

mod follow;
mod meshes;
mod report;
mod request;
#[cfg(test)]
mod tests;
mod verify;

use std::time::{Duration, Instant};

use meshlod_io::Scene;
use meshlod_io::gltf::StripMesh;
use meshlod_mesh::Mesh;
use meshlod_simplify::{Options, SimplifyError, Target};
use meshlod_strip::{Filter, MergeTree, SkipStrip, StripStatistics, Strips, stripify};

pub use self::follow::{FollowReport, FollowRequest, FollowedCut, follow_strips};
use self::meshes::scene_strips;
use self::report::odd_faces;
pub use self::report::{StripReport, StrippedLevelReport};
pub use self::request::{StripFilter, StripRequest};
use self::request::{check_sizes, options, quality_name, size_text};
use crate::VertexLocking;
use crate::jobs::faceless::refuse_points;
use crate::jobs::{About, JobError, Remark, Watch, begin};
use crate::numbers;
use crate::scene::FuseReport;
use crate::scene::place::shown_faces;

/// Strips of a scene and its levels.
#[derive(Clone, Debug)]
pub struct Stripped {
    /// The scene, fused if that was asked for.
    pub scene: Scene,
    /// The scene merged into one mesh.
    pub mesh: Mesh,
    /// Contractions of that mesh down to the coarsest level.
    pub tree: MergeTree,
    /// Strips of each level, in the order of the request; their vertices are those of the tree.
    pub levels: Vec<Strips>,
}

impl Stripped {
    /// Returns the strips of the meshes of the scene, the finest level first and empty ones left
    /// out, to be written by [`Output::write_strips`](crate::Output::write_strips).
    pub fn strip_meshes(&self) -> Vec<StripMesh> {
        let mut drawn: Vec<(usize, &Strips)> = self
            .levels
            .iter()
            .filter(|level| !level.is_empty())
            .map(|level| (level.triangles().count(), level))
            .collect();
        drawn.sort_by_key(|&(triangles, _)| std::cmp::Reverse(triangles));
        let strips: Vec<&Strips> = drawn.into_iter().map(|(_, level)| level).collect();
        scene_strips(&self.scene, &self.mesh, &self.tree, &strips)
    }
}

/// Makes triangle strips of a scene, merged into one mesh, and of levels of it.
///
/// Levels come from half-edge contractions, so that all have vertices of the mesh. Strips never run
/// across instances or materials. [`strip`](crate::strip) has the parts.
///
/// # Errors
/// Sizes out of range, locks of another scene, and a scene without a face that is not degenerate.
///
/// ```
/// use meshlod::jobs::{StripRequest, strip};
/// use meshlod::{Scene, Target, samples};
///
/// let knot = Scene::from_mesh("knot", samples::knot(2_000));
/// let levels = vec![Target::Ratio(1.0), Target::Ratio(0.1)];
/// let request = StripRequest { levels, verify: true, ..StripRequest::default() };
/// let (stripped, report) = strip(knot, &request, &())?;
/// assert_eq!(report.verified, Some(true));
/// assert!(report.levels[1].vertices_sent < 3 * report.levels[1].triangles / 2);
/// assert_eq!(stripped.strip_meshes().len(), 1);
/// # Ok::<(), meshlod::jobs::JobError>(())
/// ```
pub fn strip(
    mut scene: Scene,
    request: &StripRequest,
    watch: &dyn Watch,
) -> Result<(Stripped, StripReport), JobError> {
    refuse_points(&scene)?;
    let fused = request.constraints.fuse.then(|| {
        watch.stage("fusing");
        FuseReport::of(&mut scene)
    });
    remark_copies(&scene, watch);
    if matches!(request.constraints.locks, VertexLocking::Contacts(_)) {
        watch.stage("looking for contacts");
    }
    let flat = request.constraints.flatten(scene.clone(), Options::default());
    let (mesh, options) = flat.map_err(JobError::input)?;
    let input_faces = fused.as_ref().map_or(mesh.faces.len(), |fused| fused.input_faces);
    check_sizes(&request.levels, input_faces)?;
    let input = FlatScene { mesh, options, fused };
    let mut source = StripSource::new(input, request, watch)?;
    let mut levels = Vec::new();
    let mut reports = Vec::new();
    for &size in &request.levels {
        begin(watch, &format!("stripping {}", size_text(size)))?;
        let (strips, report) = source.level(size, request);
        levels.push(strips);
        reports.push(report);
    }
    if request.verify {
        begin(watch, "verifying")?;
        verify::compare(&source.input, &source.tree, &levels, &mut reports)
            .map_err(JobError::input)?;
    }
    let report = source.report(request, input_faces, reports);
    let StripSource { input: FlatScene { mesh, .. }, tree, .. } = source;
    Ok((Stripped { scene, mesh, tree, levels }, report))
}

/// Multiple of the faces of meshes from which on a scene that shows them is warned of.
const MANY_COPIES: usize = 2;

/// Remarks on meshes that several nodes show, since each of these gets strips of its own.
fn remark_copies(scene: &Scene, watch: &dyn Watch) {
    let mut is_shown = vec![false; scene.meshes.len()];
    scene.instances().iter().for_each(|instance| is_shown[instance.mesh] = true);
    let own = scene.meshes.iter().zip(is_shown).filter(|(_, is_shown)| *is_shown);
    let own: usize = own.map(|(mesh, _)| mesh.mesh.faces.len()).sum();
    let shown = shown_faces(scene);
    if own > 0 && shown >= MANY_COPIES * own {
        let reason = format_args!(
            "its nodes show {} of meshes with {}: every copy is stripped and written by itself, \
             which takes {} times the time and bytes; strip the meshes alone to share them",
            numbers::faces(shown),
            numbers::faces(own),
            shown / own
        );
        watch.remark(&Remark::new(About::Input, reason));
    }
}

/// A scene merged into one mesh, with the options to simplify it by.
struct FlatScene {
    mesh: Mesh,
    options: Options,
    fused: Option<FuseReport>,
}

impl FlatScene {
    /// Returns the largest number of faces of a level; ratios are of the faces before fusing.
    fn faces_of(&self, size: Target) -> usize {
        let size = self.fused.map_or(size, |fused| fused.target(size));
        size.faces_of(self.mesh.faces.len())
    }
}

/// Mesh and contractions that all levels come from.
struct StripSource {
    input: FlatScene,
    tree: MergeTree,
    simplify_time: Duration,
    /// Strips of the whole mesh that filters shorten.
    skip: Option<SkipStrip>,
    strip_time: Duration,
}

impl StripSource {
    /// Records the contractions down to the coarsest level, and strips the whole mesh for a filter.
    fn new(input: FlatScene, request: &StripRequest, watch: &dyn Watch) -> Result<Self, JobError> {
        let whole = MergeTree::new(&input.mesh);
        if whole.faces().is_empty() {
            return Err(JobError::input(SimplifyError::AllDegenerate(input.mesh.faces.len())));
        }
        let coarsest = request.levels.iter().map(|&size| input.faces_of(size)).min();
        let (tree, simplify_time) = match coarsest {
            Some(faces) if faces < whole.faces().len() => {
                begin(watch, "simplifying")?;
                let start = Instant::now();
                let target = Target::Faces(faces);
                let tree = MergeTree::record_with(&input.mesh, target, &input.options);
                (tree.map_err(JobError::input)?, start.elapsed())
            }
            _ => (whole, Duration::ZERO),
        };
        begin(watch, "stripping")?;
        let start = Instant::now();
        let strips = || stripify(tree.faces(), &options(request.quality));
        let skip = request.filter.map(|_| SkipStrip::new(tree.clone(), strips()));
        Ok(Self { input, tree, simplify_time, skip, strip_time: start.elapsed() })
    }

    fn level(&mut self, size: Target, request: &StripRequest) -> (Strips, StrippedLevelReport) {
        let faces = self.input.faces_of(size);
        let contractions = self.tree.contractions_to(faces);
        let own = self.skip.is_none().then(|| self.tree.level(contractions));
        let start = Instant::now();
        let strips = match (&mut self.skip, request.filter) {
            (Some(skip), Some(filter)) => {
                skip.set_level(contractions);
                match filter {
                    StripFilter::None => skip.display(Filter::None),
                    StripFilter::Stss => skip.display(Filter::Stss),
                    StripFilter::Dtff => skip.display(Filter::Dtff),
                    StripFilter::Repair => skip.repaired(request.effort),
                }
            }
            _ => stripify(&own.unwrap_or_default(), &options(request.quality)),
        };
        let time = start.elapsed();
        let triangles = self.tree.faces_left(contractions);
        let sent = StripStatistics::new(&strips);
        let report = StrippedLevelReport::new((size_text(size), faces), triangles, &sent, time);
        (strips, report)
    }

    fn report(
        &self,
        request: &StripRequest,
        input_faces: usize,
        levels: Vec<StrippedLevelReport>,
    ) -> StripReport {
        let [degenerate_faces, duplicate_faces, non_manifold_edges, inconsistent_edges] =
            odd_faces(&self.input.mesh, &self.tree);
        StripReport {
            input_faces,
            fused: self.input.fused,
            degenerate_faces,
            duplicate_faces,
            non_manifold_edges,
            inconsistent_edges,
            filter: request.filter,
            quality: quality_name(request.quality),
            effort: request.effort,
            simplify_seconds: self.simplify_time.as_secs_f64(),
            strip_seconds: self.skip.as_ref().map(|_| self.strip_time.as_secs_f64()),
            verified: request.verify.then(|| !levels.iter().any(StrippedLevelReport::is_wrong)),
            levels,
        }
    }
}
