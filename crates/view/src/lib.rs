//! Draws meshes, levels, cuts and flocks on the GPU, with wgpu; and a viewer for them.
//!
//! The renderer draws into any render pass. A [`Gpu`] is the device, a [`Renderer`] the pipelines
//! for one kind of target, a [`Placement`] how one thing is seen by one camera. The simplest thing
//! is a [`GpuMesh`]. A [`Canvas`] is a target without a window:
//!
//! ```no_run
//! use meshlod::picture::{Camera, Normals, Paint, View};
//! use meshlod::samples;
//! use meshlod_view::{Canvas, Gpu, GpuMesh, Renderer, Shade, TargetFormat};
//!
//! let gpu = Gpu::headless()?;
//! let renderer = Renderer::new(&gpu, TargetFormat::CANVAS);
//! let knot = samples::knot(20_000);
//! let mesh = GpuMesh::new(&renderer, &knot, &Paint::default(), Normals::Smooth)?;
//! let camera = Camera::fit_mesh(&knot, &View::default());
//!
//! let canvas = Canvas::new(&gpu, [640, 480])?;
//! let placement = renderer.placement();
//! placement.set(&camera, canvas.size(), mesh.origin(), &Shade::default());
//! canvas.draw(|pass| mesh.draw(&renderer, pass, &placement));
//! std::fs::write("knot.png", canvas.read()?.png())?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What always holds
//! - Depth is reversed and without a far plane: 1 at the near plane, 0 at infinity. Clear it to 0.
//! - Positions on the GPU are `f32` relative to an origin near the model, so that coordinates in
//!   the millions lose nothing; matrices are made in `f64`.
//! - Colours are computed in linear light, as by [`meshlod::picture`]. Targets are sRGB formats.
#![forbid(unsafe_code)]

mod canvas;
mod cut;
mod error;
mod flock;
mod gpu;
mod ground;
mod mesh;
mod placement;
mod quantized;
mod render;
mod renderer;
mod school;
pub mod script;
pub mod stage;
#[cfg(feature = "viewer")]
pub mod viewer;

pub use canvas::Canvas;
pub use cut::{
    CutError, CutFollower, CutModel, CutPatch, CutQuery, CutStep, CutTolerance, FollowOptions,
    GpuCut, MovedVertex, Transition,
};
pub use error::ViewError;
pub use flock::{GpuFlock, GpuObstacles, GpuSelection, HiZ};
pub use gpu::Gpu;
pub use ground::Ground;
pub use mesh::{GpuMesh, GpuStrips};
pub use placement::{Placement, Shade};
pub use quantized::{CompressedOptions, GpuCompressed, PartMatrices};
pub use render::{render, view_camera};
pub use renderer::{Backdrop, Renderer, TargetFormat};
pub use school::{SchoolFrame, SchoolHistory, SchoolShow};
