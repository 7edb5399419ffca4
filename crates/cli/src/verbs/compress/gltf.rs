//! Compressed `.glb` files for other programs.

use meshlod::codec::parts_for;
use meshlod::io::Note;
use meshlod::io::gltf::{
    Compression, CompressionReport, QuantizedPart, write_compressed_glb, write_parts_glb,
};
use meshlod::{Format, Scene};

use super::{Compress, CompressedFile, SchemeArg};
use crate::session::failure::Failure;
use crate::session::scene_files::unused_parts;

impl Compress {
    pub(super) fn gltf(&self, scene: Scene) -> Result<CompressedFile, Failure> {
        match self.scheme {
            Some(SchemeArg::Parts) => self.gltf_of_parts(scene),
            _ => self.small_gltf(&scene),
        }
    }

    /// Writes the whole scene with quantized attributes.
    fn small_gltf(&self, scene: &Scene) -> Result<CompressedFile, Failure> {
        if self.target.error.is_some() || self.target.reduction.is_some() {
            return Err(Failure::usage(
                "--error and --reduction need --scheme parts in .glb; use --bits",
            ));
        }
        let (bytes, report) = write_compressed_glb(scene, &[], &self.gltf_compression()?)
            .map_err(|error| self.failed(error))?;
        let CompressionReport { positions, connectivity, attributes, .. } = report;
        let meshes = scene.meshes.iter().map(|mesh| &mesh.mesh);
        Ok(CompressedFile {
            sizes: [positions, connectivity, attributes].map(|bytes| bytes.stored),
            scene: 0,
            vertices: meshes.clone().map(|mesh| mesh.positions.len()).sum(),
            faces: meshes.map(|mesh| mesh.faces.len()).sum(),
            pieces: ("meshes", scene.meshes.len()),
            layers: Vec::new(),
            strips: None,
            reached: true,
            notes: [scene.limits_of(Format::Glb), scene.whole_mesh_limits()].concat(),
            remarks: report.kept,
            bytes,
        })
    }

    fn gltf_compression(&self) -> Result<Compression, Failure> {
        let default = Compression::default();
        let bits = self.bits();
        if !(1..=16).contains(&bits) {
            return Err(Failure::usage(format_args!(
                "--bits must be between 1 and 16 in .glb, not {bits}"
            )));
        }
        Ok(Compression {
            position_bits: bits,
            normal_bits: self.attributes.normal_error.map_or(default.normal_bits, normal_bits),
            uv_bits: self.attributes.uv_error.map_or(default.uv_bits, uv_bits),
            animation_degrees: self.animation_error.unwrap_or(default.animation_degrees),
            meshopt: !self.resident,
        })
    }

    /// Writes the surface in parts, each a node with its own matrix.
    fn gltf_of_parts(&self, scene: Scene) -> Result<CompressedFile, Failure> {
        // Parts have what STL has: a surface.
        let limits = scene.limits_of(Format::Stl);
        let mesh = scene.into_mesh();
        let done = parts_for(&mesh, self.reconstruction(), self.target(&mesh));
        let (parts, reached) = done.map_err(|error| self.refused(error))?;
        let quantized: Vec<_> = parts
            .parts()
            .iter()
            .map(|part| QuantizedPart {
                matrix: parts.matrix(part),
                positions: part.positions.clone(),
                faces: part.faces.clone(),
            })
            .collect();
        let bytes = write_parts_glb(&quantized).map_err(|error| self.failed(error))?;
        let faces = parts.parts().iter().map(|part| part.faces.len()).sum();
        let mut notes = limits;
        Note::merge(&mut notes, unused_parts(&mesh, faces));
        // Positions are padded to four bytes, and each part has a matrix.
        let positions: usize =
            quantized.iter().map(|part| 4 * part.positions.len() + size_of_val(&part.matrix)).sum();
        let index = |part: &QuantizedPart| if part.positions.len() < 65_536 { 2 } else { 4 };
        let indices: usize = quantized.iter().map(|part| 3 * part.faces.len() * index(part)).sum();
        Ok(CompressedFile {
            sizes: [positions, indices.min(bytes.len().saturating_sub(positions)), 0],
            scene: 0,
            vertices: parts.vertices(),
            faces,
            pieces: ("parts", quantized.len()),
            layers: Vec::new(),
            strips: None,
            reached,
            notes,
            remarks: Vec::new(),
            bytes,
        })
    }
}

/// Returns the smallest number of bits per component that keeps normals within an angle: half a
/// step along each of three axes.
fn normal_bits(degrees: f64) -> u32 {
    let turns = |bits: u32| 3f64.sqrt() / 2.0 / f64::from((1u32 << (bits - 1)) - 1);
    (2..16).find(|&bits| turns(bits) <= degrees.to_radians()).unwrap_or(16)
}

/// Returns the smallest number of bits that keeps texture coordinates within an error.
fn uv_bits(error: f64) -> u32 {
    (1..16).find(|&bits| 0.5 / f64::from((1u32 << bits) - 1) <= error).unwrap_or(16)
}
