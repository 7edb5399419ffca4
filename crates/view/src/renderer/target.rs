//! Format of a target.

use wgpu::{CompareFunction, DepthStencilState, MultisampleState, TextureFormat};

/// Format of the render passes that a [`Renderer`](crate::Renderer) draws into.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TargetFormat {
    /// Format of the colours, an sRGB one.
    pub color: TextureFormat,
    /// Format of the depths.
    pub depth: TextureFormat,
    /// Samples per pixel.
    pub samples: u32,
}

impl TargetFormat {
    /// Format of a [`Canvas`](crate::Canvas).
    pub const CANVAS: Self = Self {
        color: TextureFormat::Rgba8UnormSrgb,
        depth: TextureFormat::Depth32Float,
        samples: 4,
    };

    pub(crate) fn multisample(self) -> MultisampleState {
        MultisampleState { count: self.samples, ..MultisampleState::default() }
    }

    pub(crate) fn depth_state(self, compare: CompareFunction, write: bool) -> DepthStencilState {
        DepthStencilState {
            format: self.depth,
            depth_write_enabled: Some(write),
            depth_compare: Some(compare),
            stencil: Default::default(),
            bias: Default::default(),
        }
    }
}
