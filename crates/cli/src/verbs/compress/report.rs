//! Report of `compress`, as JSON and text.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

use meshlod::SceneCounts;
use meshlod::codec::LayerReport;
use meshlod::io::Note;
use meshlod::mesh::{AttributeBounds, LayerKind};
use serde::Serialize;

use crate::options::fuse::FuseReport;
use crate::session::files;
use crate::text::numbers::{count, faces, percent, value};

/// Compressed file with the figures to report.
pub struct CompressedFile {
    pub bytes: Vec<u8>,
    /// Bytes of positions, connectivity and attributes.
    pub sizes: [usize; 3],
    /// Bytes of nodes, materials, images and all else that is not compressed with the surface.
    pub scene: usize,
    pub vertices: usize,
    pub faces: usize,
    /// Kind and number of pieces: blocks, parts or meshes.
    pub pieces: (&'static str, usize),
    pub layers: Vec<LayerReport>,
    /// Triangle strips that faces are stored as.
    pub strips: Option<StripCounts>,
    pub reached: bool,
    /// Notes on what the file lacks of the scene.
    pub notes: Vec<Note>,
    /// Messages on data of the input that is not compressed.
    pub remarks: Vec<String>,
}

/// Numbers of the triangle strips in a file.
#[derive(Clone, Copy, Serialize)]
pub struct StripCounts {
    pub strips: usize,
    /// Number of indices, restarts included.
    pub indices: usize,
    /// Number of parts whose indices take a byte.
    pub parts_with_byte_indices: usize,
}

/// Figures of a compressed file for programs.
#[derive(Serialize)]
pub struct CompressFigures<'f> {
    file: String,
    vertices: usize,
    faces: usize,
    bytes_positions: usize,
    bytes_connectivity: usize,
    bytes_attributes: usize,
    bytes_scene: usize,
    bytes_headers: usize,
    bytes_total: usize,
    bytes_per_triangle: f64,
    reduction: f64,
    reached: bool,
    layers: &'f [LayerReport],
    encode_seconds: f64,
    /// Number of blocks, parts or meshes, under their name.
    #[serde(flatten)]
    pieces: BTreeMap<&'static str, usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    strips: Option<StripCounts>,
    fused: Option<FuseReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    scene: Option<SceneCounts>,
}

impl CompressedFile {
    /// Notes the layers whose values are farther off than they may be, because integers cannot count
    /// the steps up to the greatest one.
    pub fn missed_bounds(&self, bounds: &AttributeBounds) -> Note {
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

    pub fn figures(
        &self,
        output: &Path,
        time: Duration,
        fused: Option<FuseReport>,
        scene: Option<SceneCounts>,
    ) -> CompressFigures<'_> {
        let [bytes_positions, bytes_connectivity, bytes_attributes] = self.sizes;
        let surface = self.surface();
        CompressFigures {
            file: files::name(output),
            vertices: self.vertices,
            faces: self.faces,
            bytes_positions,
            bytes_connectivity,
            bytes_attributes,
            bytes_scene: self.scene,
            bytes_headers: surface - bytes_positions - bytes_connectivity - bytes_attributes,
            bytes_total: self.bytes.len(),
            bytes_per_triangle: surface as f64 / self.faces as f64,
            reduction: self.reduction(),
            reached: self.reached,
            layers: &self.layers,
            encode_seconds: time.as_secs_f64(),
            pieces: [self.pieces].into(),
            strips: self.strips,
            fused,
            scene,
        }
    }

    pub fn text(&self, output: &Path, time: Duration) -> String {
        let (what, pieces) = self.pieces;
        let what = match (what, pieces) {
            ("meshes", 1) => "mesh",
            (many, 1) => many.trim_end_matches('s'),
            (many, _) => many,
        };
        let [positions, connectivity, attributes] = self.sizes.map(count);
        let mut text = format!(
            "{}: {} in {} bytes, {:.2} per triangle; {} {what}\n\
             bytes: positions {positions} ({} than f32), faces {connectivity}, attributes {attributes}\n",
            files::name(output),
            faces(self.faces),
            count(self.bytes.len()),
            self.surface() as f64 / self.faces as f64,
            count(pieces),
            match 100.0 * self.reduction() {
                saved if saved < 0.0 => format!("{} more", percent(-saved)),
                saved => format!("{} less", percent(saved)),
            },
        );
        if let Some(StripCounts { strips, indices, parts_with_byte_indices }) = self.strips {
            text += &format!(
                "strips: {}, {:.3} indices per triangle with restarts, one byte each in {} of {} parts\n",
                count(strips),
                indices as f64 / self.faces as f64,
                count(parts_with_byte_indices),
                count(self.pieces.1),
            );
        }
        for layer in &self.layers {
            let (bytes, error) = (count(layer.bytes), value(layer.max_error));
            text += &format!("{}: {bytes} bytes, largest error {error}\n", layer.name);
        }
        if self.scene > 0 {
            text += &format!("nodes, materials and images: {} bytes\n", count(self.scene));
        }
        text + &format!("encode_seconds: {}\n", value(time.as_secs_f64()))
    }

    /// Returns the bytes of the surface: of meshes with attributes and labels.
    pub fn surface(&self) -> usize {
        self.bytes.len() - self.scene
    }

    pub fn reduction(&self) -> f64 {
        1.0 - self.sizes[0] as f64 / (12 * self.vertices) as f64
    }
}
