//! Which face lies across which side: the dual graph of a list of faces.

use meshlod_mesh::VertexId;

use crate::cover::Port;

/// What lies across the sides of every face: the side of a face that runs along the same edge the other way.
///
/// Any faces are taken. Where an edge has more than two sides, they are paired as far as their directions allow;
/// sides that run the same way are never paired, for no strip can go from one to the other. A face that repeats a
/// vertex has nothing across. Cost: O(n) where the faces of a vertex come near each other, at worst O(n log n).
///
/// Panics above [`Port::MOST_CELLS`] faces.
pub(crate) fn pairs(faces: &[[VertexId; 3]]) -> Vec<[Port; 3]> {
    assert!(faces.len() <= Port::MOST_CELLS, "sides are numbered in 32 bits");
    let most = faces.iter().flatten().max().map_or(0, |v| v.index());
    // A table over vertices that are hardly there is not worth having, and could be any size.
    if most > 8 * faces.len() {
        return sorted_pairs(faces);
    }
    listed_pairs(faces, most + 1).unwrap_or_else(|| sorted_pairs(faces))
}

/// How many rising sides may be looked at for each face, on average, before sorting is the better way. Meshes need 2
/// to 4; fans of thousands need thousands.
const MOST_LOOKS: usize = 64;

/// In two passes: sides that rise to a higher vertex are listed at the lower one, and those that fall look there.
///
/// Which sides rise is as good as random, so nothing branches on it.
fn listed_pairs(faces: &[[VertexId; 3]], vertex_count: usize) -> Option<Vec<[Port; 3]>> {
    let Sides { starts, mut rising, falling } = Sides::new(faces, vertex_count);
    let mut across = vec![[Port::NONE; 3]; faces.len()];
    let mut looks = faces.len() * MOST_LOOKS;
    for port in falling {
        let [from, to] = ends(&faces[port.cell()], port.side());
        let listed = &mut rising[starts[to.index()] as usize..starts[to.index() + 1] as usize];
        let found = listed.iter().position(|rising| rising.0 == from);
        looks = looks.checked_sub(found.map_or(listed.len(), |place| place + 1))?;
        if let Some(place) = found {
            let (_, other) = std::mem::replace(&mut listed[place], (to, Port::NONE));
            across[port.cell()][port.side()] = other;
            across[other.cell()][other.side()] = port;
        }
    }
    Some(across)
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
        let (mut starts, rising_count) = starts(faces, vertex_count);
        let whole_count = faces.iter().filter(|face| whole(face)).count();
        let mut falling = vec![Port::NONE; 3 * whole_count + 1 - rising_count];
        let mut rising = vec![(VertexId(0), Port::NONE); rising_count + 1];
        let mut falls = falling.len() - 1;
        // From the last side to the first, for the starts walk down from their ends. What is not to be written goes
        // to a place that is written over, or to the last, which is cut off.
        for (f, face) in faces.iter().enumerate().rev().filter(|(_, face)| whole(face)) {
            for side in [2, 1, 0] {
                let [from, to] = ends(face, side);
                let rises = from < to;
                let start = &mut starts[from.index()];
                *start -= u32::from(rises);
                let place = if rises { *start as usize } else { rising_count };
                rising[place] = (to, Port::new(f, side));
                falls -= usize::from(!rises);
                let place = if rises { falling.len() - 1 } else { falls };
                falling[place] = Port::new(f, side);
            }
        }
        rising.truncate(rising_count);
        falling.pop();
        Self { starts, rising, falling }
    }
}

/// Where the rising sides of each vertex end, and how many there are.
fn starts(faces: &[[VertexId; 3]], vertex_count: usize) -> (Vec<u32>, usize) {
    let mut starts = vec![0_u32; vertex_count + 1];
    for [a, b, c] in faces.iter().filter(|face| whole(face)) {
        starts[a.index()] += u32::from(a < b);
        starts[b.index()] += u32::from(b < c);
        starts[c.index()] += u32::from(c < a);
    }
    let mut sum = 0;
    for start in &mut starts {
        sum += *start;
        *start = sum;
    }
    (starts, sum as usize)
}

/// The same by sorting all sides by edge.
fn sorted_pairs(faces: &[[VertexId; 3]]) -> Vec<[Port; 3]> {
    let mut sides = Vec::with_capacity(3 * faces.len());
    for (f, face) in faces.iter().enumerate().filter(|(_, face)| whole(face)) {
        for side in 0..3 {
            let [from, to] = ends(face, side);
            sides.push((from.min(to), from.max(to), from > to, Port::new(f, side)));
        }
    }
    sides.sort_unstable_by_key(|&(low, high, falls, port)| (low, high, falls, port.cell()));
    let mut across = vec![[Port::NONE; 3]; faces.len()];
    for edge in sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let (rising, falling) = edge.split_at(edge.partition_point(|side| !side.2));
        for (&(.., p), &(.., q)) in rising.iter().zip(falling) {
            across[p.cell()][p.side()] = q;
            across[q.cell()][q.side()] = p;
        }
    }
    across
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

/// Whether a face has three vertices.
#[inline]
pub(crate) fn whole(face: &[VertexId; 3]) -> bool {
    face[0] != face[1] && face[1] != face[2] && face[2] != face[0]
}

#[cfg(test)]
mod tests {
    use meshlod_fixtures::{fan, moebius};
    use meshlod_mesh::sample;

    use super::*;

    #[test]
    fn lists_and_sorting_find_the_same() {
        for mesh in [sample::sphere(500), fan(), moebius(9)] {
            let listed = listed_pairs(&mesh.faces, mesh.positions.len());
            assert_eq!(listed, Some(sorted_pairs(&mesh.faces)));
        }
    }

    #[test]
    fn a_fan_is_left_to_sorting() {
        let blades = 4000;
        let faces: Vec<_> = (0..blades)
            .map(|i| i * 1789 % blades)
            .map(|i| [0, i + 1, (i + 1) % blades + 1].map(VertexId))
            .collect();
        assert_eq!(listed_pairs(&faces, 4001), None);
        let joined = pairs(&faces).iter().flatten().filter(|port| !port.is_none()).count();
        assert_eq!(joined, 2 * blades as usize);
    }

    #[test]
    fn only_sides_that_run_opposite_are_paired() {
        let faces = [[0, 1, 2], [1, 0, 3], [1, 0, 4], [0, 1, 5], [6, 6, 7], [0, 1, u32::MAX]]
            .map(|face| face.map(VertexId));
        for across in [pairs(&faces), listed_pairs(&faces[..5], 8).unwrap()] {
            let partner = |f: usize| Some(across[f][0]).filter(|p| !p.is_none()).map(Port::cell);
            let mut partners = [partner(0), partner(3)];
            partners.sort();
            assert_eq!(partners, [Some(1), Some(2)]);
            assert_eq!(partner(4), None);
            for (f, p) in across.iter().enumerate().map(|(f, a)| (f, a[0])) {
                assert!(p.is_none() || across[p.cell()][p.side()] == Port::new(f, 0));
            }
        }
    }
}
