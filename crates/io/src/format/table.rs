//! The table of file formats: one row each.

use std::io::{self, Write};

use meshlod_mesh::Mesh;

use super::facts::{
    Comments, Coordinates, FormatFacts, HeldLayers, Holds, SeamSplits, Stores, VertexSharing,
};
use crate::precision::Precision;
use crate::scene::Scene;
use serde::{Deserialize, Serialize};

use crate::{gltf, obj, off, ply, smf, stl};

/// File format of a mesh or scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// Polygon File Format (PLY, the Stanford format), text or binary.
    Ply,
    /// Wavefront OBJ with its material library (MTL).
    Obj,
    /// STL, the format of stereolithography: triangles without shared vertices, text or binary.
    Stl,
    /// Object File Format (OFF), including its COFF and NOFF variants.
    Off,
    /// Simple Model Format (SMF), the text format of Garland's QSlim.
    Smf,
    /// glTF 2.0 as a JSON file, with buffers embedded or in separate files.
    Gltf,
    /// glTF 2.0 as a single binary file, `.glb` or `.vrm`.
    Glb,
}

/// Suffix of files that are read and not written.
pub(crate) const READ_ALONE: &str = "b3dm";

/// Facts about the formats, in the order of [`Format`].
pub(crate) const TABLE: &[FormatFacts] = &[
    FormatFacts {
        format: Format::Ply,
        suffixes: &["ply"],
        read: |bytes, resolve, _| ply::read_scene(bytes, resolve),
        write: ply::write_scene,
        stores: Stores {
            holds: Holds::Properties,
            coordinates: Coordinates::Binary,
            layers: HeldLayers::All,
            seams: SeamSplits::None,
            comments: Comments::Own,
            ..TEXT_MESH
        },
    },
    FormatFacts {
        format: Format::Obj,
        suffixes: &["obj"],
        read: |bytes, resolve, _| obj::read(bytes, resolve),
        write: |scene, precision, out| obj::write(scene, precision, out, &[]),
        stores: Stores {
            holds: Holds::Library,
            layers: HeldLayers::BasicByMaterial,
            seams: SeamSplits::Colors,
            has_opacity: false,
            ..TEXT_MESH
        },
    },
    FormatFacts {
        format: Format::Stl,
        suffixes: &["stl"],
        read: |bytes, _, _| stl::read_scene(bytes),
        write: stl::write_scene,
        stores: Stores {
            vertices: VertexSharing::PerCorner,
            coordinates: Coordinates::Binary32,
            layers: HeldLayers::None,
            seams: SeamSplits::None,
            comments: Comments::None,
            has_solids: true,
            ..TEXT_MESH
        },
    },
    FormatFacts {
        format: Format::Off,
        suffixes: &["off"],
        read: |bytes, _, _| off::read_scene(bytes),
        write: |scene, precision, out| write_flat(scene, off::write_commented, precision, out),
        stores: TEXT_MESH,
    },
    FormatFacts {
        format: Format::Smf,
        suffixes: &["smf"],
        read: |bytes, _, _| smf::read_scene(bytes),
        write: |scene, precision, out| write_flat(scene, smf::write_commented, precision, out),
        stores: Stores { has_opacity: false, ..TEXT_MESH },
    },
    FormatFacts {
        format: Format::Gltf,
        suffixes: &["gltf"],
        read: gltf::read,
        write: write_glb,
        stores: DOCUMENT,
    },
    FormatFacts {
        format: Format::Glb,
        // VRM files, avatars of people, are GLB files with extensions of their own; b3dm, tiles of 3D
        // Tiles 1.0, are read alone.
        suffixes: &["glb", "vrm", READ_ALONE],
        read: gltf::read,
        write: write_glb,
        stores: DOCUMENT,
    },
];

/// Text with the vertices of one mesh, each with one set of attributes.
const TEXT_MESH: Stores = Stores {
    holds: Holds::MeshAlone,
    vertices: VertexSharing::Indexed,
    coordinates: Coordinates::Decimal,
    layers: HeldLayers::Basic,
    seams: SeamSplits::All,
    has_opacity: true,
    comments: Comments::Lines,
    has_solids: false,
};

/// A glTF document.
const DOCUMENT: Stores = Stores {
    holds: Holds::Document,
    vertices: VertexSharing::PerPrimitive,
    coordinates: Coordinates::Binary32,
    layers: HeldLayers::All,
    seams: SeamSplits::None,
    comments: Comments::Own,
    ..TEXT_MESH
};

/// Writes a scene as one mesh with `write`, and with the comments of the scene.
fn write_flat(
    scene: &Scene,
    write: fn(&Mesh, &[String], Precision, &mut dyn Write) -> io::Result<()>,
    precision: Precision,
    out: &mut dyn Write,
) -> io::Result<()> {
    write(&scene.shown_mesh(), &scene.ply.remarks, precision, out)
}

fn write_glb(scene: &Scene, _: Precision, out: &mut dyn Write) -> io::Result<()> {
    let bytes = gltf::write_glb(scene, &[]);
    out.write_all(&bytes.map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))?)
}
