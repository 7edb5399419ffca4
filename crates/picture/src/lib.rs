//! Pictures of triangle meshes, drawn on the CPU: for reports, for the error that the eye sees, for
//! finding cracks. The same pixels on every machine and for any number of threads.
//!
//! A [`Camera`] finds its place by itself; a [`Style`] says how the surface looks; [`render`] gives
//! a [`Picture`], which becomes a PNG:
//!
//! ```
//! use meshlod_samples as samples;
//! use meshlod_picture::{Camera, Style, View, Wireframe, render};
//!
//! let mesh = samples::torus(2_000);
//! let camera = Camera::fit_mesh(&mesh, &View::default());
//! let style = Style { wireframe: Some(Wireframe::default()), size: [256, 256], ..Style::default() };
//! let picture = render(&mesh, &camera, &style)?;
//! assert_eq!(&picture.png()[1..4], b"PNG");
//! # Ok::<(), meshlod_picture::PictureError>(())
//! ```
//!
//! [`Paint`] colours it: plainly, by materials and textures, by one colour a face, or by numbers
//! through a [`ColorMap`], as in a heat map of errors. [`visibility()`] tells which face each pixel
//! sees, without any shading.
//!
//! [`image_error`] is what a level looks wrong by: its pictures from twelve sides beside those of
//! its original, compared as the eye does ([`flip()`]) and by structure ([`ssim()`]). A [`ReferenceVisibility`]
//! finds the pixels where a level shows what its original hides.
//!
//! # How it works
//! Vertices are projected once, to fixed point. Faces are sorted into tiles; each tile finds the
//! nearest face of every sample by integer edge functions, so that faces with a common edge neither
//! overlap nor leave a gap; then it shades what is seen. Tiles know nothing of each other, and of
//! equally near faces the lower id wins: order and threads leave no trace. Only + - * / and square
//! roots are used, which are the same on all machines; comparing pictures also takes roots and powers of the library.
#![forbid(unsafe_code)]

mod albedo;
mod bins;
mod camera;
mod clip;
mod color_map;
mod decode;
mod error;
mod facet;
mod flip;
mod image_error;
mod lab;
mod light;
mod normals;
mod picture;
mod plane;
mod project;
mod raster;
mod render;
#[cfg(test)]
mod scenes;
mod see_through;
mod srgb;
mod ssim;
mod style;
mod texture;
mod trigonometry;
mod visibility;

pub use camera::{Camera, UpAxis, View};
pub use color_map::ColorMap;
pub use error::{MAX_SIDE, PictureError};
pub use flip::{PIXELS_PER_DEGREE, flip};
pub use image_error::{ImageError, ReferenceImages, ViewError, image_error};
pub use picture::{Picture, beside, grid};
pub use render::render;
pub use see_through::{
    LabelledMesh, ReferenceVisibility, SeeThrough, SeeThroughCounts, SeeThroughOptions,
};
pub use ssim::ssim;
pub use style::{
    Antialiasing, BackFaces, Background, Lighting, Materials, Normals, Paint, PaintMaterial, Style,
    Values, Wireframe,
};
pub use texture::Texture;
pub use visibility::{Visibility, visibility};
