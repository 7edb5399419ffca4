//! Compression of scenes into files to draw from or to send.

mod coinciding;
mod gltf;
mod part_strips;
mod place;
mod report;
mod request;
mod resident;
mod sent;
#[cfg(test)]
mod tests;

use std::time::Instant;

use meshlod_io::Scene;
use meshlod_mesh::AttributeBounds;

use self::place::{Placed, place};
use self::report::Packed;
pub use self::report::{CompressReport, PieceCount, StripCounts};
pub use self::request::{CompressRequest, CompressTarget, GltfPacking, Packing, PositionScheme};
use crate::jobs::faceless::refuse_points;
use crate::jobs::{JobError, Watch, begin};
use crate::model::{SceneCounts, model_limits};
use crate::scene::FuseReport;

/// Compresses a scene, and returns the bytes of the file with what is in them.
///
/// Files of our own hold all meshes, each once, with their attributes, and nodes, materials with
/// images, skins and animations beside them. No face is removed, but for degenerate and duplicate
/// ones, and every vertex moves to a grid. [`AnyFile`](crate::AnyFile) reads them back;
/// [`codec`](crate::codec) has the parts.
///
/// # Errors
/// A scene without faces or that cannot be encoded, and a target that the kind of file does not
/// support.
///
/// ```
/// use meshlod::jobs::{CompressRequest, Packing, compress};
/// use meshlod::{AnyFile, FileKind, ReadOptions, Scene, samples};
///
/// let gyroid = Scene::from_mesh("gyroid", samples::gyroid(6_000));
/// let faces = gyroid.meshes[0].mesh.faces.len();
/// let packing = Packing::of(FileKind::Sent).unwrap_or_default();
/// let request = CompressRequest { packing, ..CompressRequest::default() };
/// let (bytes, report) = compress(gyroid, &request, &())?;
/// assert!(report.bytes_total < 4 * faces, "less than 4 bytes per face");
///
/// let read = ReadOptions::default();
/// let back = AnyFile::from_bytes("gyroid.mlz", FileKind::Sent, bytes, &mut |_| None, &read)?;
/// assert_eq!(back.into_scene()?.meshes[0].mesh.faces.len(), faces);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn compress(
    mut scene: Scene,
    request: &CompressRequest,
    watch: &dyn Watch,
) -> Result<(Vec<u8>, CompressReport), JobError> {
    request.check()?;
    refuse_points(&scene)?;
    request.check_scene(&scene)?;
    let packing = request.packing.refined_for(&scene);
    let fused = match request.fuse {
        true => {
            begin(watch, "fusing")?;
            Some(FuseReport::of(&mut scene))
        }
        false => None,
    };
    begin(watch, "compressing")?;
    let start = Instant::now();
    let (packed, counts) = pack(scene, packing, request, watch)?;
    Ok(packed.finish(start.elapsed(), fused, counts))
}

fn pack(
    scene: Scene,
    packing: Packing,
    request: &CompressRequest,
    watch: &dyn Watch,
) -> Result<(Packed, Option<SceneCounts>), JobError> {
    match packing {
        Packing::Gltf(form) => Ok((gltf::pack(scene, form, request.target, watch)?, None)),
        Packing::Resident { scheme, attributes } => {
            let usual = match request.lock_contacts {
                true => PositionScheme::Lattice,
                false => PositionScheme::Blocks,
            };
            let scheme = scheme.unwrap_or(usual);
            pack_placed(scene, request, &attributes, watch, |Placed { mesh, rest, .. }| {
                resident::pack(
                    mesh,
                    std::mem::take(rest),
                    scheme,
                    request.target.of(mesh),
                    &attributes,
                )
            })
        }
        Packing::Sent { on_lattice, attributes } => {
            pack_placed(scene, request, &attributes, watch, |Placed { mesh, rest, .. }| {
                sent::pack(mesh, rest, on_lattice, request.target.of(mesh), &attributes)
            })
        }
    }
}

/// Packs a scene as one mesh with all else beside it, and notes what the file lacks.
fn pack_placed(
    scene: Scene,
    request: &CompressRequest,
    bounds: &AttributeBounds,
    watch: &dyn Watch,
    pack: impl FnOnce(&mut Placed) -> Result<Packed, JobError>,
) -> Result<(Packed, Option<SceneCounts>), JobError> {
    let mut notes = model_limits(&scene);
    let mut placed = place(scene, request, watch)?;
    let mut packed = pack(&mut placed)?;
    notes.append(&mut packed.notes);
    notes.push(packed.missed_bounds(bounds));
    Ok((Packed { notes, ..packed }, placed.counts))
}
