//! Meshes with materials on the GPU.

mod build;
mod colors;
mod pipelines;
mod strips;
mod vertex;

use std::ops::Range;
use std::sync::Arc;

use meshlod::Mesh;
use meshlod::picture::{Normals, Paint, PictureError};
use wgpu::{BindGroup, Buffer, BufferUsages, IndexFormat, RenderPass};

pub(crate) use self::build::middle;
use self::build::{CornerVertices, face_order};
pub(crate) use self::colors::{Surface, VertexColors};
pub(crate) use self::pipelines::{MaterialBinding, MeshPipelines, bind_faces};
pub use self::strips::GpuStrips;
pub(crate) use self::vertex::{VERTEX_BUFFERS, VertexAttributes, fractions};
use crate::ViewError;
use crate::gpu::buffers::upload_sliced;
use crate::placement::Placement;
use crate::renderer::Renderer;

/// Mesh on the GPU: wedges with normals, texture coordinates and colours; and its materials.
///
/// A clone shares all of that.
#[derive(Clone, Debug)]
pub struct GpuMesh {
    origin: [f64; 3],
    positions: Buffer,
    attributes: Buffer,
    indices: Buffer,
    /// Faces of each material, in the order of the index buffer.
    ranges: Vec<(Range<u32>, usize)>,
    materials: Vec<MaterialBinding>,
    /// Faces of the mesh in the order of the index buffer; `None` if that is their own.
    order: Option<Arc<[u32]>>,
    faces: u32,
    bytes: u64,
    /// Bindings for drawing face by face, if the buffers are small enough for that.
    storage: Option<BindGroup>,
}

impl GpuMesh {
    /// Uploads a mesh with the colours that [`meshlod::picture::render`] would give it.
    ///
    /// A mesh without normals gets those of `normals`; with [`Normals::Flat`] vertices are shared
    /// and faces are shaded flat. Materials are drawn one after the other.
    ///
    /// # Errors
    /// A mesh that breaks [`Mesh::validate`], a paint that does not match it, or a mesh beyond the
    /// limits of the GPU.
    pub fn new(
        renderer: &Renderer,
        mesh: &Mesh,
        paint: &Paint<'_>,
        normals: Normals,
    ) -> Result<Self, ViewError> {
        Self::with_sides(renderer, mesh, paint, normals, &[])
    }

    /// Uploads a mesh as [`GpuMesh::new`] does, with the material labels that are
    /// [single-sided](meshlod::picture::Style::single_sided).
    ///
    /// # Errors
    /// As [`GpuMesh::new`].
    pub fn with_sides(
        renderer: &Renderer,
        mesh: &Mesh,
        paint: &Paint<'_>,
        normals: Normals,
        single_sided: &[bool],
    ) -> Result<Self, ViewError> {
        mesh.validate().map_err(PictureError::from)?;
        let gpu = renderer.gpu();
        let surface = Surface::new(mesh, paint)?.with_sides(mesh, single_sided);
        let origin = middle(mesh);
        let (order, ranges) = face_order(mesh, surface.materials.len());
        let vertices = CornerVertices::new(mesh, &surface, normals, origin);
        let position_bytes = 12 * vertices.positions.len() as u64;
        let attribute_bytes = 20 * vertices.attributes.len() as u64;
        let index_bytes = 12 * order.len() as u64;
        gpu.check_buffer("the mesh's positions", position_bytes)?;
        gpu.check_buffer("the mesh's attributes", attribute_bytes)?;
        gpu.check_buffer("the mesh's faces", index_bytes)?;
        let triangles: Vec<[u32; 3]> =
            order.iter().map(|&face| vertices.triangles[face as usize]).collect();
        let fetched = BufferUsages::VERTEX | BufferUsages::STORAGE;
        let positions =
            upload_sliced(gpu, "positions", bytemuck::cast_slice(&vertices.positions), fetched);
        let attributes =
            upload_sliced(gpu, "attributes", bytemuck::cast_slice(&vertices.attributes), fetched);
        let usage = BufferUsages::INDEX | BufferUsages::STORAGE;
        let indices = upload_sliced(gpu, "faces", bytemuck::cast_slice(&triangles), usage);
        let colors: Vec<u32> = match &surface.face_colors {
            Some(colors) => order.iter().map(|&face| pack(colors[face as usize])).collect(),
            None => vec![u32::MAX],
        };
        let ranges_len = ranges.len();
        let mut this = Self {
            origin,
            positions,
            attributes,
            indices,
            ranges,
            materials: surface
                .materials
                .iter()
                .map(|m| MaterialBinding::new(renderer, m))
                .collect(),
            faces: order.len() as u32,
            order: (ranges_len > 1).then(|| order.into()),
            bytes: position_bytes + attribute_bytes + index_bytes,
            storage: None,
        };
        this.storage = this.bind_storage(renderer, &colors);
        Ok(this)
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

    /// Returns the size of vertices and faces on the GPU, in bytes.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Gives the faces colours, sRGB in the order of the mesh's faces, for a
    /// [`Shade`](crate::Shade) with colours of faces.
    ///
    /// # Errors
    /// Another number of colours than faces, or a mesh that is too large to be drawn face by face.
    pub fn set_face_colors(
        &mut self,
        renderer: &Renderer,
        colors: &[[u8; 3]],
    ) -> Result<(), ViewError> {
        self::colors::check("colours of faces", colors.len(), self.faces())?;
        let packed: Vec<u32> = match &self.order {
            Some(order) => order.iter().map(|&face| pack(colors[face as usize])).collect(),
            None => colors.iter().map(|&color| pack(color)).collect(),
        };
        let limit = renderer.gpu().device.limits().max_storage_buffer_binding_size;
        let refused = || ViewError::TooLarge {
            what: "drawing the mesh face by face",
            needed: 12 * u64::from(self.faces),
            limit,
        };
        let bound = self.bind_storage(renderer, &packed).ok_or_else(refused)?;
        self.storage = Some(bound);
        Ok(())
    }

    /// Draws the mesh.
    pub fn draw(&self, renderer: &Renderer, pass: &mut RenderPass<'_>, placement: &Placement) {
        pass.set_pipeline(&renderer.pipelines::<MeshPipelines>().fetched);
        pass.set_bind_group(0, &placement.bind_group, &[]);
        pass.set_vertex_buffer(0, self.positions.slice(..));
        pass.set_vertex_buffer(1, self.attributes.slice(..));
        pass.set_index_buffer(self.indices.slice(..), IndexFormat::Uint32);
        for (faces, material) in &self.ranges {
            pass.set_bind_group(1, &self.materials[*material].bind_group, &[]);
            pass.draw_indexed(3 * faces.start..3 * faces.end, 0, 0..1);
        }
    }

    /// Draws the mesh face by face, so that a [`Shade`](crate::Shade) with a wireframe or with
    /// colours of faces shows. A mesh that is too large for that is drawn without them.
    pub fn draw_faces(
        &self,
        renderer: &Renderer,
        pass: &mut RenderPass<'_>,
        placement: &Placement,
    ) {
        let Some(storage) = &self.storage else { return self.draw(renderer, pass, placement) };
        pass.set_pipeline(&renderer.pipelines::<MeshPipelines>().pulled);
        pass.set_bind_group(0, &placement.bind_group, &[]);
        pass.set_bind_group(2, storage, &[]);
        for (faces, material) in &self.ranges {
            pass.set_bind_group(1, &self.materials[*material].bind_group, &[]);
            pass.draw(3 * faces.start..3 * faces.end, 0..1);
        }
    }

    fn bind_storage(&self, renderer: &Renderer, colors: &[u32]) -> Option<BindGroup> {
        bind_faces(renderer, [&self.positions, &self.attributes, &self.indices], colors)
    }
}

/// Packs a colour as shaders unpack it.
fn pack([r, g, b]: [u8; 3]) -> u32 {
    u32::from_le_bytes([r, g, b, 255])
}
