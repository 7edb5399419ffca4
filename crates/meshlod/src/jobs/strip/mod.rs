//! Triangle strips of the levels of a scene, and strips that follow a cut.

mod each_mesh;
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
use meshlod_strip::{Filter, MergeTree, SkipStrip, StripStatistics, StripWedge, Strips, stripify};

use self::each_mesh::EachMesh;
pub use self::follow::{FollowReport, FollowRequest, FollowedCut, follow_strips};
use self::meshes::scene_strips;
use self::report::Odd;
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
    /// The scene merged into one mesh, or each of its meshes once.
    pub mesh: Mesh,
    /// Contractions of that mesh down to the coarsest level.
    pub tree: MergeTree,
    /// Strips of each level, in the order of the request; their vertices are those of the tree.
    pub levels: Vec<Strips>,
    /// The scene with each mesh once, if these were stripped.
    each_mesh: Option<Scene>,
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
        let stripped = self.each_mesh.as_ref().unwrap_or(&self.scene);
        scene_strips(stripped, &self.mesh, &self.tree, &strips)
    }
}

/// Makes triangle strips of a scene, merged into one mesh, and of levels of it.
///
/// Levels come from half-edge contractions, so that all have vertices of the mesh. Strips never run
/// across instances or materials. Of a scene that shows its meshes many times, in similar shapes, each
/// mesh is stripped once, unless instances are to be fused or locked where they meet; counts are of
/// all instances. [`strip`](crate::strip) has the parts.
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
    let each_mesh = EachMesh::of(&scene, request);
    if each_mesh.is_none() {
        remark_copies(&scene, watch);
    }
    if matches!(request.constraints.locks, VertexLocking::Contacts(_)) {
        watch.stage("looking for contacts");
    }
    let placed = each_mesh.as_ref().map_or(&scene, |own| &own.scene).clone();
    let flat = request.constraints.flatten(placed, Options::default());
    let (mesh, options) = flat.map_err(JobError::input)?;
    let faces = if each_mesh.is_some() { shown_faces(&scene) } else { mesh.faces.len() };
    let input_faces = fused.as_ref().map_or(faces, |fused| fused.input_faces);
    check_sizes(&request.levels, input_faces)?;
    let input = FlatScene { mesh, options, fused, faces };
    let mut source = StripSource::new(input, each_mesh, request, watch)?;
    let (levels, reports) = source.levels(request, watch)?;
    let report = source.report(request, input_faces, reports);
    let StripSource { input: FlatScene { mesh, .. }, tree, each_mesh, .. } = source;
    let each_mesh = each_mesh.map(|own| own.scene);
    Ok((Stripped { scene, mesh, tree, levels, each_mesh }, report))
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
    /// Number of faces that are shown.
    faces: usize,
}

impl FlatScene {
    /// Returns the largest number of faces of a level; ratios are of the faces before fusing.
    fn faces_of(&self, size: Target) -> usize {
        let size = self.fused.map_or(size, |fused| fused.target(size));
        size.faces_of(self.faces)
    }
}

/// Mesh and contractions that all levels come from.
struct StripSource {
    input: FlatScene,
    /// The meshes, if each is stripped once.
    each_mesh: Option<EachMesh>,
    tree: MergeTree,
    /// Vertices of the mesh that those of the tree are, if each mesh is stripped once.
    wedges: Vec<StripWedge>,
    simplify_time: Duration,
    /// Strips of the whole mesh that filters shorten.
    skip: Option<SkipStrip>,
    strip_time: Duration,
}

impl StripSource {
    /// Records the contractions down to the coarsest level, and strips the whole mesh for a filter.
    fn new(
        input: FlatScene,
        each_mesh: Option<EachMesh>,
        request: &StripRequest,
        watch: &dyn Watch,
    ) -> Result<Self, JobError> {
        let whole = MergeTree::new(&input.mesh);
        if whole.faces().is_empty() {
            return Err(JobError::input(SimplifyError::AllDegenerate(input.mesh.faces.len())));
        }
        // Levels of so few faces each show no more than was asked for.
        let times = each_mesh.as_ref().map_or(1, EachMesh::most_times);
        let coarsest = request.levels.iter().map(|&size| input.faces_of(size)).min();
        let coarsest = coarsest.map(|faces| (faces / times).max(1));
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
        let strip_time = start.elapsed();
        let wedges = each_mesh.as_ref().map(|_| tree.wedges(&input.mesh).into_owned());
        let wedges = wedges.unwrap_or_default();
        Ok(Self { input, each_mesh, tree, wedges, simplify_time, skip, strip_time })
    }

    /// Strips all levels, compares them if that is asked for, and reports on what they show.
    fn levels(
        &mut self,
        request: &StripRequest,
        watch: &dyn Watch,
    ) -> Result<(Vec<Strips>, Vec<StrippedLevelReport>), JobError> {
        let (mut levels, mut reports) = (Vec::new(), Vec::new());
        for &size in &request.levels {
            begin(watch, &format!("stripping {}", size_text(size)))?;
            let (strips, report) = self.level(size, request);
            levels.push(strips);
            reports.push(report);
        }
        if request.verify {
            begin(watch, "verifying")?;
            verify::compare(&self.input, &self.tree, &levels, &mut reports)
                .map_err(JobError::input)?;
        }
        if let Some(own) = &self.each_mesh {
            for ((&size, strips), report) in request.levels.iter().zip(&levels).zip(&mut reports) {
                let faces = self.input.faces_of(size);
                let level = self.tree.level(self.contractions_to(faces));
                let sent = own.statistics(&self.wedges, strips);
                report.show(faces, own.shown(&self.wedges, &level), &sent);
            }
        }
        Ok((levels, reports))
    }

    /// Returns the number of contractions until at most so many faces are shown.
    fn contractions_to(&self, faces: usize) -> usize {
        let Some(own) = &self.each_mesh else { return self.tree.contractions_to(faces) };
        let shown = |at: usize| own.shown(&self.wedges, &self.tree.level(at));
        let (mut low, mut high) = (0, self.tree.contractions());
        while low < high {
            let middle = (low + high) / 2;
            match shown(middle) <= faces {
                true => high = middle,
                false => low = middle + 1,
            }
        }
        low
    }

    fn level(&mut self, size: Target, request: &StripRequest) -> (Strips, StrippedLevelReport) {
        let faces = self.input.faces_of(size);
        let contractions = self.contractions_to(faces);
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
        let odd = match &self.each_mesh {
            Some(own) => own.odd_faces(&self.wedges, &self.tree),
            None => Odd::of_mesh(&self.input.mesh, &self.tree),
        };
        StripReport {
            input_faces,
            each_mesh_once: self.each_mesh.is_some(),
            fused: self.input.fused,
            degenerate_faces: odd.degenerate,
            duplicate_faces: odd.duplicate,
            non_manifold_edges: odd.non_manifold_edges,
            inconsistent_edges: odd.inconsistent_edges,
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
