//! Compressed geometry, drawn as it is stored: positions are decoded in the vertex shader.

mod blocks;
mod data;
mod lattice;
mod normals;
mod part_matrices;
mod parts;
mod pipelines;
mod plain;
mod strips;
#[cfg(test)]
mod tests;

use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use meshlod::Mesh;
use meshlod::codec::{Compressed, StoredPositions};
use meshlod::mesh::LayerKind;
use meshlod::picture::PictureError;
use wgpu::{BindGroup, Buffer, BufferUsages, IndexFormat, RenderPass};

use self::data::{SchemeData, storage_of};
pub use self::part_matrices::PartMatrices;
use self::pipelines::{PipelineKey, SchemeEntry, SchemePipelines, SchemeShader};
use self::strips::StripRun;
use crate::ViewError;
use crate::gpu::bindings::bind_buffers;
use crate::gpu::buffers::{buffer_of, uniform_of};
use crate::placement::Placement;
use crate::renderer::Renderer;

/// Compressed mesh on the GPU, its positions in the bits of their `.mlq` file.
///
/// It has one colour, or with [`Shade::face_colors`](crate::Shade::face_colors) one for each part
/// or block. Where the file has normals, they are used; otherwise faces are shaded flat.
///
/// A vertex that several parts store is at the same bits in all of them, so no background shows
/// through between parts, nor between blocks.
#[derive(Debug)]
pub struct GpuCompressed {
    origin: [f64; 3],
    shader: SchemeShader,
    bind_group: BindGroup,
    /// Bytes of parts; with normals, the positions of nodes. Otherwise shaders read stored bits
    /// only.
    vertices: Option<Buffer>,
    normals: Option<Buffer>,
    indices: Buffer,
    draws: Draws,
    faces: u32,
    vertex_bytes: u64,
    index_bytes: u64,
    /// Offset of each part from the origin in cells, and the sides of a cell.
    parts: Option<(Vec<[i32; 4]>, [f64; 3])>,
}

/// Draw calls, by ranges of the index buffer.
#[derive(Debug)]
enum Draws {
    /// Faces of each instance, as 32-bit indices.
    Lists(Vec<Range<u32>>),
    /// Strips of 16-bit indices with restarts.
    Strips(Vec<StripRun>),
}

/// Rarely needed ways of drawing compressed geometry.
#[derive(Clone, Copy, Debug, Default)]
pub struct CompressedOptions<'a> {
    /// Leave out faces that are seen from behind. A crack in a closed mesh shows background then.
    pub culls_back_faces: bool,
    /// Place parts by a matrix each, folded into the camera's [LCL10], in place of adding integers:
    /// common vertices of two parts may then be rounded apart. It is ignored without parts, and
    /// draws without normals.
    pub part_matrices: Option<&'a PartMatrices>,
}

/// `Scheme` of compressed.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct SchemeUniforms {
    scale: [f32; 3],
    padding: u32,
}

impl GpuCompressed {
    /// Uploads a compressed mesh: stored bits, headers as matrices, and decoded faces.
    ///
    /// # Errors
    /// Damaged data that the checksums did not catch, or more than the GPU can bind at once.
    pub fn new(renderer: &Renderer, compressed: &Compressed) -> Result<Self, ViewError> {
        let stored = compressed.stored()?;
        let data = match &stored.positions {
            StoredPositions::Parts(parts) => parts::data(parts, &stored)?,
            StoredPositions::Blocks(blocks) => blocks::data(blocks, stored.faces.len()),
            StoredPositions::Lattice(lattice) => lattice::data(lattice, stored.faces.len()),
        };
        let normals = compressed.node_values(LayerKind::Normal).map(|layer| normals::fold(&layer));
        // With normals, corners are nodes; without, they are positions.
        let position = |node: u32| stored.position_of[node as usize];
        let faces = match &normals {
            Some(_) => stored.faces.clone(),
            None => stored.faces.iter().map(|face| face.map(position)).collect(),
        };
        let of_nodes = normals.is_some().then(|| bytemuck::cast_slice(&stored.position_of).into());
        let strips = strips::strips(&stored);
        let data = SchemeData { fetched: data.fetched.or(of_nodes), ..data };
        Self::upload(renderer, data, strips, normals.as_deref(), &faces)
    }

    /// Uploads the positions of a mesh as three `f32`, undivided and shaded flat, to measure the
    /// cost of decoding against.
    ///
    /// # Errors
    /// A mesh that breaks [`Mesh::validate`], or is beyond the limits of the GPU.
    pub fn uncompressed(renderer: &Renderer, mesh: &Mesh) -> Result<Self, ViewError> {
        mesh.validate().map_err(PictureError::from)?;
        let faces: Vec<_> = mesh.faces.iter().map(|face| face.map(|v| v.0)).collect();
        Self::upload(renderer, plain::data(mesh), None, None, &faces)
    }

    /// Returns the point of the world that positions are relative to, for
    /// [`Placement::set`](crate::Placement::set).
    pub fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// Returns the number of faces.
    pub fn faces(&self) -> usize {
        self.faces as usize
    }

    /// Returns the size of everything on the GPU, in bytes: vertices, headers and indices.
    pub fn bytes(&self) -> u64 {
        self.vertex_bytes + self.index_bytes
    }

    /// Returns the size of vertices and of headers of parts or blocks on the GPU, in bytes.
    pub fn vertex_bytes(&self) -> u64 {
        self.vertex_bytes
    }

    /// Draws the mesh.
    pub fn draw(&self, renderer: &Renderer, pass: &mut RenderPass<'_>, placement: &Placement) {
        self.draw_with(renderer, pass, placement, &CompressedOptions::default());
    }

    /// Draws the mesh with options.
    pub fn draw_with(
        &self,
        renderer: &Renderer,
        pass: &mut RenderPass<'_>,
        placement: &Placement,
        options: &CompressedOptions<'_>,
    ) {
        if self.faces == 0 {
            return;
        }
        let matrices = options.part_matrices.filter(|_| self.shader == SchemeShader::Parts);
        let entry = match (matrices, &self.normals) {
            (Some(_), _) => SchemeEntry::ByMatrix,
            (None, Some(_)) => SchemeEntry::WithNormals,
            (None, None) => SchemeEntry::Bare,
        };
        let pipelines = renderer.pipelines::<SchemePipelines>();
        let is_strips = matches!(self.draws, Draws::Strips(_));
        let (shader, culls) = (self.shader, options.culls_back_faces);
        let key = PipelineKey { shader, entry, is_strips, culls };
        pass.set_pipeline(&pipelines.get(renderer, key));
        pass.set_bind_group(0, &placement.bind_group, &[]);
        pass.set_bind_group(1, &self.bind_group, &[]);
        if let Some(matrices) = matrices {
            pass.set_bind_group(2, matrices.bind_group(), &[]);
        }
        let fetched =
            self.vertices.iter().chain(self.normals.iter().filter(|_| matrices.is_none()));
        for (slot, buffer) in (0..).zip(fetched) {
            pass.set_vertex_buffer(slot, buffer.slice(..));
        }
        match &self.draws {
            Draws::Lists(runs) => {
                pass.set_index_buffer(self.indices.slice(..), IndexFormat::Uint32);
                for (run, faces) in (0..).zip(runs) {
                    pass.draw_indexed(3 * faces.start..3 * faces.end, 0, run..run + 1);
                }
            }
            Draws::Strips(runs) => {
                pass.set_index_buffer(self.indices.slice(..), IndexFormat::Uint16);
                for StripRun { indices, first_node, instance } in runs {
                    let instances = *instance..instance + 1;
                    pass.draw_indexed(indices.clone(), *first_node, instances);
                }
            }
        }
    }

    /// Creates matrices for [`CompressedOptions::part_matrices`]; `None` unless it has parts.
    pub fn part_matrices(&self, renderer: &Renderer) -> Option<PartMatrices> {
        let (offsets, cell) = self.parts.as_ref()?;
        Some(PartMatrices::new(renderer, self.origin, offsets, *cell))
    }

    fn upload(
        renderer: &Renderer,
        data: SchemeData<'_>,
        strips: Option<(Vec<StripRun>, Vec<u16>)>,
        normals: Option<&[[i16; 2]]>,
        faces: &[[u32; 3]],
    ) -> Result<Self, ViewError> {
        let gpu = renderer.gpu();
        let normals: &[u8] = normals.map_or(&[], bytemuck::cast_slice);
        data.check(gpu)?;
        gpu.check_buffer("the compressed mesh's normals", normals.len() as u64)?;
        let vertex = |bytes: &[u8]| buffer_of(gpu, "vertices", bytes, BufferUsages::VERTEX);
        let vertex_bytes = (data.bytes() + normals.len()) as u64;
        let (draws, indices) = match &strips {
            Some((runs, indices)) => {
                (Draws::Strips(runs.clone()), bytemuck::cast_slice::<_, u8>(indices))
            }
            None => (Draws::Lists(data.runs.clone()), bytemuck::cast_slice(faces)),
        };
        gpu.check_buffer("the compressed mesh's faces", indices.len() as u64)?;
        Ok(Self {
            origin: data.origin,
            shader: data.shader,
            bind_group: bind_positions(renderer, &data),
            vertices: data.fetched.as_deref().map(vertex),
            normals: (!normals.is_empty()).then(|| vertex(normals)),
            indices: buffer_of(gpu, "faces", indices, BufferUsages::INDEX),
            draws,
            faces: faces.len() as u32,
            vertex_bytes,
            index_bytes: indices.len() as u64,
            parts: data.offsets.map(|offsets| (offsets, data.scale)),
        })
    }
}

/// Uploads the size of a cell, the words and the headers of a scheme, and binds them.
fn bind_positions(renderer: &Renderer, data: &SchemeData<'_>) -> BindGroup {
    let gpu = renderer.gpu();
    let uniforms = SchemeUniforms { scale: data.scale.map(|x| x as f32), padding: 0 };
    let uniforms = uniform_of(gpu, "scheme", &uniforms);
    let [words, headers] =
        data.storages.each_ref().map(|bytes| storage_of(gpu, bytes, BufferUsages::empty()));
    let pipelines = renderer.pipelines::<SchemePipelines>();
    bind_buffers(gpu, &pipelines.layout, &[&uniforms, &words, &headers])
}
