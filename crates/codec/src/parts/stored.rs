//! Stored form of parts, for renderers.

use std::ops::Range;

/// Positions in parts as an `.mlq` file stores them: 8 bits per axis on one grid.
///
/// A node is at `cell` · (offset of its part + position + `within`) along each axis. The sum of
/// integers is the cell of the shared grid, equal in all parts that have the vertex, so whoever adds
/// first and scales once opens no cracks.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredParts<'a> {
    /// Sides of a grid cell along x, y and z, in model units.
    pub cell: [f32; 3],
    /// Place of vertices in their cells, as a fraction of its sides: 0.5 or 0.
    pub within: f64,
    /// Parts in the order of their nodes; part `i` has the faces of patch `i`.
    pub parts: Vec<StoredPart>,
    /// Local cell of each node.
    pub positions: &'a [[u8; 3]],
}

/// Header of a part: where its local cells start, and which nodes it has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StoredPart {
    /// Cell of the shared grid at which local cells start, at most 2²³ from the origin.
    pub offset: [i32; 3],
    /// Nodes of the part.
    pub nodes: Range<u32>,
}
