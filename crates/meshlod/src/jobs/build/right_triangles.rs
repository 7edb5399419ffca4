//! Levels of a height field by right triangles.

use meshlod_io::{Format, Scene};
use meshlod_multires::{ErrorKind, HeightField, HeightPrecision};
use meshlod_simplify::Options;

use super::{BuildReport, BuildRequest, BuiltLevels, ErrorPoses, LevelModel};
use crate::jobs::JobError;
use crate::jobs::unused::{unused_parts, used_vertices};

/// Builds the levels of a height field, of whose scene only the surface is kept.
pub(super) fn build(
    scene: Scene,
    request: &BuildRequest,
) -> Result<(Vec<u8>, BuildReport), JobError> {
    // Right triangles have what STL has: a surface.
    let mut notes = scene.limits_of(Format::Stl);
    let flat = request.constraints.flatten(scene, Options::default());
    let (mesh, _) = flat.map_err(JobError::input)?;
    let field = HeightField::from_mesh(&mesh).map_err(JobError::input)?;
    let precision = match request.rounding_of(&mesh) {
        0.0 => HeightPrecision::Exact,
        rounding => HeightPrecision::Within(rounding),
    };
    let (bytes, fit) = field.to_file(precision).map_err(JobError::input)?;
    let (input_vertices, input_faces) = (used_vertices(&mesh), mesh.faces.len());
    notes.extend(unused_parts(&mesh, input_faces));
    let report = BuildReport {
        input_vertices,
        input_faces,
        bytes: bytes.len(),
        scene_bytes: 0,
        bytes_per_vertex: bytes.len() as f64 / input_vertices as f64,
        rounding: fit.rounded,
        levels: BuiltLevels::RightTriangles {
            model: LevelModel::RightTriangles,
            error_kind: ErrorKind::Bound,
            grid: field.size(),
            fit,
        },
        scene: None,
        faces: input_faces,
        moved: fit.rounded,
        diagonal: mesh.bounds().diagonal(),
        error_poses: ErrorPoses::Unknown,
        notes,
    };
    Ok((bytes, report))
}
