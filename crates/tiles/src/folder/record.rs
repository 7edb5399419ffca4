//! Record of a tile: what is known of it when it is done.

use serde::{Deserialize, Serialize};

use crate::cell::Cell;
use crate::chain::ChainSum;
use crate::samples::MeasuredError;

/// Record of a tile that is done.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TileRecord {
    /// The tile.
    pub cell: Cell,
    /// Number of faces, without those of skirts.
    pub faces: usize,
    /// Bound of the distance between the tile as it is written and the part of the model that it
    /// shows, both ways, in model units.
    pub error: f64,
    /// Bound of the distance of the mesh that the next coarser tile is made from, in model units.
    pub bound: f64,
    /// Distance of samples of the model from the mesh; `None` for a leaf.
    pub measured: Option<MeasuredError>,
    /// Least and greatest coordinates of its content, in steps of the lattice.
    pub bounds: [[f64; 3]; 2],
    /// Bytes of the content.
    pub bytes: u64,
    /// Sum of its border edges, as two halves: see [`chain`](Self::chain).
    pub chain: [u64; 2],
    /// Number of edges between its parts that had no counterpart.
    pub open: usize,
    /// Whether it could not be simplified without harm to its border, and is as its parts are.
    pub is_unchanged: bool,
    /// Checksum of the content.
    pub content_checksum: u32,
    /// Checksum of the mesh that the next coarser tile is made from.
    pub mesh_checksum: u32,
    /// Images of the plan that the tile should show and that cannot be decoded.
    pub lost_images: Vec<usize>,
}

impl TileRecord {
    /// Returns the sum of the border edges.
    pub fn chain(&self) -> ChainSum {
        u128::from(self.chain[0]) << 64 | u128::from(self.chain[1])
    }

    /// Sets the sum of the border edges.
    pub fn with_chain(self, sum: ChainSum) -> Self {
        Self { chain: [(sum >> 64) as u64, sum as u64], ..self }
    }

    /// Creates the record of a tile of which nothing is known yet.
    pub fn new(cell: Cell) -> Self {
        Self {
            cell,
            faces: 0,
            error: 0.0,
            bound: 0.0,
            measured: None,
            bounds: [[0.0; 3]; 2],
            bytes: 0,
            chain: [0; 2],
            open: 0,
            is_unchanged: false,
            content_checksum: 0,
            mesh_checksum: 0,
            lost_images: Vec::new(),
        }
    }
}
