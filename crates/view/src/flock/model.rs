//! Levels of a model on the GPU.

use std::ops::Range;

use meshlod::flock::levels::{LevelTable, Look};
use meshlod::mesh::{Layer, LayerKind, WedgeId};
use meshlod::picture::Paint;
use wgpu::{AddressMode, Buffer, BufferUsages};

use crate::ViewError;
use crate::gpu::buffers::buffer_of;
use crate::gpu::texture;
use crate::mesh::{MaterialBinding, Surface, VertexAttributes, VertexColors, fractions};
use crate::renderer::Renderer;

/// All levels of a table in one vertex and one index buffer, with the materials of the model.
#[derive(Debug)]
pub(super) struct FlockLevels {
    pub positions: Buffer,
    pub attributes: Buffer,
    pub indices: Buffer,
    /// Draws of the levels: material after material, and level after level.
    pub draws: Vec<LevelDraw>,
    pub materials: Vec<MaterialBinding>,
    /// Number of levels.
    pub levels: usize,
    /// Coarsest level of the whole chain, for impostors where there is no atlas.
    pub coarsest: usize,
}

/// Triangles of one level and one material.
#[derive(Clone, Debug)]
pub(super) struct LevelDraw {
    pub level: usize,
    pub material: usize,
    pub indices: Range<u32>,
}

impl FlockLevels {
    pub fn new(renderer: &Renderer, table: &LevelTable, look: &Look) -> Result<Self, ViewError> {
        let gpu = renderer.gpu();
        let finest = table.mesh(0);
        let materials = look.materials_over(&table.layers);
        let paint = materials.as_deref().map_or(Paint::Colors, Paint::Materials);
        let surface = Surface::new(&finest, &paint)?;
        gpu.check_buffer("the flock's vertices", 20 * table.positions.len() as u64)?;
        gpu.check_buffer("the flock's levels", 12 * table.triangles.len() as u64)?;
        let positions = bytemuck::cast_slice(&table.positions);
        let attributes = attributes(table, &surface);
        // Without anisotropy: members are small, and llvmpipe visits every texel of a footprint,
        // which on slivers of coarse levels is most of the texture.
        let sampler = texture::sampler(gpu, AddressMode::Repeat, 1);
        let (triangles, draws) = by_material(table, surface.materials.len());
        let fetched = |label, bytes| buffer_of(gpu, label, bytes, BufferUsages::VERTEX);
        let indices = bytemuck::cast_slice(&triangles);
        Ok(Self {
            positions: fetched("flock positions", positions),
            attributes: fetched("flock attributes", bytemuck::cast_slice(&attributes)),
            indices: buffer_of(gpu, "flock levels", indices, BufferUsages::INDEX),
            draws,
            materials: surface
                .materials
                .iter()
                .map(|m| MaterialBinding::with_sampler(renderer, m, &sampler))
                .collect(),
            levels: table.levels.len(),
            coarsest: table.chains[0].levels.end - 1,
        })
    }
}

/// Returns normal, colour and texture coordinates of every vertex of a table.
fn attributes(table: &LevelTable, surface: &Surface<'_>) -> Vec<VertexAttributes> {
    let layer = |kind: LayerKind, width: usize| {
        table.layers.iter().find(|layer| layer.kind == kind && layer.width >= width)
    };
    let shows_colors = matches!(surface.vertex_colors, VertexColors::Wedges);
    let normals = layer(LayerKind::Normal, 3);
    let uvs = layer(LayerKind::Uv(0), 2);
    let colors = layer(LayerKind::Color(0), 3).filter(|_| shows_colors);
    let value = |layer: &Layer, v: usize, k: usize| layer.of(WedgeId(v as u32))[k];
    let of_vertex = |v: usize| {
        let byte = |x: f32| (x.clamp(0.0, 1.0) * 255.0).round() as u8;
        let [r, g, b] =
            colors.map_or([255; 3], |layer| [0, 1, 2].map(|k| byte(value(layer, v, k))));
        VertexAttributes {
            normal: fractions(
                normals.map_or([0.0; 3], |layer| [0, 1, 2].map(|k| value(layer, v, k))),
            ),
            color: [r, g, b, 255],
            uv: uvs.map_or([0.0; 2], |layer| [0, 1].map(|k| value(layer, v, k))),
        }
    };
    (0..table.positions.len()).map(of_vertex).collect()
}

/// Sorts the triangles of each level by material.
fn by_material(table: &LevelTable, materials: usize) -> (Vec<[u32; 3]>, Vec<LevelDraw>) {
    let mut triangles = Vec::with_capacity(table.triangles.len());
    let mut draws = Vec::with_capacity(table.levels.len());
    let labels = table.materials.as_ref().filter(|_| materials > 1);
    for (level, range) in table.levels.iter().map(|level| level.triangles.clone()).enumerate() {
        let Some(labels) = labels else {
            let indices = 3 * range.start as u32..3 * range.end as u32;
            draws.push(LevelDraw { level, material: 0, indices });
            continue;
        };
        let mut order: Vec<usize> = range.collect();
        order.sort_by_key(|&triangle| labels.of_face[triangle]);
        for part in order.chunk_by(|&a, &b| labels.of_face[a] == labels.of_face[b]) {
            let start = 3 * triangles.len() as u32;
            triangles.extend(part.iter().map(|&triangle| table.triangles[triangle]));
            let (material, end) = (labels.of_face[part[0]] as usize, 3 * triangles.len() as u32);
            draws.push(LevelDraw { level, material, indices: start..end });
        }
    }
    if labels.is_none() {
        triangles.clone_from(&table.triangles);
    }
    draws.sort_by_key(|draw| draw.material);
    (triangles, draws)
}
