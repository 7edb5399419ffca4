//! Faces that share an edge.

use std::collections::HashMap;

use glam::DVec3;
use meshlod_mesh::{FaceId, Mesh};

/// For each side of each face, the sides of other faces along the same edge. Edges are the same if
/// their ends have the same positions. Faces with two corners at one vertex have no edges.
#[derive(Clone, Debug)]
pub(crate) struct Mates {
    /// Next side along the same edge, in a ring; `3 * face + i` is the side from corner `i`.
    next: Vec<u32>,
}

/// Face on the other side of an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mate {
    pub(crate) face: FaceId,
    /// True if both faces run along the edge in the same direction, so that one is turned over.
    pub(crate) is_turned: bool,
}

impl Mates {
    /// Finds the faces that share edges.
    ///
    /// Cost: linear, but for vertices with many faces. Size: 12 bytes a face.
    pub(crate) fn new(mesh: &Mesh) -> Self {
        let sides = 3 * mesh.faces.len() as u32;
        let mut next: Vec<u32> = (0..sides).collect();
        let all: Vec<u32> = (0..sides).filter(|&side| !has_one_vertex_twice(mesh, side)).collect();
        link(&all, mesh.positions.len(), |side| ends(mesh, side), &mut next);
        let free: Vec<u32> = all.into_iter().filter(|&side| next[side as usize] == side).collect();
        if !free.is_empty() {
            let heir = heirs(mesh, &free);
            let of = |v: u32| heir.get(&bits(mesh, v)).copied().unwrap_or(v);
            link(&free, mesh.positions.len(), |side| ends(mesh, side).map(of), &mut next);
        }
        Self { next }
    }

    /// Returns the face that goes on across a side of another; of several, the one that goes on most
    /// straightly, if that holds both ways.
    pub(crate) fn across(&self, mesh: &Mesh, side: u32) -> Option<Mate> {
        let mate = self.straightest(mesh, side)?;
        let is_pair =
            self.next[mate as usize] == side || self.straightest(mesh, mate) == Some(side);
        let along = |side: u32| {
            let [from, to] = ends(mesh, side).map(|v| DVec3::from(mesh.positions[v as usize]));
            to - from
        };
        is_pair
            .then(|| Mate { face: FaceId(mate / 3), is_turned: along(side).dot(along(mate)) > 0.0 })
    }

    fn straightest(&self, mesh: &Mesh, side: u32) -> Option<u32> {
        let first = self.next[side as usize];
        if first == side || self.next[first as usize] == side {
            return (first != side).then_some(first);
        }
        let own = inwards(mesh, side);
        let ring = std::iter::successors(Some(first), |&at| Some(self.next[at as usize]));
        let others = ring.take_while(|&at| at != side);
        let bend = |&at: &u32| own.dot(inwards(mesh, at));
        others.min_by(|a, b| bend(a).total_cmp(&bend(b)))
    }
}

/// Returns the vertices of a side.
fn ends(mesh: &Mesh, side: u32) -> [u32; 2] {
    let face = mesh.faces[side as usize / 3];
    let i = side as usize % 3;
    [face[i].0, face[(i + 1) % 3].0]
}

fn has_one_vertex_twice(mesh: &Mesh, side: u32) -> bool {
    let [a, b, c] = mesh.faces[side as usize / 3];
    a == b || b == c || c == a
}

/// Returns the direction from a side into its face, at right angles to the side.
fn inwards(mesh: &Mesh, side: u32) -> DVec3 {
    let face = mesh.faces[side as usize / 3];
    let at = |i: u32| DVec3::from(mesh.positions[face[(i % 3) as usize].index()]);
    let i = side % 3;
    let along = (at(i + 1) - at(i)).normalize_or_zero();
    let way = at(i + 2) - at(i);
    (way - along * way.dot(along)).normalize_or_zero()
}

/// Bits of a position, the same for 0 and -0.
fn bits(mesh: &Mesh, v: u32) -> [u64; 3] {
    mesh.positions[v as usize].map(|x| (x + 0.0).to_bits())
}

/// Returns the vertex that stands for each position at the ends of some sides.
fn heirs(mesh: &Mesh, sides: &[u32]) -> HashMap<[u64; 3], u32> {
    let mut heirs = HashMap::new();
    for v in sides.iter().flat_map(|&side| ends(mesh, side)) {
        heirs.entry(bits(mesh, v)).or_insert(v);
    }
    heirs
}

/// Joins the sides that have the same ends to rings.
fn link(sides: &[u32], vertices: usize, ends: impl Fn(u32) -> [u32; 2], next: &mut [u32]) {
    let sorted = |side: u32| {
        let [a, b] = ends(side);
        [a.min(b), a.max(b)]
    };
    // Grouped by the lesser end, in the order of the sides.
    let mut starts = vec![0u32; vertices + 1];
    sides.iter().for_each(|&side| starts[sorted(side)[0] as usize + 1] += 1);
    (0..vertices).for_each(|v| starts[v + 1] += starts[v]);
    let mut fill = starts.clone();
    let mut grouped = vec![[0u32; 2]; sides.len()];
    for &side in sides {
        let [least, other] = sorted(side);
        let slot = &mut fill[least as usize];
        grouped[*slot as usize] = [other, side];
        *slot += 1;
    }
    for v in 0..vertices {
        let group = &mut grouped[starts[v] as usize..starts[v + 1] as usize];
        group.sort_unstable();
        for same in group.chunk_by(|a, b| a[0] == b[0]) {
            for (i, &[_, side]) in same.iter().enumerate() {
                next[side as usize] = same[(i + 1) % same.len()][1];
            }
        }
    }
}
