//! Repair of a scene, and the errors that are left when it is read back.

use std::time::Instant;

use meshlod_check::{CheckOptions, Kinds, RepairOptions, RepairReport, RepairStep, Summary};
use meshlod_io::{ReadOptions, Scene, WriteOptions, read_bytes, write_to};

use crate::jobs::faceless::refuse_points;
use crate::jobs::{
    About, CheckRequest, JobError, Remark, Watch, WrittenAs, begin, check_scene, scene_run,
};
use crate::numbers::{count, plural};
use crate::scene::FuseReport;

/// Request to repair a scene; see [`repair`].
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct RepairRequest {
    /// Steps of the repair. Lengths are in the units of each mesh.
    pub steps: RepairOptions,
    /// True to fuse closed objects that intersect, and repair once more.
    pub fuse: bool,
    /// How the result will be written; `None` if it stays in memory. The errors that are left are
    /// those found when it is read back.
    pub written_as: Option<WrittenAs>,
}

/// Report of [`repair`]. Meshes are counted once, however many nodes show them.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct SceneRepair {
    /// True if anything was changed.
    pub changed: bool,
    /// Number of faces before.
    pub input_faces: usize,
    /// Number of vertices before.
    pub input_vertices: usize,
    /// Number of faces afterwards.
    pub output_faces: usize,
    /// Number of vertices afterwards.
    pub output_vertices: usize,
    /// Changes made by each step, and defects that are left.
    pub steps: RepairReport,
    /// Changes made by fusing, if it was asked for.
    pub fused: Option<FuseReport>,
    /// Number of errors that are left.
    pub errors_left: usize,
    /// Number of errors that are left, by kind.
    pub errors_left_by_kind: Summary,
    /// Time that the repair took, in seconds.
    pub repair_seconds: f64,
    /// How the result has to be written, as rounding could undo the repair. Not part of what serde
    /// writes.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub written_as: Option<WrittenAs>,
}

/// Repairs every mesh of a scene, including meshes that no node shows, and returns the scene with a
/// report; see [`meshlod_check::repair`] for the steps.
///
/// Nodes, materials and everything else stay, even materials that lose their last face. Where 32
/// bits would round a coordinate, the report asks for 64, unless the request says otherwise. What
/// the format of the file brings back is in the report, too: some join what was split.
///
/// # Errors
/// No face is left, or the result cannot be stored in the format.
///
/// ```
/// use meshlod::jobs::{RepairRequest, repair};
/// use meshlod::{Scene, samples};
///
/// let mut torus = samples::torus(1_000);
/// torus.faces.push(torus.faces[7]);
/// let torus = Scene::from_mesh("torus", torus);
/// let (_, report) = repair(torus, &RepairRequest::default(), &())?;
/// assert_eq!((report.output_faces, report.errors_left), (report.input_faces - 1, 0));
/// # Ok::<(), meshlod::jobs::JobError>(())
/// ```
pub fn repair(
    mut scene: Scene,
    request: &RepairRequest,
    watch: &dyn Watch,
) -> Result<(Scene, SceneRepair), JobError> {
    refuse_points(&scene)?;
    begin(watch, "repairing")?;
    let [input_vertices, input_faces] = size(&scene);
    let start = Instant::now();
    let mut steps = repair_meshes(&mut scene, &request.steps);
    let fused = scene_run::fuse(&mut scene, request.fuse, watch);
    if fused.is_some() {
        // Where cuts are close together, rounding leaves faces without area.
        steps = steps.then(&repair_meshes(&mut scene, &request.steps));
    }
    let repair_seconds = start.elapsed().as_secs_f64();
    let [output_vertices, output_faces] = size(&scene);
    if output_faces == 0 {
        return Err(JobError::input("no face with an area is left"));
    }
    remark(&steps, watch);
    let written_as = request.written_as.map(|as_| unrounded(as_, &scene));
    let left = errors_left(&scene, written_as, watch)?;
    let report = SceneRepair {
        changed: !steps.is_unchanged() || fused.is_some_and(|fused| fused.is_change),
        input_faces,
        input_vertices,
        output_faces,
        output_vertices,
        steps,
        fused,
        errors_left: left.total(),
        errors_left_by_kind: left,
        repair_seconds,
        written_as,
    };
    Ok((scene, report))
}

/// Repairs every mesh of a scene, and adds up the changes.
fn repair_meshes(scene: &mut Scene, options: &RepairOptions) -> RepairReport {
    let mut all = RepairReport::default();
    for mesh in &mut scene.meshes {
        let (repaired, report) = meshlod_check::repair(&mesh.mesh, options);
        mesh.mesh = repaired;
        report.nonzero().for_each(|(step, count)| all.add(step, count));
    }
    all
}

/// Returns the numbers of vertices and faces of all meshes.
fn size(scene: &Scene) -> [usize; 2] {
    let meshes = || scene.meshes.iter().map(|mesh| &mesh.mesh);
    [meshes().map(|mesh| mesh.positions.len()).sum(), meshes().map(|mesh| mesh.faces.len()).sum()]
}

/// Remarks on defects that are left.
fn remark(steps: &RepairReport, watch: &dyn Watch) {
    let shells = steps.count(RepairStep::NotOrientable);
    if shells > 0 {
        let text = format_args!(
            "{} one-sided shell{} left unchanged: cut open, they could be oriented",
            count(shells),
            plural(shells)
        );
        watch.remark(&Remark::new(About::Input, text));
    }
    let untried = steps.count(RepairStep::HolesUntried);
    if untried > 0 {
        let text = format_args!(
            "too many large holes for one run; run again to close the other {untried}"
        );
        watch.remark(&Remark::new(About::Input, text));
    }
}

/// Chooses 64 bits where 32 would round a coordinate, unless the bits are chosen already.
fn unrounded(as_: WrittenAs, scene: &Scene) -> WrittenAs {
    match scene.rounding(as_.format, as_.precision) > 0.0 {
        true => as_.precise(),
        false => as_,
    }
}

/// Returns the errors that a scene has when it is read back, or has in memory if it stays there.
fn errors_left(
    scene: &Scene,
    written_as: Option<WrittenAs>,
    watch: &dyn Watch,
) -> Result<Summary, JobError> {
    let scene = match written_as {
        Some(as_) => read_back(scene, as_, watch)?,
        None => scene.clone(),
    };
    let options = CheckOptions { kinds: Kinds::errors(), ..CheckOptions::default() };
    Ok(check_scene(scene, &CheckRequest { options, limit: 0 }, watch)?.summary)
}

/// Writes a scene to memory and reads it, with default options.
fn read_back(scene: &Scene, as_: WrittenAs, watch: &dyn Watch) -> Result<Scene, JobError> {
    let WrittenAs { format, precision } = as_;
    begin(watch, "reading the result back")?;
    let mut bytes = Vec::new();
    write_to(&mut bytes, scene, format, &WriteOptions { precision }).map_err(JobError::output)?;
    let options = ReadOptions::default();
    read_bytes(&bytes, format, &mut |_| None, &options).map_err(JobError::output)
}

#[cfg(test)]
mod tests {
    use meshlod_check::Kind;
    use meshlod_io::{Format, Precision};
    use meshlod_mesh::{Mesh, VertexId};

    use super::*;

    fn written_as(format: Format) -> Option<WrittenAs> {
        Some(WrittenAs { format, precision: Precision::Auto })
    }

    /// Two tetrahedra that share an edge.
    fn hinge(size: f64) -> Scene {
        let points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, -1, 0], [0, 0, -1]];
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3], [0, 4, 1], [0, 1, 5], [0, 5, 4]];
        let faces = faces.into_iter().chain([[1, 4, 5]]).map(|face| face.map(VertexId::new));
        let points = points.map(|point| point.map(|x| size * f64::from(x)));
        Scene::from_mesh("hinge", Mesh::new(points.to_vec(), faces.collect()))
    }

    #[test]
    fn errors_that_a_format_brings_back_are_left() {
        let left = |written_as| {
            let request = RepairRequest { written_as, ..RepairRequest::default() };
            repair(hinge(1.0), &request, &()).unwrap().1.errors_left_by_kind
        };
        assert_eq!(
            [left(None), left(written_as(Format::Obj))],
            [(); 2].map(|()| Summary::default())
        );
        for format in [Format::Glb, Format::Gltf, Format::Stl] {
            let left = left(written_as(format));
            assert_eq!((left.count(Kind::NonManifoldEdge), left.total()), (1, 1), "{format:?}");
        }
    }

    #[test]
    fn coordinates_that_32_bits_round_are_written_in_64() {
        for (size, precision) in [(1.0, Precision::Auto), (0.1, Precision::F64)] {
            let written_as = written_as(Format::Ply);
            let request = RepairRequest { written_as, ..RepairRequest::default() };
            let (_, report) = repair(hinge(size), &request, &()).unwrap();
            assert_eq!(report.written_as.unwrap().precision, precision, "{size}");
        }
    }

    #[test]
    fn a_scene_without_a_face_left_is_refused() {
        let mut scene = hinge(1.0);
        scene.meshes[0].mesh.faces = vec![[0; 3].map(VertexId::new)];
        let done = repair(scene, &RepairRequest::default(), &());
        assert!(matches!(done, Err(JobError::Input(_))));
    }
}
