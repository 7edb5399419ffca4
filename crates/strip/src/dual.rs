//! The dual graph of a list of faces, which tells the face across each side.

use meshlod_mesh::VertexId;

use crate::dual_node::{DualEdge, DualNode};
use crate::verify::has_three_corners;

/// Builds the dual graph without links. Two sides are opposite if they run along the same edge in
/// opposite directions.
///
/// Any faces are accepted. On an edge with more than two sides as many as possible are paired.
/// Sides that run in the same direction are never paired, because no strip can cross there. A face
/// that repeats a vertex has no neighbours. Cost: O(n) if the faces of a vertex are close in the
/// list, O(n log n) in the worst case.
///
/// # Panics
/// Above [`DualEdge::MAX_NODES`] faces.
pub(crate) fn nodes(faces: &[[VertexId; 3]]) -> Vec<DualNode> {
    assert!(faces.len() <= DualEdge::MAX_NODES, "sides are numbered in 32 bits");
    let most = faces.as_flattened().iter().fold(0, |most, v| v.0.max(most)) as usize;
    // With few of the vertex ids in use, a table indexed by them does not pay and could have any
    // size.
    if most > 8 * faces.len() {
        return sorted(faces);
    }
    pair_by_lists(faces, most + 1).unwrap_or_else(|| sorted(faces))
}

/// Number of rising sides inspected per face, on average, before sorting becomes the better choice.
/// Meshes need 2 to 4; fans of thousands of faces need thousands.
const MAX_LOOKS: usize = 64;

/// Pairs sides in two passes: sides that rise to a higher vertex are listed at the lower one, and
/// falling sides look themselves up there. Gives up after [`MAX_LOOKS`] per face.
///
/// A side rises or falls at random, so nothing branches on it.
fn pair_by_lists(faces: &[[VertexId; 3]], vertex_count: usize) -> Option<Vec<DualNode>> {
    let Sides { starts, mut rising, falling } = Sides::new(faces, vertex_count);
    let mut nodes = vec![DualNode::ISOLATED; faces.len()];
    let mut looks = faces.len() * MAX_LOOKS;
    for edge in falling {
        let [from, to] = ends(&faces[edge.node()], edge.side());
        let list = &mut rising[starts[to.index()] as usize..starts[to.index() + 1] as usize];
        let found = list.iter().position(|rising| rising.0 == from);
        looks = looks.checked_sub(found.map_or(list.len(), |place| place + 1))?;
        if let Some(place) = found {
            let (_, other) = std::mem::replace(&mut list[place], (to, DualEdge::NONE));
            nodes[edge.node()].across[edge.side()] = other;
            nodes[other.node()].across[other.side()] = edge;
        }
    }
    Some(nodes)
}

/// Sides of all faces with three distinct vertices.
struct Sides {
    /// Start of each vertex's rising sides.
    starts: Vec<u32>,
    /// Higher vertex and side of each rising side, grouped by the lower vertex.
    rising: Vec<(VertexId, DualEdge)>,
    /// Falling sides, in the order of the faces.
    falling: Vec<DualEdge>,
}

impl Sides {
    fn new(faces: &[[VertexId; 3]], vertex_count: usize) -> Self {
        let mut starts = vec![0_u32; vertex_count + 1];
        let mut count = 0;
        for [a, b, c] in faces.iter().filter(|face| has_three_corners(face)) {
            starts[a.index()] += u32::from(a < b);
            starts[b.index()] += u32::from(b < c);
            starts[c.index()] += u32::from(c < a);
            count += 3;
        }
        let mut rising_count = 0;
        for start in &mut starts {
            rising_count += *start;
            *start = rising_count;
        }
        let rising = vec![(VertexId(0), DualEdge::NONE); rising_count as usize + 1];
        let falling = vec![DualEdge::NONE; count - rising_count as usize + 1];
        let mut sides = Self { starts, rising, falling };
        sides.fill(faces);
        sides
    }

    /// Writes all sides from the last to the first, because the starts move down from the ends of
    /// their groups. An entry in the wrong list is overwritten later, or lands in the last slot,
    /// which is removed.
    fn fill(&mut self, faces: &[[VertexId; 3]]) {
        let (last_rising, last_falling) = (self.rising.len() - 1, self.falling.len() - 1);
        let mut falls = last_falling;
        for (f, face) in faces.iter().enumerate().rev().filter(|(_, face)| has_three_corners(face))
        {
            for side in [2, 1, 0] {
                let [from, to] = ends(face, side);
                let rises = from < to;
                let start = &mut self.starts[from.index()];
                *start -= u32::from(rises);
                let place = if rises { *start as usize } else { last_rising };
                self.rising[place] = (to, DualEdge::new(f, side));
                falls -= usize::from(!rises);
                let place = if rises { last_falling } else { falls };
                self.falling[place] = DualEdge::new(f, side);
            }
        }
        self.rising.pop();
        self.falling.pop();
    }
}

/// Pairs sides by sorting all of them by edge.
fn sorted(faces: &[[VertexId; 3]]) -> Vec<DualNode> {
    let mut sides = Vec::with_capacity(3 * faces.len());
    for (f, face) in faces.iter().enumerate().filter(|(_, face)| has_three_corners(face)) {
        for side in 0..3 {
            let [from, to] = ends(face, side);
            sides.push((from.min(to), from.max(to), from > to, DualEdge::new(f, side)));
        }
    }
    sides.sort_unstable_by_key(|&(low, high, falls, edge)| (low, high, falls, edge.node()));
    let mut nodes = vec![DualNode::ISOLATED; faces.len()];
    for edge in sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let (rising, falling) = edge.split_at(edge.partition_point(|side| !side.2));
        for (&(.., p), &(.., q)) in rising.iter().zip(falling) {
            nodes[p.node()].across[p.side()] = q;
            nodes[q.node()].across[q.side()] = p;
        }
    }
    nodes
}

/// Returns the vertices a side of a face runs from and to.
#[inline]
pub(crate) fn ends(face: &[VertexId; 3], side: usize) -> [VertexId; 2] {
    [face[side], face[next(side)]]
}

/// Returns the next side of a face.
#[inline]
pub(crate) fn next(side: usize) -> usize {
    if side == 2 { 0 } else { side + 1 }
}

/// Returns the previous side of a face.
#[inline]
pub(crate) fn previous(side: usize) -> usize {
    if side == 0 { 2 } else { side - 1 }
}

#[cfg(test)]
mod tests {
    use meshlod_fixtures::{fan, moebius};
    use meshlod_samples as samples;

    use super::*;

    #[test]
    fn lists_and_sorting_find_the_same() {
        for mesh in [samples::sphere(500), fan(), moebius(9)] {
            let by_lists = pair_by_lists(&mesh.faces, mesh.positions.len());
            assert_eq!(by_lists, Some(sorted(&mesh.faces)));
        }
    }

    #[test]
    fn a_fan_is_left_to_sorting() {
        let blades = 4000;
        let faces: Vec<_> = (0..blades)
            .map(|i| i * 1789 % blades)
            .map(|i| [0, i + 1, (i + 1) % blades + 1].map(VertexId))
            .collect();
        assert_eq!(pair_by_lists(&faces, 4001), None);
        let joined = nodes(&faces)
            .iter()
            .flat_map(|node| node.across)
            .filter(|edge| !edge.is_none())
            .count();
        assert_eq!(joined, 2 * blades as usize);
    }

    #[test]
    fn only_sides_that_run_opposite_are_paired() {
        let faces = [[0, 1, 2], [1, 0, 3], [1, 0, 4], [0, 1, 5], [6, 6, 7], [0, 1, u32::MAX]]
            .map(|face| face.map(VertexId));
        for nodes in [nodes(&faces), pair_by_lists(&faces[..5], 8).unwrap()] {
            let partner =
                |f: usize| Some(nodes[f].across[0]).filter(|p| !p.is_none()).map(DualEdge::node);
            let mut partners = [partner(0), partner(3)];
            partners.sort();
            assert_eq!(partners, [Some(1), Some(2)]);
            assert_eq!(partner(4), None);
            for (f, p) in nodes.iter().enumerate().map(|(f, node)| (f, node.across[0])) {
                assert!(p.is_none() || nodes[p.node()].across[p.side()] == DualEdge::new(f, 0));
            }
        }
    }
}
