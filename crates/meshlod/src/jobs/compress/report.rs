//! The report of a compression.

use std::time::Duration;

use meshlod_codec::LayerReport;
use meshlod_io::Note;
use meshlod_mesh::{AttributeBounds, LayerKind};

use crate::model::SceneCounts;
use crate::numbers::value;
use crate::scene::FuseReport;

/// Report of [`compress`](super::compress). Sizes are in bytes.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct CompressReport {
    /// Number of vertices in the file.
    pub vertices: usize,
    /// Number of vertices that rounding has put at the place of another one; `None` for glTF.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub vertices_coinciding: Option<usize>,
    /// Number of faces in the file; degenerate faces of the scene are left out.
    pub faces: usize,
    /// Size of the positions.
    pub bytes_positions: usize,
    /// Size of the faces.
    pub bytes_connectivity: usize,
    /// Size of the attributes, and of the materials and objects of faces.
    pub bytes_attributes: usize,
    /// Size of nodes, materials, images and all else that is not compressed with the surface.
    pub bytes_scene: usize,
    /// Size of everything else.
    pub bytes_headers: usize,
    /// Size of the file.
    pub bytes_total: usize,
    /// Size of the file without that of the scene, for each face.
    pub bytes_per_triangle: f64,
    /// Fraction saved of three `f32` for the position of each vertex.
    pub reduction: f64,
    /// True if the target was met. A mesh can be too small for a reduction.
    pub reached: bool,
    /// Size and error of each attribute layer.
    pub layers: Vec<LayerReport>,
    /// Time that encoding took, in seconds.
    pub encode_seconds: f64,
    /// Number of pieces that the surface is in.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub pieces: PieceCount,
    /// Triangle strips that the faces are stored as.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub strips: Option<StripCounts>,
    /// Changes made by fusing, if it was asked for.
    pub fused: Option<FuseReport>,
    /// Numbers of what the scene has, in a file of our own; `None` if it is only a mesh.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub scene: Option<SceneCounts>,
    /// Notes on what the file lacks of the scene. Not part of what serde writes.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub notes: Vec<Note>,
}

/// Number of pieces that a compressed surface is in, under their name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum PieceCount {
    /// Blocks that are decoded by themselves.
    Blocks(usize),
    /// Parts with a grid of their own.
    Parts(usize),
    /// Meshes of a scene.
    Meshes(usize),
}

/// Numbers of the triangle strips in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct StripCounts {
    /// Number of strips.
    pub strips: usize,
    /// Number of indices, restarts included.
    pub indices: usize,
    /// Number of parts whose indices take a byte.
    pub parts_with_byte_indices: usize,
}

/// A compressed file, and what its encoder knows of it.
pub(super) struct Packed {
    pub bytes: Vec<u8>,
    /// Bytes of positions, connectivity and attributes.
    pub sizes: [usize; 3],
    /// Bytes of the rest of the scene.
    pub scene: usize,
    pub vertices: usize,
    /// Vertices at the place of another one, if they are counted.
    pub coinciding: Option<usize>,
    pub faces: usize,
    pub pieces: PieceCount,
    pub layers: Vec<LayerReport>,
    pub strips: Option<StripCounts>,
    pub reached: bool,
    pub notes: Vec<Note>,
}

impl Packed {
    pub(super) fn finish(
        self,
        time: Duration,
        fused: Option<FuseReport>,
        scene: Option<SceneCounts>,
    ) -> (Vec<u8>, CompressReport) {
        let [bytes_positions, bytes_connectivity, bytes_attributes] = self.sizes;
        let surface = self.bytes.len() - self.scene;
        let report = CompressReport {
            vertices: self.vertices,
            vertices_coinciding: self.coinciding,
            faces: self.faces,
            bytes_positions,
            bytes_connectivity,
            bytes_attributes,
            bytes_scene: self.scene,
            bytes_headers: surface - bytes_positions - bytes_connectivity - bytes_attributes,
            bytes_total: self.bytes.len(),
            bytes_per_triangle: surface as f64 / self.faces as f64,
            reduction: 1.0 - bytes_positions as f64 / (12 * self.vertices) as f64,
            reached: self.reached,
            layers: self.layers,
            encode_seconds: time.as_secs_f64(),
            pieces: self.pieces,
            strips: self.strips,
            fused,
            scene,
            notes: self.notes,
        };
        (self.bytes, report)
    }

    /// Notes the layers whose values are farther off than they may be, because integers cannot count
    /// the steps up to the greatest one.
    pub(super) fn missed_bounds(&self, bounds: &AttributeBounds) -> Note {
        let missed = self.layers.iter().filter_map(|layer| {
            let bound = match layer.kind {
                LayerKind::Uv(_) => bounds.uv,
                LayerKind::Color(_) => bounds.color,
                LayerKind::Weights(_) => bounds.weight,
                _ => return None,
            };
            let off = || format!("{} is off by up to {}", layer.name, value(layer.max_error));
            (layer.max_error > bound).then(off)
        });
        let missed: Vec<String> = missed.collect();
        let (one, many) = ("error bound of an attribute", "error bounds of attributes");
        Note::left_out(missed.len(), one, many).named(missed).remedied(
            "correct values that are far from all others, or use build --lossless, which keeps all",
        )
    }
}
