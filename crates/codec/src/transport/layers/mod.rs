//! Attributes of wedges, and materials and objects of faces, block by block.
//!
//! They follow the positions of a block, so that all of its geometry is known by then. Encoder,
//! decoder and the fitting of tables go through the same code, [`code_block`], with another
//! [`Coder`] each.
//!
//! | files, in reading order | hold |
//! |---|---|
//! | `block`, `coder` | the walk over a block: start here |
//! | `layer_format`, `format` | what the header says about layers and labels |
//! | `source` | attributes as integers, for the encoder |
//! | `geometry`, `adjacency` | positions and faces from which values are predicted |
//! | `wedges`, `entries`, `labels` | which corners share a wedge or a value; materials and objects |
//! | `job`, `energy` | a layer as the predictors see it |
//! | `normals`, `directions`, `octahedron`, `tangents` | predictions of directions |
//! | `uv`, `values` | predictions of all other layers |
//! | `fit`, `statistics`, `shape`, `models` | predictions chosen, and tables fitted |

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
mod layer_format;
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
pub(super) use self::format::LayersFormat;
pub(super) use self::geometry::BlockGeometry;
pub(super) use self::layer_format::LayerFormat;
pub(super) use self::models::{LayerTables, TableCodes};
pub(super) use self::source::{BlockSource, MeshLayers};
