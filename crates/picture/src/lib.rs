//! Renders triangle meshes on the CPU, for reports, comparison of pictures and crack detection.
//!
//! Pixels are the same on every machine and for any number of threads.
//!
//! A [`Camera`] can be fitted to the mesh, a [`Style`] describes the look, and [`render`] returns a
//! [`Picture`] that can be saved as PNG:
//!
//! ```
//! use meshlod_samples as samples;
//! use meshlod_picture::{Camera, Style, View, Wireframe, render};
//!
//! let mesh = samples::torus(2_000);
//! let camera = Camera::fit_mesh(&mesh, &View::default());
//! let wireframe = Some(Wireframe::default());
//! let style = Style { wireframe, size: [256, 256], ..Style::default() };
//! let picture = render(&mesh, &camera, &style)?;
//! assert_eq!(&picture.png()[1..4], b"PNG");
//! # Ok::<(), meshlod_picture::PictureError>(())
//! ```
//!
//! [`Paint`] colours the surface: plainly, by materials and textures, with one colour per face, or
//! by numbers through a [`ColorMap`], as in a heat map of errors. [`visibility()`] finds the face
//! that each pixel sees, without shading.
//!
//! A model that is far away can be a [`Card`]: a flat piece of an atlas that is seen through.
//! [`card_layer`] draws cards behind and before a mesh, to be laid over its picture.
//!
//! [`image_error`] measures how different a level looks: it compares pictures from twelve sides
//! with those of the original, perceptually ([`flip()`]) and structurally ([`ssim()`]). A
//! [`ReferenceVisibility`] finds the pixels where a level shows what its original hides.
//!
//! # How it works
//! Vertices are projected once, to fixed point. Faces are binned by tile. Each tile finds the
//! nearest face of every sample with integer edge functions, so that faces with a common edge
//! neither overlap nor leave a gap, and then shades what is visible. Tiles are independent, and of
//! equally near faces the one with the lowest id wins, so the result depends neither on order nor
//! on threads. Only + - * / and square roots are used, which give the same results on all machines;
//! comparing pictures also uses roots and powers of the standard library.
//!
//! | files, in reading order | hold |
//! |---|---|
//! | `camera`, `style`, `color_map` | what is drawn, and how |
//! | `render` | the drawing of a picture: start here |
//! | `project`, `clip`, `culling`, `bins`, `raster`, `visibility` | from vertices to the nearest face of each sample |
//! | `facet`, `normals`, `albedo`, `light`, `texture`, `decode`, `shrink` | from the face to a colour |
//! | `picture`, `srgb`, `error` | pixels, and PNG |
//! | `cards` | flat pieces of an atlas for what is far away |
//! | `image_error`, `flip`, `ssim`, `lab`, `plane` | how different two pictures look |
//! | `see_through` | pixels that show what the original hides |
//! | `trigonometry` | functions that are the same on every machine |
#![forbid(unsafe_code)]

mod albedo;
mod bins;
mod camera;
mod cards;
mod clip;
mod color_map;
mod culling;
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
mod shrink;
mod srgb;
mod ssim;
mod style;
mod texture;
mod trigonometry;
mod visibility;

pub use camera::{Camera, UpAxis, View};
pub use cards::{Card, CardAtlas, CardLayer, bleed, card_layer};
pub use color_map::ColorMap;
pub use error::{MAX_SIDE, PictureError};
pub use flip::{PIXELS_PER_DEGREE, flip};
pub use image_error::{ImageError, ReferenceImages, ViewError, image_error};
pub use normals::corner_normals;
pub use picture::{Picture, grid, side_by_side};
pub use render::render;
pub use see_through::{
    LabelledMesh, ReferenceVisibility, SeeThrough, SeeThroughCounts, SeeThroughOptions,
};
pub use shrink::{Averaging, MAX_TEXELS};
pub use ssim::ssim;
pub use style::{
    Antialiasing, BackFaces, Background, Lighting, Materials, Normals, Paint, PaintMaterial, Style,
    Values, Wireframe,
};
pub use texture::Texture;
pub use visibility::{Visibility, visibility};
