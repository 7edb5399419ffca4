//! Options and report of glTF compression.

use crate::error::Unsupported;

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
    /// Translations and scales may err by the arc of this angle at the largest value of their
    /// track.
    pub animation_degrees: f64,
    /// If true, geometry is also compressed with meshopt; if not, a GPU can use it straight from
    /// the file.
    pub meshopt: bool,
    /// Grid of all positions, of 16 bits, in place of one over each mesh; `None` by default.
    ///
    /// Meshes on grids whose cells meet have equal positions where they had them before. What is
    /// outside is moved to the grid.
    pub grid: Option<PositionGrid>,
}

/// Grid for vertex positions, the same for several files.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositionGrid {
    /// Place of the first point, representable in `f32`.
    pub origin: [f64; 3],
    /// Distance between points on each axis, representable in `f32`.
    pub cell: f64,
}

impl Default for Compression {
    /// Returns settings with hardly visible loss: 14 bits for positions, 8 for normals, 12 for
    /// texture coordinates and 0.1 degrees for animations, with meshopt.
    fn default() -> Self {
        Self {
            position_bits: 14,
            normal_bits: 8,
            uv_bits: 12,
            animation_degrees: 0.1,
            meshopt: true,
            grid: None,
        }
    }
}

impl Compression {
    pub(crate) fn check(&self) -> Result<(), Unsupported> {
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
