//! The vertex of each node: a vertex has one node for each of its wedges.

use std::ops::Range;

use meshlod_mesh::VertexId;

use super::nodes::Nodes;
use super::positions::Positions;
use super::weld_parts::WeldExceptions;
use crate::attributes::PackedRows;
use crate::bytes::Malformed;
use crate::kd::BLOCK;
use crate::patch::Rows;

/// Map from nodes to vertices.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum WedgeVertices {
    /// Every node is a vertex.
    Identity,
    /// Every second row holds further wedges of vertices of the row before, by their numbers there.
    Extra(PackedRows),
    /// Each part has its own copy of a vertex; copies are welded by their cells.
    Parts(WeldExceptions),
}

impl WedgeVertices {
    /// Builds the map for blocks: for each wedge that is not the first of its vertex, the number of
    /// the vertex in its block.
    pub(super) fn extra(order: &[u32], nodes: &Nodes, ordered: &[VertexId], rows: &Rows) -> Self {
        let mut number = vec![0; nodes.vertex_of.iter().max().map_or(0, |v| v.index() + 1)];
        ordered.iter().enumerate().for_each(|(at, v)| number[v.index()] = (at % BLOCK) as u32);
        let odd = (0..rows.len() / 2).map(|block| rows.range(2 * block + 1));
        let number = |at: usize| number[nodes.vertex_of[order[at] as usize].index()];
        let numbers: Vec<u32> = odd.clone().flatten().map(number).collect();
        Self::Extra(PackedRows::new(Rows::new(odd.map(|row| row.len())), 1, &numbers))
    }

    /// Returns the vertex of a node, which is given also by its row and its number there. Nodes of
    /// parts stay separate.
    pub(super) fn of(&self, node: u32, (row, number): (usize, usize), rows: &Rows) -> u32 {
        let Self::Extra(extra) = self else { return node };
        let own = block_vertices(row / 2, rows);
        match row % 2 {
            0 => own.start + number as u32,
            _ => vertex_in(&own, extra.get(row / 2, number)[0]),
        }
    }

    /// Returns the vertex of each node, and the positions of the vertices.
    pub(super) fn all(
        &self,
        faces: &[[u32; 3]],
        positions: &Positions,
        rows: &Rows,
    ) -> Result<(Vec<u32>, Vec<[f64; 3]>), Malformed> {
        match (self, positions.parts()) {
            (Self::Parts(exceptions), Some(parts)) => {
                let first = exceptions.first_nodes(faces, &parts.cells())?;
                let (vertex_of, kept) = number_vertices(&first, &positions.all());
                if kept.len() != parts.vertices() {
                    let (found, expected) = (kept.len(), parts.vertices());
                    let reason = format!("expected {expected} vertices, found {found}");
                    return Err(Malformed { at: 0, reason });
                }
                Ok((vertex_of, kept))
            }
            _ => Ok((self.position_of(rows), positions.all())),
        }
    }

    /// Returns the stored position of each node. Parts store one for each.
    pub(super) fn position_of(&self, rows: &Rows) -> Vec<u32> {
        let Self::Extra(numbers) = self else { return (0..rows.nodes() as u32).collect() };
        let mut position_of = Vec::with_capacity(rows.nodes());
        let mut numbers = numbers.all().into_iter();
        for block in 0..rows.len() / 2 {
            let own = block_vertices(block, rows);
            position_of.extend(own.clone());
            let extra = numbers.by_ref().take(rows.range(2 * block + 1).len());
            position_of.extend(extra.map(|number| vertex_in(&own, number)));
        }
        position_of
    }

    pub(super) fn bytes(&self) -> usize {
        match self {
            Self::Identity => 0,
            Self::Extra(numbers) => numbers.rows().bytes() + numbers.bytes(),
            Self::Parts(exceptions) => exceptions.bytes(),
        }
    }
}

/// Returns the vertices of a block that has two rows.
fn block_vertices(block: usize, rows: &Rows) -> Range<u32> {
    let first = (block * BLOCK) as u32;
    first..first + rows.range(2 * block).len() as u32
}

/// Returns the vertex with a number in its block. Only damaged data has larger numbers, which give
/// the last vertex.
fn vertex_in(own: &Range<u32>, number: u32) -> u32 {
    own.start.saturating_add(number).min(own.end - 1)
}

/// Numbers the vertices of nodes; `first[node]` is the first node of the same vertex. Returns the
/// vertex of each node and the positions of the vertices.
fn number_vertices(first: &[u32], positions: &[[f64; 3]]) -> (Vec<u32>, Vec<[f64; 3]>) {
    let mut vertex_of = vec![0; first.len()];
    let mut kept = Vec::new();
    for (node, &is) in first.iter().enumerate() {
        if is as usize == node {
            vertex_of[node] = kept.len() as u32;
            kept.push(positions[node]);
        } else {
            vertex_of[node] = vertex_of[is as usize];
        }
    }
    (vertex_of, kept)
}
