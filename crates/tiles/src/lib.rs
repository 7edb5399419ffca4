//! Meshes larger than memory as a tree of tiles: a leaf holds a part of the input, any other tile
//! a coarser surface of its up to eight children.
//!
//! A tile needs nothing from its neighbours, and yet meets them without a crack at every level,
//! whatever made it and in whatever order.
//!
//! | files, in reading order | hold |
//! |---|---|
//! | `lattice`, `cell`, `octree` | the points that vertices are on, and the cells of tiles |
//! | `layout`, `source` | triangles of a scene or of a file that is read in passing |
//! | `cut`, `scratch`, `plan` | triangles divided among the leaves, and the plan of all tiles |
//! | `tile`, `merge` | the mesh of a tile, and those of the parts of a cell put together |
//! | `curves`, `chords`, `coarser` | a tile from its parts, by a rule that its neighbours share |
//! | `errors` | how much each level may lose |
//! | `texture`, `skirt`, `content` | the GLB of a tile |
//! | `tile_file`, `folder`, `task` | files of a plan, and its tasks |
//! | `chain`, `tileset`, `review` | proof that tiles meet, `tileset.json`, and a check of it |
//! | `error` | why tiles cannot be made |
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
