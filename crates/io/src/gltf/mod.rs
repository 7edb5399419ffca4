//! glTF 2.0 and GLB, with all that a document holds carried through.

mod accessor;
mod compress;
mod container;
mod document;
mod encode;
mod lod;
mod materials;
mod mesh;
mod nodes;
mod order;
mod parts;
mod place;
mod plain;
mod pool;
mod primitives;
mod quantize;
mod read;
mod rows;
mod schema;
#[cfg(test)]
mod tests;
mod unpack;
mod uri;
mod write;

pub use compress::{Bytes, Compression, CompressionReport};
pub use lod::Level;
pub use parts::{QuantizedPart, write_parts_glb};
pub use read::{Source, read};
pub use rows::PrimitiveRows;
pub use write::{Written, write, write_glb, write_small, write_small_glb};
