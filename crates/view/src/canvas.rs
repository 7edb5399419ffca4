//! Target without a window, whose pixels can be read.

use meshlod::picture::Picture;
use wgpu::{
    BufferUsages, Color, CommandEncoder, Extent3d, LoadOp, Operations, RenderPass, StoreOp,
    Texture, TextureUsages, TextureView,
};

use crate::gpu::buffers::blank_buffer;
use crate::gpu::read::map;
use crate::gpu::texture::texture_2d;
use crate::{Gpu, TargetFormat, ViewError};

/// Target in memory, with depth, and readable as a [`Picture`].
#[derive(Debug)]
pub struct Canvas {
    gpu: Gpu,
    format: TargetFormat,
    size: [u32; 2],
    /// Samples of the pixels, if there are several for each.
    samples: Option<TextureView>,
    resolved: Texture,
    resolved_view: TextureView,
    depth: TextureView,
    /// Linear colour of a cleared canvas, with alpha.
    pub clear: [f64; 4],
    /// Keep the depths of each pass, for [`Canvas::depth`].
    pub keeps_depth: bool,
}

impl Canvas {
    /// Creates a transparent, antialiased canvas of a width and height in pixels.
    ///
    /// # Errors
    /// A side of zero, or beyond the limit of the GPU.
    pub fn new(gpu: &Gpu, size: [u32; 2]) -> Result<Self, ViewError> {
        Self::with_format(gpu, size, TargetFormat::CANVAS)
    }

    /// Creates a transparent canvas with the depths and the samples per pixel of a format, which a
    /// renderer for that format draws on; its colours are those of [`TargetFormat::CANVAS`].
    ///
    /// # Errors
    /// As [`Canvas::new`], and a format of other colours.
    pub fn with_format(gpu: &Gpu, size: [u32; 2], format: TargetFormat) -> Result<Self, ViewError> {
        let limit = gpu.device.limits().max_texture_dimension_2d;
        if size.iter().any(|&side| side == 0 || side > limit) {
            return Err(ViewError::Size { size, limit });
        }
        if format.color != TargetFormat::CANVAS.color || ![1, 4].contains(&format.samples) {
            return Err(ViewError::Unsupported("draw on a canvas of this format"));
        }
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        gpu.check_buffer("the pixels of a picture", 4 * pixels)?;
        let attachment = TextureUsages::RENDER_ATTACHMENT;
        let view = |texture: &Texture| texture.create_view(&Default::default());
        let samples = (format.samples > 1)
            .then(|| view(&texture_2d(gpu, size, format.color, format.samples, attachment)));
        let bound = attachment | TextureUsages::TEXTURE_BINDING;
        let depth = texture_2d(gpu, size, format.depth, format.samples, bound);
        let readable = bound | TextureUsages::COPY_SRC;
        let resolved = texture_2d(gpu, size, format.color, 1, readable);
        Ok(Self {
            gpu: gpu.clone(),
            format,
            size,
            samples,
            resolved_view: view(&resolved),
            resolved,
            depth: view(&depth),
            clear: [0.0; 4],
            keeps_depth: false,
        })
    }

    /// Returns the width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Returns the format of its passes.
    pub fn format(&self) -> TargetFormat {
        self.format
    }

    /// Returns the texture with the picture, one sample a pixel.
    pub fn resolved(&self) -> &Texture {
        &self.resolved
    }

    /// Returns the depths of all samples, as they were drawn last with `keeps_depth`.
    pub fn depth(&self) -> &TextureView {
        &self.depth
    }

    /// Returns a view of the pixels for panels, whose texels are sRGB values as they are.
    #[cfg(feature = "viewer")]
    pub(crate) fn panel_view(&self) -> TextureView {
        let format = Some(self.resolved.format().remove_srgb_suffix());
        let usage = Some(TextureUsages::TEXTURE_BINDING);
        self.resolved.create_view(&wgpu::TextureViewDescriptor {
            format,
            usage,
            ..Default::default()
        })
    }

    /// Clears the canvas and draws on it, and submits that to the GPU.
    pub fn draw(&self, draw: impl FnOnce(&mut RenderPass<'_>)) {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        draw(&mut self.pass(&mut encoder));
        self.gpu.queue.submit([encoder.finish()]);
    }

    /// Begins a pass that clears the canvas.
    pub fn pass<'e>(&self, encoder: &'e mut CommandEncoder) -> RenderPass<'e> {
        let [r, g, b, a] = self.clear;
        let store = if self.samples.is_some() { StoreOp::Discard } else { StoreOp::Store };
        let keep = if self.keeps_depth { StoreOp::Store } else { StoreOp::Discard };
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("canvas"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: self.samples.as_ref().unwrap_or(&self.resolved_view),
                depth_slice: None,
                resolve_target: self.samples.as_ref().map(|_| &self.resolved_view),
                ops: Operations { load: LoadOp::Clear(Color { r, g, b, a }), store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(Operations { load: LoadOp::Clear(0.0), store: keep }),
                stencil_ops: None,
            }),
            ..Default::default()
        })
    }

    /// Reads the pixels, after all work submitted before.
    ///
    /// # Errors
    /// The device was lost.
    pub fn read(&self) -> Result<Picture, ViewError> {
        let [width, height] = self.size;
        let row = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let usage = BufferUsages::COPY_DST | BufferUsages::MAP_READ;
        let buffer = blank_buffer(&self.gpu, "pixels", u64::from(row) * u64::from(height), usage);
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(row),
            rows_per_image: None,
        };
        encoder.copy_texture_to_buffer(
            self.resolved.as_image_copy(),
            wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
            Extent3d { width, height, depth_or_array_layers: 1 },
        );
        self.gpu.queue.submit([encoder.finish()]);
        let bytes = map(&self.gpu, &buffer)?;
        let rows = bytes.chunks_exact(row as usize);
        let rgba = rows.flat_map(|bytes| &bytes[..4 * width as usize]).copied().collect();
        Ok(Picture::new(width, height, rgba)?)
    }
}
