//! glTF 2.0 and GLB, with all that a document holds carried through.

mod accessor;
mod container;
mod document;
mod encode;
mod lod;
mod materials;
mod mesh;
mod nodes;
mod plain;
mod pool;
mod primitives;
mod read;
mod rows;
mod schema;
#[cfg(test)]
mod tests;
mod unpack;
mod uri;
mod write;

pub use lod::Level;
pub use read::{Source, read};
pub use rows::PrimitiveRows;
pub use write::{Written, write, write_glb};
