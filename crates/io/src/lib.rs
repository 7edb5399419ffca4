//! Mesh files in and out, one format a module: bytes in, typed errors out.
#![forbid(unsafe_code)]

mod buckets;
mod error;
mod files;
mod flatten;
mod format;
pub mod gltf;
mod lines;
pub mod obj;
pub mod off;
pub mod ply;
mod polygon;
mod replace;
mod scene;
pub mod smf;
pub mod stl;
mod text;
mod torn;
mod weld;

pub use error::{IoError, ParseError, Place, Unfit};
pub use files::{ReadOptions, Resolve, Weld, WriteOptions, read, read_bytes, write, write_lods};
pub use flatten::Placement;
pub use format::Format;
pub use scene::{Image, Material, Node, Scene, SceneMesh};
pub use weld::{merge_equal_wedges, weld};

/// How coordinates are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// As 32-bit floats: what most programs read.
    #[default]
    F32,
    /// As 64-bit floats, bit for bit.
    F64,
}
