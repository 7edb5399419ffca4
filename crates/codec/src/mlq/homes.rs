//! Which vertex each node is: rows of nodes have a vertex once for each of its wedges.

use std::ops::Range;

use meshlod_mesh::VertexId;

use super::nodes::Nodes;
use super::positions::Positions;
use super::unite::Exceptions;
use crate::attributes::Packed;
use crate::bytes::Malformed;
use crate::kd::BLOCK;
use crate::patch::Rows;

/// How nodes come to vertices.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Homes {
    /// Each is one.
    Own,
    /// Every second row has further wedges of vertices in the row before: their numbers there.
    Doubles(Packed),
    /// Parts have a vertex once each.
    Parts(Exceptions),
}

impl Homes {
    /// Of the wedges that are not their vertex's first: the number of their vertex in its block.
    pub(super) fn doubles(order: &[u32], nodes: &Nodes, ordered: &[VertexId], rows: &Rows) -> Self {
        let mut number = vec![0; nodes.vertex_of.iter().max().map_or(0, |v| v.index() + 1)];
        ordered.iter().enumerate().for_each(|(at, v)| number[v.index()] = (at % BLOCK) as u32);
        let odd = (0..rows.len() / 2).map(|block| rows.range(2 * block + 1));
        let number = |at: usize| number[nodes.vertex_of[order[at] as usize].index()];
        let numbers: Vec<u32> = odd.clone().flatten().map(number).collect();
        Self::Doubles(Packed::new(Rows::new(odd.map(|row| row.len())), 1, &numbers))
    }

    /// The vertex of a node, in a row by its number there.
    pub(super) fn of(&self, node: u32, (row, number): (usize, usize), rows: &Rows) -> u32 {
        let Self::Doubles(doubles) = self else { return node };
        let own = own(row / 2, rows);
        match row % 2 {
            0 => own.start + number as u32,
            _ => double(&own, doubles.get(row / 2, number)[0]),
        }
    }

    /// The vertex of each node, and where vertices are.
    pub(super) fn all(
        &self,
        faces: &[[u32; 3]],
        positions: &Positions,
        rows: &Rows,
    ) -> Result<(Vec<u32>, Vec<[f64; 3]>), Malformed> {
        match (self, positions) {
            (Self::Parts(exceptions), Positions::Parts(parts)) => {
                let first = exceptions.first(faces, &parts.cells())?;
                let (home, kept) = first_ones(&first, &positions.all());
                if kept.len() != parts.vertices() {
                    let reason = format!("{} vertices, not {}", kept.len(), parts.vertices());
                    return Err(Malformed { at: 0, reason });
                }
                Ok((home, kept))
            }
            (Self::Doubles(numbers), _) => {
                let mut home = Vec::with_capacity(rows.nodes());
                let mut numbers = numbers.all().into_iter();
                for block in 0..rows.len() / 2 {
                    let own = own(block, rows);
                    home.extend(own.clone());
                    let doubles = numbers.by_ref().take(rows.range(2 * block + 1).len());
                    home.extend(doubles.map(|number| double(&own, number)));
                }
                Ok((home, positions.all()))
            }
            _ => Ok(((0..rows.nodes() as u32).collect(), positions.all())),
        }
    }

    pub(super) fn bytes(&self) -> usize {
        match self {
            Self::Own => 0,
            Self::Doubles(numbers) => numbers.rows().bytes() + numbers.bytes(),
            Self::Parts(exceptions) => exceptions.bytes(),
        }
    }
}

/// The vertices of a block with doubles.
fn own(block: usize, rows: &Rows) -> Range<u32> {
    let first = (block * BLOCK) as u32;
    first..first + rows.range(2 * block).len() as u32
}

/// The vertex of that number in its block. More than there are is told by spoilt bytes alone.
fn double(own: &Range<u32>, number: u32) -> u32 {
    own.start.saturating_add(number).min(own.end - 1)
}

/// Of nodes that are told the first that is the same vertex: the vertex of each, and where vertices are.
fn first_ones(first: &[u32], positions: &[[f64; 3]]) -> (Vec<u32>, Vec<[f64; 3]>) {
    let mut home = vec![0; first.len()];
    let mut kept = Vec::new();
    for (node, &is) in first.iter().enumerate() {
        if is as usize == node {
            home[node] = kept.len() as u32;
            kept.push(positions[node]);
        } else {
            home[node] = home[is as usize];
        }
    }
    (home, kept)
}
