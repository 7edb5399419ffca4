//! Splits non-manifold vertices: each fan of faces gets a copy, and all copies stay where they are.
//! In the result they are one vertex again, so the topology is preserved.
//!
//! docs/notes/splitting.md says how this differs from the other splitters and sewers.

use rustc_hash::FxHashMap;

use crate::kernel::setup::vertex_order::is_face;

/// The other two corners of a face, in its orientation.
pub(crate) type Pair = [u32; 2];

/// Corner of a face at a vertex.
#[derive(Clone, Copy)]
struct Corner {
    face: u32,
    corner: usize,
    pair: Pair,
}

/// Gives each fan around the irregular vertices a vertex of its own; the first fan keeps the id. If
/// a vertex has a single fan which is not a ring, each of its faces gets a vertex.
///
/// Returns the vertices that the copies are of. The ids of the copies follow those of all
/// `vertices`.
pub(crate) fn split(faces: &mut [[u32; 3]], irregular: &[u32], vertices: usize) -> Vec<u32> {
    let stars = stars(faces, irregular);
    let mut copied = Vec::new();
    for (&v, star) in irregular.iter().zip(&stars) {
        let mut fans = fans(star);
        if fans.len() == 1 {
            fans = star.iter().map(|&corner| vec![corner]).collect();
        }
        for fan in fans.into_iter().skip(1) {
            let copy = (vertices + copied.len()) as u32;
            copied.push(v);
            for corner in fan {
                faces[corner.face as usize][corner.corner] = copy;
            }
        }
    }
    copied
}

/// Collects the corners of faces at each of these vertices.
fn stars(faces: &[[u32; 3]], of: &[u32]) -> Vec<Vec<Corner>> {
    let place: FxHashMap<u32, usize> = of.iter().enumerate().map(|(i, &v)| (v, i)).collect();
    let mut stars = vec![Vec::new(); of.len()];
    for (f, &[a, b, c]) in faces.iter().enumerate().filter(|(_, face)| is_face(**face)) {
        for (corner, (v, pair)) in [(a, [b, c]), (b, [c, a]), (c, [a, b])].into_iter().enumerate() {
            if let Some(&i) = place.get(&v) {
                stars[i].push(Corner { face: f as u32, corner, pair });
            }
        }
    }
    stars
}

/// Replaces all faces that repeat an earlier one with the same orientation by `[0, 0, 0]`, and
/// returns their number. The corners of such faces are all irregular.
pub(crate) fn drop_duplicates(faces: &mut [[u32; 3]], irregular: &[u32]) -> usize {
    let mut seen = FxHashMap::default();
    let mut count = 0;
    for face in faces.iter_mut() {
        if face.iter().any(|v| irregular.binary_search(v).is_err()) {
            continue;
        }
        let [a, b, c] = *face;
        let turned = [[a, b, c], [b, c, a], [c, a, b]].into_iter().min();
        if is_face(*face) && seen.insert(turned, ()).is_some() {
            *face = [0; 3];
            count += 1;
        }
    }
    count
}

/// Splits the faces at a vertex into fans: faces connected by edges that have one face on either
/// side.
fn fans(star: &[Corner]) -> Vec<Vec<Corner>> {
    let mut from: FxHashMap<u32, Vec<usize>> = FxHashMap::default();
    let mut to: FxHashMap<u32, usize> = FxHashMap::default();
    for (i, corner) in star.iter().enumerate() {
        from.entry(corner.pair[0]).or_default().push(i);
        *to.entry(corner.pair[1]).or_default() += 1;
    }
    let next = |i: usize| match from.get(&star[i].pair[1]).map(Vec::as_slice) {
        Some(&[next]) if to[&star[i].pair[1]] == 1 => Some(next),
        _ => None,
    };
    let mut has_previous = vec![false; star.len()];
    (0..star.len()).filter_map(next).for_each(|i| has_previous[i] = true);
    let mut taken = vec![false; star.len()];
    let mut fans = Vec::new();
    // Open fans from their beginnings, then closed ones from anywhere.
    let beginnings = (0..star.len()).filter(|&i| !has_previous[i]);
    for start in beginnings.chain(0..star.len()) {
        let mut fan = Vec::new();
        let mut at = Some(start);
        while let Some(i) = at.filter(|&i| !taken[i]) {
            taken[i] = true;
            fan.push(star[i]);
            at = next(i);
        }
        if !fan.is_empty() {
            fans.push(fan);
        }
    }
    fans
}
