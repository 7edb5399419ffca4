//! Compression of triangle meshes, for drawing from compressed memory and for sending.
//!
//! Four ways to store positions:
//!
//! - [`Parts`]: 8 bits per axis, decoded by the vertex transform alone [LCL10]. The mesh is
//!   partitioned into parts with boxes of about equal size. All parts share one grid of equal
//!   cells, and each part has a matrix that places its cells, so that common vertices coincide.
//! - [`LatticeBlocks`]: each vertex in one block of 32, on a [`Lattice`] that several meshes can
//!   share. Common vertices decode to the same bits in every mesh.
//! - [`VertexBlocks`]: each vertex in one block of 32, with an oriented frame per block and cells
//!   as large as the surface allows. Fewest bits for a given distance between the surfaces; one
//!   matrix per block decodes them.
//! - [`Transport`]: an entropy-coded mesh for sending and storing, in blocks that a
//!   [`TransportFile`] decodes independently.
//!
//! [`compress`] builds a complete mesh with one of the first three: faces in patches and attributes
//! in the same rows, so that any piece can be decoded on its own. That is the `.mlq` file.
//! [`Compressed::with_strips`] stores the faces of parts as triangle strips instead.
//! [`Transport`] writes the smaller `.mlz` file.
//!
//! ```
//! use meshlod_codec::{Compressed, CompressionTarget, Scheme, compress};
//! use meshlod_mesh::AttributeBounds;
//! use meshlod_samples as samples;
//!
//! let mesh = samples::sphere(5000);
//! let bounds = AttributeBounds::default();
//! let done = compress(&mesh, Scheme::Blocks, CompressionTarget::Bits(11), &bounds)?;
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
mod header_field;
mod kd;
mod labels;
mod lattice;
mod parts;
mod patch;
mod resident;
#[cfg(test)]
mod test_meshes;
mod transport;

pub use attributes::LayerReport;
pub use blocks::{
    Accuracy, BlocksError, BlocksReport, StoredBlock, StoredBlocks, SurfaceChange, VertexBlocks,
};
pub use bytes::Malformed;
pub use lattice::{Lattice, LatticeBlocks, LatticeError, StoredLattice, StoredShear};
pub use parts::{Part, Partitioner, Parts, PartsError, Reconstruction, StoredPart, StoredParts};
pub use resident::{
    CompressError, Compressed, CompressedSizes, Compression, CompressionTarget, Scheme, StoredMesh,
    StoredPositions, StoredStrips, StripsError, compress, parts_for,
};
pub use transport::{
    Transport, TransportError, TransportFile, TransportOptions, TransportQuantization,
    TransportSizes,
};
