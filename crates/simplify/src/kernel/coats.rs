//! Fronts and their backs: components that lie on each other and face away from each other.
//!
//! Without its back a leaf cannot be seen from behind, though no point of it is any farther from
//! the surface. So a component is not measured against its other coat.

use glam::Vec3;
use rustc_hash::FxHashMap;

/// Sums over a component that say whether another is its other coat.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Imprint {
    places: u64,
    faces: u32,
    /// Sum over the sides of all faces that changes its sign with their direction: that of the
    /// boundary, as inner edges cancel out.
    boundary: u64,
    /// Sum over the faces that changes its sign with their direction.
    turns: u64,
}

impl Imprint {
    /// Returns the imprint of vertices and the faces over them.
    pub(crate) fn of(vertices: &[u32], faces: &[[u32; 3]], place: impl Fn(u32) -> Vec3) -> Self {
        let of_vertex = |v: u32| hash(place(v));
        let places = vertices.iter().map(|&v| of_vertex(v)).fold(0, u64::wrapping_add);
        let mut imprint = Self { places, faces: faces.len() as u32, ..Self::default() };
        for &[a, b, c] in faces {
            let corners = [of_vertex(a), of_vertex(b), of_vertex(c)];
            let [ab, bc, ca] = [0, 1, 2].map(|i| side(corners[i], corners[(i + 1) % 3]));
            let [ba, cb, ac] = [0, 1, 2].map(|i| side(corners[(i + 1) % 3], corners[i]));
            let [there, back] = [[ab, bc, ca], [ba, cb, ac]].map(sum);
            imprint.boundary = imprint.boundary.wrapping_add(there).wrapping_sub(back);
            imprint.turns = imprint.turns.wrapping_add(mix(there)).wrapping_sub(mix(back));
        }
        imprint
    }

    /// Returns what both coats have in common, and what tells them apart: opposite numbers, or zero
    /// for what has no direction. Surfaces with a boundary may be divided into faces differently.
    fn split(&self) -> ((u64, u32, bool), u64) {
        let is_open = self.boundary != 0;
        let direction = if is_open { self.boundary } else { self.turns };
        ((self.places, self.faces, is_open), direction)
    }
}

/// Returns the other coat of each component, if it has one. Each is the coat of at most one other.
pub(crate) fn pair(imprints: &[Imprint]) -> Vec<Option<u32>> {
    let mut coats = vec![None; imprints.len()];
    let mut alone: FxHashMap<_, Vec<u32>> = FxHashMap::default();
    for (i, imprint) in (0..).zip(imprints) {
        let (common, direction) = imprint.split();
        if direction == 0 {
            continue;
        }
        let opposite = alone.get_mut(&(common, direction.wrapping_neg()));
        match opposite.and_then(Vec::pop) {
            Some(other) => {
                coats[i as usize] = Some(other);
                coats[other as usize] = Some(i);
            }
            None => alone.entry((common, direction)).or_default().push(i),
        }
    }
    coats
}

fn hash(place: Vec3) -> u64 {
    // Zero has two signs.
    let [x, y, z] = (place + Vec3::ZERO).to_array().map(|c| u64::from(c.to_bits()));
    mix(mix(mix(x) ^ y) ^ z)
}

fn side(from: u64, to: u64) -> u64 {
    mix(from.rotate_left(1) ^ to)
}

fn sum(sides: [u64; 3]) -> u64 {
    sides.into_iter().fold(0, u64::wrapping_add)
}

fn mix(x: u64) -> u64 {
    let x = (x ^ x >> 32).wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    x ^ x >> 29
}

#[cfg(test)]
mod tests {
    use super::*;

    fn imprint(faces: &[[u32; 3]], shift: f32) -> Imprint {
        let place = |v: u32| Vec3::new((v % 2) as f32 + shift, (v / 2) as f32, -0.0);
        Imprint::of(&[0, 1, 2, 3], faces, place)
    }

    #[test]
    fn the_back_of_a_square_is_its_coat_and_a_copy_is_not() {
        let front = imprint(&[[0, 1, 3], [0, 3, 2]], 0.0);
        let back = imprint(&[[3, 1, 0], [2, 3, 0]], 0.0);
        let other_diagonal = imprint(&[[1, 0, 2], [3, 1, 2]], 0.0);
        let beside = imprint(&[[3, 1, 0], [2, 3, 0]], 1.0);
        assert_eq!(pair(&[front, beside, back]), [Some(2), None, Some(0)]);
        assert_eq!(pair(&[front, front, back, back]), [3, 2, 1, 0].map(Some));
        assert_eq!(pair(&[front, other_diagonal]), [1, 0].map(Some));
    }

    #[test]
    fn closed_surfaces_have_coats_by_their_faces() {
        let shell = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
        let place = |v: u32| Vec3::new((v == 1).into(), (v == 2).into(), (v == 3).into());
        let inside_out = shell.map(|[a, b, c]| [a, c, b]);
        let [front, back] =
            [shell, inside_out].map(|faces| Imprint::of(&[0, 1, 2, 3], &faces, place));
        assert_eq!(pair(&[front, back]), [1, 0].map(Some));
        assert_eq!(pair(&[front, front]), [None; 2]);
    }
}
