//! Geometry that stays compressed on the GPU, without cracks.
//!
//! [`Parts`] are positions of eight bits an axis, decoded by the vertex transform alone: the mesh falls into
//! parts whose boxes are about equally large, all cells are of one size and lie in one grid, and each part has
//! a matrix that puts its cells where they belong. What two parts share is in the same cell in both.
//!
//! [`LatticeBlocks`] put each vertex into one block of 32, on a [`Lattice`] that meshes can share: what they have in
//! common is the same in both, bit for bit, and there are no borders to crack.
//!
//! [`VertexBlocks`] lie as the surface does, each in its own frame, with cells as large as the surface allows: the
//! fewest bits for the distance between the surfaces. A matrix a block decodes them.
//!
//! A [`Transport`] is a mesh to be sent or stored, entropy coded, in blocks that a [`TransportFile`] decodes one by one.
//!
//! [`compress`] makes a whole mesh of one of them: with its faces in patches and its attributes by the same blocks, any
//! piece decoded alone. That is the file `.mlq`; [`Transport`] makes `.mlz`, smaller, to be sent.
//!
//! ```
//! use meshlod_codec::{AttributeBounds, Compressed, Scheme, Target, compress};
//! use meshlod_samples as samples;
//!
//! let mesh = samples::sphere(5000);
//! let bounds = AttributeBounds::default();
//! let done = compress(&mesh, Scheme::Blocks, Target::Bits(11), &bounds)?;
//! assert!(done.compressed.reduction() > 0.75);
//! let bytes = done.compressed.to_bytes();
//! let decoded = Compressed::from_bytes(&bytes)?.decode()?;
//! assert_eq!(decoded.faces.len(), mesh.faces.len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![forbid(unsafe_code)]

mod attributes;
mod bits;
mod blocks;
mod bytes;
mod kd;
mod lattice;
mod mlq;
mod parts;
mod patch;
mod transport;

pub use attributes::{AttributeBounds, LayerReport};
pub use blocks::{BlocksError, BlocksReport, Change, Closeness, VertexBlocks};
pub use bytes::Malformed;
pub use lattice::{Lattice, LatticeBlocks, LatticeError};
pub use mlq::{CompressError, Compressed, Compression, Scheme, Sizes, Target, compress, parts_for};
pub use parts::{Cells, Part, Parting, Parts, PartsError};
pub use transport::{
    LeftOut, Transport, TransportBlock, TransportError, TransportFile, TransportGrid,
    TransportOptions, TransportSizes,
};
