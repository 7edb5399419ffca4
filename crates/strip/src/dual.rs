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
    pairs_in_passing(faces, most + 1).unwrap_or_else(|| sorted_pairs(faces))
}

/// How many sides that wait may be looked at for each face, on average, before sorting is the better way. Meshes in
/// the order of their scanner or of a vertex cache need 4 to 8; fans of thousands in random order need thousands.
const MOST_LOOKS: usize = 64;

/// One pass: each side looks among those that wait at its lower vertex, and waits there if none fits.
///
/// The waiting sides of a vertex are a list, threaded through the places that their own neighbours will stand in.
fn pairs_in_passing(faces: &[[VertexId; 3]], vertex_count: usize) -> Option<Vec<[Port; 3]>> {
    let mut across = vec![[Port::NONE; 3]; faces.len()];
    let mut waiting = vec![Port::NONE; vertex_count];
    let mut looks = faces.len() * MOST_LOOKS;
    for (f, face) in faces.iter().enumerate().filter(|(_, face)| whole(face)) {
        for side in 0..3 {
            let [from, to] = ends(face, side);
            let first = from.min(to).index();
            let mut before = Port::NONE;
            let mut at = waiting[first];
            while !at.is_none() && ends(&faces[at.cell()], at.side()) != [to, from] {
                looks = looks.checked_sub(1)?;
                before = at;
                at = across[at.cell()][at.side()];
            }
            let here = Port::new(f, side);
            if at.is_none() {
                across[f][side] = std::mem::replace(&mut waiting[first], here);
                continue;
            }
            let after = std::mem::replace(&mut across[at.cell()][at.side()], here);
            across[f][side] = at;
            match before.is_none() {
                true => waiting[first] = after,
                false => across[before.cell()][before.side()] = after,
            }
        }
    }
    for mut at in waiting {
        while !at.is_none() {
            at = std::mem::replace(&mut across[at.cell()][at.side()], Port::NONE);
        }
    }
    Some(across)
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
    [face[side], face[(side + 1) % 3]]
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
    fn in_passing_and_by_sorting_find_the_same() {
        for mesh in [sample::sphere(500), fan(), moebius(9)] {
            let passing = pairs_in_passing(&mesh.faces, mesh.positions.len());
            assert_eq!(passing, Some(sorted_pairs(&mesh.faces)));
        }
    }

    #[test]
    fn a_fan_in_bad_order_is_left_to_sorting() {
        let blades = 4000;
        let faces: Vec<_> = (0..blades)
            .map(|i| i * 1789 % blades)
            .map(|i| [0, i + 1, (i + 1) % blades + 1].map(VertexId))
            .collect();
        assert_eq!(pairs_in_passing(&faces, 4001), None);
        let joined = pairs(&faces).iter().flatten().filter(|port| !port.is_none()).count();
        assert_eq!(joined, 2 * blades as usize);
    }

    #[test]
    fn only_sides_that_run_opposite_are_paired() {
        let faces = [[0, 1, 2], [1, 0, 3], [1, 0, 4], [0, 1, 5], [6, 6, 7], [0, 1, u32::MAX]]
            .map(|face| face.map(VertexId));
        for across in [pairs(&faces), pairs_in_passing(&faces[..5], 8).unwrap()] {
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
