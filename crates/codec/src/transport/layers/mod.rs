//! Attributes of wedges, and materials and objects of faces, block by block.
//!
//! They follow the positions of a block, so that all of its geometry is known by then. Encoder,
//! decoder and the fitting of tables go through the same code, [`code_block`], with another
//! [`Coder`] each.

mod adjacency;
mod block;
mod coder;
mod directions;
mod energy;
mod entries;
mod fit;
mod format;
mod geometry;
mod job;
mod labels;
mod models;
mod normals;
mod octahedron;
mod shape;
mod source;
mod statistics;
mod tangents;
mod uv;
mod values;
mod wedges;

pub(super) use self::block::{BlockLayers, code_block};
pub(super) use self::coder::{BlockPart, SymbolReader, SymbolWriter};
pub(super) use self::fit::fit;
pub(super) use self::format::{LayerFormat, LayersFormat};
pub(super) use self::geometry::BlockGeometry;
pub(super) use self::models::{LayerTables, TableCodes};
pub(super) use self::source::{BlockSource, MeshLayers};
