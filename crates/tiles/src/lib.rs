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
//! | `survey`, `space` | faces counted in cells, and the room on disk that tiles need |
//! | `cut`, `scratch`, `plan` | triangles divided among the leaves, and the plan of all tiles |
//! | `tile`, `samples`, `merge` | the mesh of a tile, and those of the parts of a cell together |
//! | `curves`, `chords`, `coarser` | a tile from its parts, by a rule that its neighbours share |
//! | `errors` | how much each level may lose |
//! | `texture`, `skirt`, `content` | the GLB of a tile |
//! | `folder`, `task` | the folder of a plan with its files, and its tasks |
//! | `chain`, `tileset` | proof that tiles meet, and `tileset.json` |
//! | `archive`, `tileset_files`, `review` | tilesets in one file, and a check of tilesets |
//! | `error` | why tiles cannot be made |
#![forbid(unsafe_code)]

pub mod archive;
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
pub mod samples;
pub mod scratch;
mod skirt;
pub mod source;
pub mod space;
pub mod survey;
pub mod task;
pub mod texture;
pub mod tile;
pub mod tileset;
mod tileset_files;

pub use cell::Cell;
pub use error::TilesError;
pub use lattice::TileLattice;
pub use octree::TileTree;
pub use tile::TileMesh;
