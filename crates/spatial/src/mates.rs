//! Faces that share an edge.

use std::collections::HashMap;

use glam::DVec3;
use meshlod_mesh::{FaceId, Mesh};

use crate::Bvh;

/// For each side of each face of a hierarchy, the side of another face that goes on across it. A
/// side runs along an edge of a face; edges are the same if their ends have the same positions.
///
/// Where more than two faces share an edge, those that go on most straightly are mates, if that
/// holds both ways. Faces with one vertex twice have none.
///
/// Size: 12 bytes a face.
#[derive(Clone, Debug)]
pub struct Mates {
    /// Six times the slots of the hierarchy beyond the sides of each, plus twice the side there, plus
    /// one if that runs the same way. Faces close in space are close in memory.
    of_slot: Vec<[u32; 3]>,
}

/// Face on the other side of an edge, by its slot in the hierarchy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Mate {
    pub(crate) slot: u32,
    /// True if both faces run along the edge in the same direction, so that one is turned over.
    pub(crate) is_turned: bool,
}

/// Stands for no mate.
const NONE: u32 = u32::MAX;

/// Most faces whose sides can be told by 32 bits; more have no mates.
const MOST_FACES: usize = u32::MAX as usize / 6 - 1;

/// Most faces along one edge of which two may be mates.
const MOST_SHARED: usize = 64;

impl Mates {
    /// Finds the mates of the faces of a mesh, given the hierarchy over it.
    ///
    /// Cost: linear, but for vertices with very many faces.
    pub fn new(mesh: &Mesh, surface: &Bvh) -> Self {
        if mesh.faces.len() > MOST_FACES {
            return Self { of_slot: vec![[NONE; 3]; mesh.faces.len()] };
        }
        let sides = 3 * mesh.faces.len() as u32;
        let mut rings = Rings { mesh, next: (0..sides).collect() };
        let all: Vec<u32> = (0..sides).filter(|&side| !has_one_vertex_twice(mesh, side)).collect();
        rings.link(&all, |v| v);
        let is_free = |rings: &Rings<'_>, side: u32| rings.next[side as usize] == side;
        let has_length = |side: u32| {
            let [from, to] = ends(mesh, side).map(|v| bits(mesh, v));
            from != to
        };
        let is_free = |&side: &u32| is_free(&rings, side) && has_length(side);
        let free: Vec<u32> = all.into_iter().filter(is_free).collect();
        if !free.is_empty() {
            let heirs = heirs(mesh, &free);
            rings.link(&free, |v| heirs[&bits(mesh, v)]);
        }
        let in_slots = |mate: u32| match mate {
            NONE => NONE,
            mate => 6 * surface.slots[mate as usize / 6] + mate % 6,
        };
        let of_face = |face: &FaceId| [0, 1, 2].map(|i| in_slots(rings.mate(3 * face.0 + i)));
        Self { of_slot: surface.faces.iter().map(of_face).collect() }
    }

    /// Returns the face that goes on across the side of a face from corner `corner`, if there is
    /// one.
    #[inline]
    pub(crate) fn across(&self, slot: u32, corner: usize) -> Option<Mate> {
        let mate = self.of_slot[slot as usize][corner];
        (mate != NONE).then_some(Mate { slot: mate / 6, is_turned: mate % 2 == 1 })
    }
}

/// Sides along the same edges.
struct Rings<'m> {
    mesh: &'m Mesh,
    /// Next side along the same edge, in a ring.
    next: Vec<u32>,
}

impl Rings<'_> {
    /// Joins sides to rings that have the same ends, given the vertex that stands for each.
    fn link(&mut self, sides: &[u32], heir: impl Fn(u32) -> u32) {
        let vertices = self.mesh.positions.len();
        let ends = |side: u32| {
            let [a, b] = ends(self.mesh, side).map(&heir);
            [a.min(b), a.max(b)]
        };
        // Grouped by the lesser end.
        let mut starts = vec![0u32; vertices + 1];
        sides.iter().for_each(|&side| starts[ends(side)[0] as usize + 1] += 1);
        (0..vertices).for_each(|v| starts[v + 1] += starts[v]);
        let mut fill = starts.clone();
        let mut grouped = vec![[0u32; 2]; sides.len()];
        for &side in sides {
            let [least, other] = ends(side);
            let slot = &mut fill[least as usize];
            grouped[*slot as usize] = [other, side];
            *slot += 1;
        }
        for v in 0..vertices {
            let group = &mut grouped[starts[v] as usize..starts[v + 1] as usize];
            group.sort_unstable();
            for same in group.chunk_by(|a, b| a[0] == b[0]) {
                for (i, &[_, side]) in same.iter().enumerate() {
                    self.next[side as usize] = same[(i + 1) % same.len()][1];
                }
            }
        }
    }

    /// Returns twice the mate of a side, plus one if it runs the same way.
    fn mate(&self, side: u32) -> u32 {
        let pair = self.straightest(side).filter(|&mate| self.straightest(mate) == Some(side));
        pair.map_or(NONE, |mate| 2 * mate + u32::from(self.along(side).dot(self.along(mate)) > 0.0))
    }

    /// Returns the side of the face that goes on most straightly from that of `side`; of several, the
    /// one of the face with the lowest id.
    fn straightest(&self, side: u32) -> Option<u32> {
        let first = self.next[side as usize];
        if first == side || self.next[first as usize] == side {
            return (first != side).then_some(first);
        }
        // Single precision, in which a copy of a face is as straight as the face.
        let own = self.inwards(side);
        let ring = std::iter::successors(Some(first), |&at| Some(self.next[at as usize]));
        let bend = |&at: &u32| own.dot(self.inwards(at)) as f32;
        let others = ring.take_while(|&at| at != side);
        if others.clone().nth(MOST_SHARED).is_some() {
            return None;
        }
        others.min_by(|a, b| bend(a).total_cmp(&bend(b)).then(a.cmp(b)))
    }

    fn along(&self, side: u32) -> DVec3 {
        let [from, to] = ends(self.mesh, side).map(|v| self.mesh.positions[v as usize]);
        DVec3::from(to) - DVec3::from(from)
    }

    /// Returns the direction from a side into its face, at right angles to the side.
    fn inwards(&self, side: u32) -> DVec3 {
        let face = self.mesh.faces[side as usize / 3];
        let at = |i: u32| DVec3::from(self.mesh.positions[face[(i % 3) as usize].index()]);
        let along = self.along(side).normalize_or_zero();
        let way = at(side % 3 + 2) - at(side % 3);
        (way - along * way.dot(along)).normalize_or_zero()
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
