//! Report of `compress`, as JSON and text.

use std::path::Path;
use std::time::Duration;

use meshlod::codec::LayerReport;
use meshlod::io::Note;
use meshlod::mesh::{AttributeBounds, LayerKind};
use serde_json::{Value, json};

use crate::files;
use crate::numbers::{count, faces, percent, value};

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
pub struct StripCounts {
    pub strips: usize,
    /// Number of indices, restarts included.
    pub indices: usize,
    /// Number of parts whose indices take a byte.
    pub parts_with_byte_indices: usize,
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

    pub fn json(&self, output: &Path, time: Duration) -> Value {
        let [positions, connectivity, attributes] = self.sizes;
        let mut json = json!({
            "file": files::name(output),
            "vertices": self.vertices,
            "faces": self.faces,
            "bytes_positions": positions,
            "bytes_connectivity": connectivity,
            "bytes_attributes": attributes,
            "bytes_scene": self.scene,
            "bytes_headers": self.surface() - positions - connectivity - attributes,
            "bytes_total": self.bytes.len(),
            "bytes_per_triangle": self.surface() as f64 / self.faces as f64,
            "reduction": self.reduction(),
            "reached": self.reached,
            "layers": self.layers.iter().map(layer_json).collect::<Vec<_>>(),
            "encode_seconds": time.as_secs_f64(),
        });
        json[self.pieces.0] = self.pieces.1.into();
        if let Some(StripCounts { strips, indices, parts_with_byte_indices }) = self.strips {
            let strips = json!({ "strips": strips, "indices": indices, "parts_with_byte_indices": parts_with_byte_indices });
            json["strips"] = strips;
        }
        json
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

fn layer_json(layer: &LayerReport) -> Value {
    json!({
        "name": layer.name,
        "kind": layer.kind.to_string(),
        "bytes": layer.bytes,
        "max_error": layer.max_error,
    })
}
