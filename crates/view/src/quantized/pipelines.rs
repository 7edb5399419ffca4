//! Pipelines of the schemes, compiled on first use.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use wgpu::{
    BindGroupLayout, IndexFormat, PrimitiveTopology, RenderPipeline, ShaderStages,
    VertexBufferLayout, VertexFormat, VertexStepMode, vertex_attr_array,
};

use crate::gpu::bindings::{STORAGE, UNIFORM, layout_for};
use crate::renderer::{PipelineBuild, Pipelines, Renderer};

/// Shader of a scheme. The short paths decode common data, the wide ones all data.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum SchemeShader {
    Plain,
    Parts,
    Blocks {
        is_wide: bool,
    },
    Lattice {
        /// Numbers of more than 64 bits.
        has_three_words: bool,
    },
    WideLattice,
}

/// Entry point for vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum SchemeEntry {
    Bare,
    WithNormals,
    ByMatrix,
}

/// Settings of a pipeline of a scheme.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct PipelineKey {
    pub shader: SchemeShader,
    pub entry: SchemeEntry,
    /// Strips of 16-bit indices in place of separate triangles.
    pub is_strips: bool,
    /// Faces seen from behind are left out.
    pub culls: bool,
}

/// Pipelines of compressed geometry, and the layouts of their bindings.
#[derive(Debug)]
pub(super) struct SchemePipelines {
    /// Uniforms, words, headers.
    pub layout: BindGroupLayout,
    pub matrix_layout: BindGroupLayout,
    compiled: Mutex<BTreeMap<PipelineKey, Arc<RenderPipeline>>>,
}

const DRAW: &str = include_str!("../shaders/draw.wgsl");
const COMMON: &str = include_str!("shaders/compressed.wgsl");
const BITS: &str = include_str!("shaders/bits.wgsl");

impl Pipelines for SchemePipelines {
    fn compile(renderer: &Renderer) -> Self {
        let layout = |types: &[_]| layout_for(renderer.gpu(), ShaderStages::VERTEX, types);
        Self {
            layout: layout(&[UNIFORM, STORAGE, STORAGE]),
            matrix_layout: layout(&[STORAGE]),
            compiled: Mutex::default(),
        }
    }
}

impl SchemePipelines {
    /// Returns a pipeline, after compiling it if it is the first of its kind.
    pub(super) fn get(&self, renderer: &Renderer, key: PipelineKey) -> Arc<RenderPipeline> {
        let mut compiled = self.compiled.lock().unwrap_or_else(PoisonError::into_inner);
        let made = || Arc::new(self.build(renderer, key));
        compiled.entry(key).or_insert_with(made).clone()
    }

    fn build(&self, renderer: &Renderer, key: PipelineKey) -> RenderPipeline {
        let PipelineKey { shader, entry, is_strips, culls } = key;
        let module = renderer.shader("compressed", &shader.source());
        let layouts = [&renderer.draw_layout, &self.layout, &self.matrix_layout];
        let count = if entry == SchemeEntry::ByMatrix { 3 } else { 2 };
        let position = match shader {
            SchemeShader::Plain => Some(VertexFormat::Float32x3),
            SchemeShader::Parts => Some(VertexFormat::Uint8x4),
            _ if entry == SchemeEntry::WithNormals => Some(VertexFormat::Uint32),
            _ => None,
        };
        let attribute = position
            .map(|format| [wgpu::VertexAttribute { format, offset: 0, shader_location: 0 }]);
        let positions = attribute.iter().map(|attributes| buffer(attributes));
        let normal = vertex_attr_array![1 => Snorm16x2];
        let normals = (entry == SchemeEntry::WithNormals).then(|| buffer(&normal));
        let buffers: Vec<_> = positions.chain(normals).collect();
        let name = match entry {
            SchemeEntry::Bare => "bare",
            SchemeEntry::WithNormals => "with_normals",
            SchemeEntry::ByMatrix => "by_matrix",
        };
        renderer.pipeline(&PipelineBuild {
            entries: [name, "shaded"],
            layouts: &layouts[..count],
            buffers: &buffers,
            topology: match is_strips {
                true => PrimitiveTopology::TriangleStrip,
                false => PrimitiveTopology::TriangleList,
            },
            strip_indices: IndexFormat::Uint16,
            cull: culls.then_some(wgpu::Face::Back),
            ..PipelineBuild::new("compressed", &module)
        })
    }
}

impl SchemeShader {
    /// Returns the source of the shader, with constants for the path that it takes.
    pub(super) fn source(self) -> String {
        let (is_wide, has_three_words) = match self {
            Self::Plain | Self::Parts => (false, false),
            Self::Blocks { is_wide } => (is_wide, false),
            Self::Lattice { has_three_words } => (false, has_three_words),
            Self::WideLattice => (true, true),
        };
        let parts: &[&str] = match self {
            Self::Plain => &[include_str!("shaders/plain.wgsl")],
            Self::Parts => &[include_str!("shaders/parts.wgsl")],
            Self::Blocks { .. } => &[BITS, include_str!("shaders/blocks.wgsl")],
            Self::Lattice { .. } | Self::WideLattice => {
                &[BITS, include_str!("shaders/lattice.wgsl")]
            }
        };
        let path =
            format!("const IS_WIDE = {is_wide};\nconst HAS_THREE_WORDS = {has_three_words};\n");
        [&path, DRAW, COMMON].iter().chain(parts).copied().collect()
    }
}

/// Returns the layout of one attribute.
fn buffer(attributes: &[wgpu::VertexAttribute; 1]) -> VertexBufferLayout<'_> {
    let array_stride = attributes[0].format.size();
    VertexBufferLayout { array_stride, step_mode: VertexStepMode::Vertex, attributes }
}
