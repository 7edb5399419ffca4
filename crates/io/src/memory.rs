//! Reading and writing mesh files in memory.

use std::io::{self, Write};

use meshlod_mesh::{Mesh, VertexId, weld};

use crate::error::ParseError;
use crate::files::missing_images::note_missing_images;
use crate::format::Format;
use crate::format::facts::{Comments, VertexSharing};
use crate::options::{ReadOptions, Resolve, Weld, WriteOptions};
use crate::remarks;
use crate::scene::{Scene, influences, normals};

/// Parses the contents of a mesh file held in memory; `resolve` loads the files it refers to.
///
/// # Errors
/// The location and the reason if the contents are invalid.
pub fn read_bytes(
    bytes: &[u8],
    format: Format,
    resolve: Resolve<'_>,
    options: &ReadOptions,
) -> Result<Scene, ParseError> {
    let mut scene = parse(bytes, format, resolve, options)?;
    note_missing_images(&mut scene, None);
    Ok(scene)
}

/// Parses a mesh file as [`read_bytes`] does, without a note on missing images.
pub(crate) fn parse(
    bytes: &[u8],
    format: Format,
    resolve: Resolve<'_>,
    options: &ReadOptions,
) -> Result<Scene, ParseError> {
    let mut scene = (format.facts().read)(bytes, resolve, options.weld)?;
    if format.stores().comments == Comments::Lines {
        scene.ply.remarks = remarks::of_text(bytes);
    }
    weld_meshes(&mut scene, format, options.weld);
    normals::make_unit(&mut scene);
    influences::note_sums(&mut scene);
    Ok(scene)
}

/// Welds or separates the vertices of each mesh.
fn weld_meshes(scene: &mut Scene, format: Format, how: Weld) {
    let vertices = format.stores().vertices;
    // glTF was welded as it was read: its document depends on it.
    let meshes =
        if vertices == VertexSharing::PerPrimitive { &mut [][..] } else { &mut scene.meshes };
    for mesh in meshes {
        match how {
            Weld::Within(epsilon) => drop(weld(&mut mesh.mesh, epsilon)),
            Weld::Off if vertices == VertexSharing::PerCorner => unweld(&mut mesh.mesh),
            Weld::Exact | Weld::Off => {}
        }
    }
}

/// Gives every corner its own vertex, as in STL files.
fn unweld(mesh: &mut Mesh) {
    mesh.positions = mesh.faces.iter().flatten().map(|v| mesh.positions[v.index()]).collect();
    for (i, vertex) in mesh.faces.iter_mut().flatten().enumerate() {
        *vertex = VertexId::new(i);
    }
}

/// Writes a scene as a mesh file to any destination, without the files beside it.
///
/// glTF is written as GLB, in one piece, whether the format is `.gltf` or `.glb`. OBJ names no
/// material library, and PLY names images that are not written.
///
/// # Errors
/// Errors of `out`, and [`io::ErrorKind::InvalidData`] for parts of the scene that the format
/// cannot store.
pub fn write_to(
    out: &mut dyn Write,
    scene: &Scene,
    format: Format,
    options: &WriteOptions,
) -> io::Result<()> {
    (format.facts().write)(scene, options.precision, out)
}
