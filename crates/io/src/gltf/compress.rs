//! Options and report of glTF compression, and the quantization grids of meshes.

use std::collections::BTreeSet;

use meshlod_mesh::{Bounds, Mesh};
use serde_json::Value;

use super::dequantize_skins::SkinMatrices;
use super::document::Document;
use super::lod::Level;
use super::primitives::is_surface;
use super::schema::parse_target_name;
use crate::{Scene, Unsupported};

/// Options for compressing the geometry of a glTF file: quantization [Kap20] and, optionally,
/// meshopt streams [KS21].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compression {
    /// Bits per vertex coordinate along the longest side of a mesh, 1 to 16.
    ///
    /// All axes and primitives of the mesh share one grid.
    pub position_bits: u32,
    /// Bits per component of normals and tangents, 2 to 16; up to 8 are stored in one byte.
    pub normal_bits: u32,
    /// Bits per texture coordinate in [0, 1], 1 to 16; up to 8 are stored in one byte.
    pub uv_bits: u32,
    /// Largest error of animated rotations at any time, in degrees, at least 0.01.
    ///
    /// Translations and scales may err by the arc of this angle at the largest of their track.
    pub animation_degrees: f64,
    /// If true, geometry is also compressed with meshopt; if not, a GPU can use it straight from
    /// the file.
    pub meshopt: bool,
}

impl Default for Compression {
    /// Returns settings whose result can rarely be told from the original: 14 bits for positions, 8
    /// for normals, 12 for texture coordinates and .1 degrees for animations, with meshopt.
    fn default() -> Self {
        Self {
            position_bits: 14,
            normal_bits: 8,
            uv_bits: 12,
            animation_degrees: 0.1,
            meshopt: true,
        }
    }
}

impl Compression {
    pub(super) fn check(&self) -> Result<(), Unsupported> {
        for (name, bits, least) in [
            ("position bits", self.position_bits, 1),
            ("normal bits", self.normal_bits, 2),
            ("uv bits", self.uv_bits, 1),
        ] {
            if !(least..=16).contains(&bits) {
                return Err(Unsupported::new(name, format!("must be {least} to 16, not {bits}")));
            }
        }
        let degrees = self.animation_degrees;
        if !(0.01..=90.0).contains(&degrees) {
            let reason = format!("must be 0.01 to 90 degrees, not {degrees}");
            return Err(Unsupported::new("animation error", reason));
        }
        Ok(())
    }
}

/// Size in bytes of part of the compressed geometry, in GPU memory and in the file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Bytes {
    /// Bytes in GPU memory: after quantization, decompressed.
    pub resident: usize,
    /// Bytes in the file: after quantization and, if enabled, meshopt compression.
    pub stored: usize,
}

/// Sizes and quantization error of a compressed glTF file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CompressionReport {
    /// Size of all vertex positions.
    pub positions: Bytes,
    /// Size of all vertex indices of the triangles.
    pub connectivity: Bytes,
    /// Size of all other vertex data: normals, texture coordinates, colours and so on.
    pub attributes: Bytes,
    /// Largest distance by which quantization moved a vertex, in the units of its own mesh.
    pub max_position_error: f64,
    /// Meshes whose positions were not quantized, one line each with the reason: `mesh 2: …`.
    pub kept: Vec<String>,
}

/// Uniform grid that the positions of a mesh are quantized to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct QuantizationGrid {
    /// Corner of the first cell, representable in `f32`.
    pub origin: [f64; 3],
    /// Side of a cell, representable in `f32`.
    pub cell: f64,
    /// Largest cell index per axis.
    pub most: u16,
}

impl QuantizationGrid {
    /// Builds the grid with that many bits over the points; `None` if it is not representable in
    /// `f32`.
    fn over<'a>(points: impl Iterator<Item = &'a [f64; 3]>, bits: u32) -> Option<Self> {
        let bounds = Bounds::of(points);
        let origin = bounds.min.map(|x| f64::from(rounded_down(x)));
        let longest = (0..3).map(|axis| bounds.max[axis] - origin[axis]).fold(0.0, f64::max);
        let most = ((1u32 << bits) - 1) as u16;
        // Rounded up, so that the farthest point is still inside the grid.
        let cell = -f64::from(rounded_down(-longest / f64::from(most)));
        let cell = if longest == 0.0 { 1.0 } else { cell };
        let sound = origin.iter().all(|x| x.abs() <= f64::from(f32::MAX))
            && (f64::from(f32::MIN_POSITIVE)..=f64::from(f32::MAX)).contains(&cell);
        sound.then_some(Self { origin, cell, most })
    }

    /// Returns the grid cell nearest to a point, as an index per axis.
    pub fn quantized(&self, point: [f64; 3]) -> [u16; 3] {
        let most = f64::from(self.most);
        std::array::from_fn(|axis| {
            ((point[axis] - self.origin[axis]) / self.cell).round().clamp(0.0, most) as u16
        })
    }

    /// Returns the point that a grid cell stands for, in model units.
    pub fn place(&self, cell: [u16; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| self.origin[axis] + f64::from(cell[axis]) * self.cell)
    }
}

/// Returns the largest `f32` not above `x`.
fn rounded_down(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) > x { near.next_down() } else { near }
}

/// Grids that the meshes of a scene are quantized to, and how they come back to their places.
pub(super) struct Grids {
    /// Grid of each mesh, shared with its levels; `None` if its positions stay floats.
    pub of_mesh: Vec<Option<QuantizationGrid>>,
    /// New matrices of skins.
    pub skins: SkinMatrices,
    /// Meshes that have no grid, with the reasons.
    pub kept: Vec<String>,
}

impl Grids {
    /// Makes no grids, for a file that is not compressed.
    pub fn none(scene: &Scene) -> Self {
        let of_mesh = vec![None; scene.meshes.len()];
        Self { of_mesh, skins: SkinMatrices::default(), kept: Vec::new() }
    }

    /// Chooses the grids of a scene that is written as this JSON, which was made of the document,
    /// if there is one.
    pub fn choose(
        (json, document): (&Value, Option<&Document<'_>>),
        scene: &Scene,
        levels: &[Level],
        bits: u32,
    ) -> Self {
        let mut kept = Vec::new();
        let mut of_mesh = Vec::new();
        for (index, mesh) in scene.meshes.iter().map(|mesh| &mesh.mesh).enumerate() {
            let coarser = levels.iter().filter_map(|level| level.meshes.get(index));
            let meshes: Vec<&Mesh> = std::iter::once(mesh).chain(coarser).collect();
            let grid = match why_floats(json, index) {
                _ if mesh.faces.is_empty() => Ok(None),
                Some(why) => Err(why),
                None => grid_over(&meshes, bits).map(Some),
            };
            if let Err(why) = grid {
                kept.push(format!("mesh {index}: positions stay floats, because it {why}"));
            }
            of_mesh.push(grid.unwrap_or_default());
        }
        let skins = match document {
            Some(document) => SkinMatrices::of(document, &mut of_mesh, &mut kept),
            None => SkinMatrices::default(),
        };
        Self { of_mesh, skins, kept }
    }
}

/// Largest delta of a morph target, in cells.
const MOST_CELLS: f64 = 1e9;

/// Builds the grid over the positions of a mesh and its levels, or says why there is none.
fn grid_over(meshes: &[&Mesh], bits: u32) -> Result<QuantizationGrid, &'static str> {
    let points = meshes.iter().flat_map(|mesh| &mesh.positions);
    let grid = QuantizationGrid::over(points, bits);
    let grid = grid.ok_or("is too large or too small for a node's scale")?;
    let layers = meshes.iter().filter_map(|mesh| mesh.attributes.as_ref()).flat_map(|a| &a.layers);
    let mut deltas = layers
        .filter(|layer| matches!(parse_target_name(&layer.name), Some((_, "POSITION"))))
        .flat_map(|layer| &layer.values);
    match deltas.all(|&x| (f64::from(x) / grid.cell).abs() <= MOST_CELLS) {
        true => Ok(grid),
        false => Err("has a morph target far larger than itself"),
    }
}

/// Returns why no node transform can stand in for the grid of a mesh; `None` if one can.
fn why_floats(json: &Value, mesh: usize) -> Option<&'static str> {
    let array = |value: &'_ Value, key: &str| {
        value.get(key).and_then(Value::as_array).cloned().unwrap_or_default()
    };
    let primitives = array(&json["meshes"][mesh], "primitives");
    if !primitives.iter().all(is_surface) {
        return Some("has points or lines");
    }
    // A material's thickness is in the mesh's own units, which quantization changes.
    let volumes = array(json, "materials");
    let has_volume = |i: usize| {
        volumes.get(i).is_some_and(|m| m["extensions"]["KHR_materials_volume"].is_object())
    };
    let mut named = BTreeSet::new();
    primitives.iter().for_each(|primitive| name_materials(primitive, &mut named));
    if named.into_iter().any(has_volume) {
        return Some("has a material with thickness");
    }
    for node in array(json, "nodes").iter().filter(|node| node["mesh"] == mesh) {
        let extensions = node.get("extensions").and_then(Value::as_object);
        let harmless = ["MSFT_lod", "KHR_lights_punctual", "KHR_node_visibility"];
        if extensions.into_iter().flatten().any(|(name, _)| !harmless.contains(&&name[..])) {
            return Some("is shown by a node with an extension");
        }
    }
    None
}

/// Collects the materials of a primitive, including those of its variants.
fn name_materials(value: &Value, into: &mut BTreeSet<usize>) {
    match value {
        Value::Array(values) => values.iter().for_each(|value| name_materials(value, into)),
        Value::Object(entries) => {
            for (key, value) in entries {
                match value.as_u64().filter(|_| key == "material") {
                    Some(material) => drop(into.insert(material as usize)),
                    None => name_materials(value, into),
                }
            }
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_at_most_half_a_cell_away_on_each_axis() {
        let points = [[-1.0, 2.0, 1e6], [0.3, 2.1, 1e6 + 7.0], [0.1, 2.05, 1e6 + 3.3]];
        for bits in [1, 8, 11, 16] {
            let grid = QuantizationGrid::over(points.iter(), bits).unwrap();
            assert!(f64::from(grid.cell as f32) == grid.cell);
            for point in points {
                let place = grid.place(grid.quantized(point));
                for axis in 0..3 {
                    let off = (place[axis] - point[axis]).abs();
                    assert!(off <= 0.5 * grid.cell * (1.0 + 1e-9), "{bits} bits: {off}");
                }
            }
        }
    }

    #[test]
    fn what_no_node_can_scale_has_no_grid() {
        let of = |points: &[[f64; 3]]| QuantizationGrid::over(points.iter(), 1);
        assert!(of(&[[0.0; 3], [1e-60, 0.0, 0.0]]).is_none());
        assert!(of(&[[-3e38, 0.0, 0.0], [3e38, 0.0, 0.0]]).is_none());
        assert!(of(&[[1e39, 0.0, 0.0]]).is_none());
        assert_eq!(of(&[[3.0; 3]]).map(|grid| grid.place([0; 3])), Some([3.0; 3]));
    }
}
