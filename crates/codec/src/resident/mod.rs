//! Meshes that stay compressed in memory: positions by one of three schemes, faces in patches or
//! strips, attributes in the same rows.
//!
//! | files, in reading order | hold |
//! |---|---|
//! | `stored`, `file` | the mesh as it is kept |
//! | `positions`, `faces`, `strips`, `face_labels` | its parts |
//! | `nodes`, `wedge_vertices`, `weld_parts` | corners and their vertices |
//! | `target`, `encode`, `decode`, `error` | there and back |

mod decode;
mod encode;
mod error;
mod face_labels;
mod faces;
mod file;
mod nodes;
mod positions;
mod stored;
mod strips;
mod target;
#[cfg(test)]
mod tests;
mod wedge_vertices;
mod weld_parts;

pub use self::error::CompressError;
use self::face_labels::FaceLabels;
use self::faces::Faces;
use self::positions::Positions;
pub use self::stored::{StoredMesh, StoredPositions};
pub use self::strips::{StoredStrips, StripsError};
pub use self::target::{Compression, CompressionTarget, Scheme, compress, parts_for};
use self::wedge_vertices::WedgeVertices;
use crate::attributes::{LayerReport, PackedLayer};
use crate::bytes::reduction;

/// Compressed mesh in memory; any block of vertices and any patch of faces can be decoded alone.
///
/// It holds the faces and what they use, in an order of its own, with their materials and objects.
#[derive(Clone, Debug, PartialEq)]
pub struct Compressed {
    positions: Positions,
    faces: Faces,
    wedge_vertices: WedgeVertices,
    layers: Vec<PackedLayer>,
    /// Materials and objects.
    labels: [Option<FaceLabels>; 2],
    resources: Vec<u8>,
}

/// Size of a compressed mesh by content, in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct CompressedSizes {
    /// Size of the vertex positions in bytes, with everything needed to decode them.
    pub positions: usize,
    /// Size of the faces in bytes, including the vertex of each corner.
    pub connectivity: usize,
    /// Size of all attribute layers in bytes.
    pub attributes: usize,
    /// Size of the materials and objects of faces in bytes.
    pub labels: usize,
    /// Size of the resources in bytes.
    pub resources: usize,
    /// Size of the whole `.mlq` file in bytes: all of these and the file header.
    pub total: usize,
}

/// Limit on the attribute values of a wedge over all layers. Without it a small file of constant
/// values could claim a mesh of unlimited size.
const MAX_VALUES: usize = 1023;
/// Limit on the number of faces, chosen so that their bits take less than 4 GB in any case.
const MAX_FACES: usize = 1 << 27;
/// Blocks of vertices per patch, which gives about 256 faces. Twice as many save half a bit per
/// face.
const BLOCKS_PER_PATCH: usize = 4;

impl Compressed {
    /// Returns the sizes of positions, connectivity, attributes and the whole file, in bytes.
    pub fn sizes(&self) -> CompressedSizes {
        let positions = self.positions.bytes();
        let connectivity = self.faces.bytes() + self.wedge_vertices.bytes();
        let attributes = self.layers.iter().map(PackedLayer::bytes).sum();
        let (mut labels, mut headers) = (0, file::HEADER);
        if self.has_more() {
            labels = self.labels.iter().map(|labels| FaceLabels::bytes(labels.as_ref())).sum();
            headers += file::MORE;
        }
        let resources = self.resources.len();
        let total = headers + positions + connectivity + attributes + labels + resources;
        CompressedSizes { positions, connectivity, attributes, labels, resources, total }
    }

    /// Attaches bytes, such as materials with their images, that mean nothing to this crate. They
    /// replace earlier ones.
    pub fn with_resources(self, resources: Vec<u8>) -> Self {
        Self { resources, ..self }
    }

    /// Returns the bytes attached by [`Compressed::with_resources`].
    pub fn resources(&self) -> &[u8] {
        &self.resources
    }

    /// Returns true if there are labels or resources.
    fn has_more(&self) -> bool {
        self.labels != [None, None] || !self.resources.is_empty()
    }

    /// Returns the number of vertices of the mesh.
    pub fn vertices(&self) -> usize {
        self.positions.vertices()
    }

    /// Returns the number of faces of the mesh.
    pub fn faces(&self) -> usize {
        self.faces.face_count()
    }

    /// Returns the number of face patches, each of which [`Compressed::patch`] can decode alone.
    pub fn patches(&self) -> usize {
        self.faces.len()
    }

    /// Returns the number of vertex blocks, or the number of parts with [`Scheme::Parts`].
    pub fn blocks(&self) -> usize {
        self.positions.blocks()
    }

    /// Returns the fraction of position storage saved, compared with three `f32` for each vertex.
    pub fn reduction(&self) -> f64 {
        reduction(self.positions.bytes(), self.vertices())
    }

    /// Returns the compressed size and the largest error of each attribute layer.
    pub fn layers(&self) -> Vec<LayerReport> {
        self.layers.iter().map(PackedLayer::report).collect()
    }
}
