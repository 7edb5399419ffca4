//! Which face lies across which side: the dual graph of a list of faces.

use meshlod_mesh::VertexId;

use crate::cover::{Cell, Port};
use crate::verify::has_three_corners;

/// The faces as cells without links, and what lies across their sides: the side of a face that runs along the
/// same edge the other way.
///
/// Any faces are taken. Where an edge has more than two sides, they are paired as far as their directions allow;
/// sides that run the same way are never paired, for no strip can go from one to the other. A face that repeats a
/// vertex has nothing across. Cost: O(n) where the faces of a vertex come near each other, at worst O(n log n).
///
/// Panics above [`Port::MOST_CELLS`] faces.
pub(crate) fn cells(faces: &[[VertexId; 3]]) -> Vec<Cell> {
    assert!(faces.len() <= Port::MOST_CELLS, "sides are numbered in 32 bits");
    let most = faces.as_flattened().iter().fold(0, |most, v| v.0.max(most)) as usize;
    // A table over vertices that are hardly there is not worth having, and could be any size.
    if most > 8 * faces.len() {
        return sorted(faces);
    }
    listed(faces, most + 1).unwrap_or_else(|| sorted(faces))
}

/// How many rising sides may be looked at for each face, on average, before sorting is the better way. Meshes need 2
/// to 4; fans of thousands need thousands.
const MOST_LOOKS: usize = 64;

/// In two passes: sides that rise to a higher vertex are listed at the lower one, and those that fall look there.
///
/// Which sides rise is as good as random, so nothing branches on it.
fn listed(faces: &[[VertexId; 3]], vertex_count: usize) -> Option<Vec<Cell>> {
    let Sides { starts, mut rising, falling } = Sides::new(faces, vertex_count);
    let mut cells = vec![Cell::ALONE; faces.len()];
    let mut looks = faces.len() * MOST_LOOKS;
    for port in falling {
        let [from, to] = ends(&faces[port.cell()], port.side());
        let list = &mut rising[starts[to.index()] as usize..starts[to.index() + 1] as usize];
        let found = list.iter().position(|rising| rising.0 == from);
        looks = looks.checked_sub(found.map_or(list.len(), |place| place + 1))?;
        if let Some(place) = found {
            let (_, other) = std::mem::replace(&mut list[place], (to, Port::NONE));
            cells[port.cell()].across[port.side()] = other;
            cells[other.cell()].across[other.side()] = port;
        }
    }
    Some(cells)
}

/// The sides of all faces that have three vertices.
struct Sides {
    /// Where the rising sides of each vertex begin.
    starts: Vec<u32>,
    /// Those that run from a lower vertex to a higher one, by the lower: the higher, and the side.
    rising: Vec<(VertexId, Port)>,
    /// The others, in order.
    falling: Vec<Port>,
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
        let rising = vec![(VertexId(0), Port::NONE); rising_count as usize + 1];
        let falling = vec![Port::NONE; count - rising_count as usize + 1];
        let mut sides = Self { starts, rising, falling };
        sides.fill(faces);
        sides
    }

    /// Writes down all sides, from the last to the first, for the starts walk down from their ends. What does not
    /// belong where it is written is written over, or stands at the very end and is taken off.
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
                self.rising[place] = (to, Port::new(f, side));
                falls -= usize::from(!rises);
                let place = if rises { last_falling } else { falls };
                self.falling[place] = Port::new(f, side);
            }
        }
        self.rising.pop();
        self.falling.pop();
    }
}

/// The same by sorting all sides by edge.
fn sorted(faces: &[[VertexId; 3]]) -> Vec<Cell> {
    let mut sides = Vec::with_capacity(3 * faces.len());
    for (f, face) in faces.iter().enumerate().filter(|(_, face)| has_three_corners(face)) {
        for side in 0..3 {
            let [from, to] = ends(face, side);
            sides.push((from.min(to), from.max(to), from > to, Port::new(f, side)));
        }
    }
    sides.sort_unstable_by_key(|&(low, high, falls, port)| (low, high, falls, port.cell()));
    let mut cells = vec![Cell::ALONE; faces.len()];
    for edge in sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let (rising, falling) = edge.split_at(edge.partition_point(|side| !side.2));
        for (&(.., p), &(.., q)) in rising.iter().zip(falling) {
            cells[p.cell()].across[p.side()] = q;
            cells[q.cell()].across[q.side()] = p;
        }
    }
    cells
}

/// The vertices a side of a face runs from and to.
#[inline]
pub(crate) fn ends(face: &[VertexId; 3], side: usize) -> [VertexId; 2] {
    [face[side], face[next(side)]]
}

/// The side after one.
#[inline]
pub(crate) fn next(side: usize) -> usize {
    if side == 2 { 0 } else { side + 1 }
}

/// The side before one.
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
            let by_lists = listed(&mesh.faces, mesh.positions.len());
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
        assert_eq!(listed(&faces, 4001), None);
        let joined = cells(&faces)
            .iter()
            .flat_map(|cell| cell.across)
            .filter(|port| !port.is_none())
            .count();
        assert_eq!(joined, 2 * blades as usize);
    }

    #[test]
    fn only_sides_that_run_opposite_are_paired() {
        let faces = [[0, 1, 2], [1, 0, 3], [1, 0, 4], [0, 1, 5], [6, 6, 7], [0, 1, u32::MAX]]
            .map(|face| face.map(VertexId));
        for cells in [cells(&faces), listed(&faces[..5], 8).unwrap()] {
            let partner =
                |f: usize| Some(cells[f].across[0]).filter(|p| !p.is_none()).map(Port::cell);
            let mut partners = [partner(0), partner(3)];
            partners.sort();
            assert_eq!(partners, [Some(1), Some(2)]);
            assert_eq!(partner(4), None);
            for (f, p) in cells.iter().enumerate().map(|(f, cell)| (f, cell.across[0])) {
                assert!(p.is_none() || cells[p.cell()].across[p.side()] == Port::new(f, 0));
            }
        }
    }
}
