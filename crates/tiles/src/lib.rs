//! Meshes larger than memory as a tree of tiles: a leaf holds a part of the input, any other tile
//! a coarser surface of its up to eight children.
//!
//! A tile needs nothing from its neighbours, and yet meets them without a crack at every level,
//! whatever made it and in whatever order. Reading order: [`lattice`], on which all vertices are;
//! [`cell`] and [`octree`]; [`cut`], which divides triangles among the leaves; [`curves`], the rule
//! by which two neighbours simplify what they share; [`coarser`], which makes a tile of its
//! children.
#![forbid(unsafe_code)]

pub mod cell;
pub mod chain;
mod chords;
pub mod coarser;
pub mod content;
pub mod curves;
pub mod cut;
pub mod error;
pub mod errors;
pub mod folder;
pub mod lattice;
pub mod layout;
pub mod merge;
pub mod octree;
pub mod plan;
pub mod review;
pub mod scratch;
mod skirt;
pub mod source;
pub mod task;
pub mod texture;
pub mod tile;
mod tile_file;
pub mod tileset;

pub use cell::Cell;
pub use error::TilesError;
pub use lattice::TileLattice;
pub use octree::TileTree;
pub use tile::TileMesh;
