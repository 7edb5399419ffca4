//! New edges that are elsewhere already: two coats of a card may both be cut along one diagonal.

use glam::DVec2;
use meshlod_mesh::Mesh;
use robust::{Coord, orient2d};
use rustc_hash::{FxHashMap, FxHashSet};

use crate::flat::NewFace;
use crate::flat::linear::Plane;
use crate::flat::outline::OutlineSide;
use crate::flat::regions::Regions;

/// Faces of all regions, with where each edge is.
struct Faces<'m> {
    mesh: &'m Mesh,
    regions: &'m Regions,
    list: Vec<NewFace>,
    /// Region of each face.
    region: Vec<u32>,
    /// Number of faces at each edge, whose ends are in order; empty while no edge has too many.
    count: FxHashMap<[u32; 2], u32>,
    /// The faces of each region that was filled at each edge: two if it is inside the region.
    at: FxHashMap<([u32; 2], u32), [u32; 2]>,
}

/// Stands for no face.
const NONE: u32 = u32::MAX;

/// Returns the faces of the mesh with its regions filled, region after region. An edge inside a
/// region that would be in another place too is flipped.
///
/// # Errors
/// Regions that have an edge or face which would be there twice.
pub(super) fn take_apart(
    mesh: &Mesh,
    regions: &Regions,
    (filled, sides): (&[Option<Vec<NewFace>>], &[Vec<OutlineSide>]),
) -> Result<Vec<NewFace>, Vec<usize>> {
    let mut faces = Faces::new(mesh, regions, filled);
    let mut together: Vec<usize> =
        faces.crowded(sides).into_iter().flat_map(|edge| faces.part(&edge)).collect();
    together.sort_unstable();
    together.extend(faces.twice(&together));
    together.sort_unstable();
    together.dedup();
    if together.is_empty() { Ok(faces.list) } else { Err(together) }
}

impl<'m> Faces<'m> {
    fn new(mesh: &'m Mesh, regions: &'m Regions, filled: &[Option<Vec<NewFace>>]) -> Self {
        let (mut list, mut region) = (Vec::new(), Vec::new());
        for (r, (old, new)) in regions.list.iter().zip(filled).enumerate() {
            if old.is_kept {
                list.extend(old.faces.iter().map(|&face| NewFace {
                    vertices: mesh.faces[face as usize],
                    wedges: mesh.corner_wedges(face as usize),
                    like: face,
                }));
            } else {
                list.extend(new.iter().flatten());
            }
            region.resize(list.len(), r as u32);
        }
        let (count, at) = Default::default();
        Self { mesh, regions, list, region, count, at }
    }

    fn enter(&mut self, face: u32) {
        let region = self.region[face as usize];
        for ends in edges(&self.list[face as usize]) {
            *self.count.entry(ends).or_default() += 1;
            if self.is_filled(region) {
                let of_region = self.at.entry((ends, region)).or_insert([NONE; 2]);
                of_region[usize::from(of_region[0] != NONE)] = face;
            }
        }
    }

    fn leave(&mut self, face: u32) {
        let region = self.region[face as usize];
        for ends in edges(&self.list[face as usize]) {
            *self.count.entry(ends).or_default() -= 1;
            if let Some(of_region) = self.at.get_mut(&(ends, region)) {
                let [a, b] = *of_region;
                *of_region = [if a == face { b } else { a }, NONE];
            }
        }
    }

    /// Returns the edges of more than two faces that are inside a region that was filled, and not on its
    /// outline, each with all such regions.
    fn crowded(&mut self, sides: &[Vec<OutlineSide>]) -> Vec<([u32; 2], Vec<u32>)> {
        let mut count: FxHashMap<[u32; 2], u32> = FxHashMap::default();
        // Most meshes have few flats, so only their edges are counted.
        for is_filled in [true, false] {
            let faces = self.list.iter().zip(&self.region);
            for (face, _) in faces.filter(|&(_, &r)| self.is_filled(r) == is_filled) {
                for ends in edges(face) {
                    if is_filled {
                        *count.entry(ends).or_default() += 1;
                    } else if let Some(count) = count.get_mut(&ends) {
                        *count += 1;
                    }
                }
            }
        }
        if count.values().all(|&count| count <= 2) {
            return Vec::new();
        }
        (0..self.list.len() as u32).for_each(|face| self.enter(face));
        let is_crowded = |ends: &[u32; 2]| self.count[ends] > 2;
        let inner =
            self.at.iter().filter(|((ends, _), faces)| faces[1] != NONE && is_crowded(ends));
        let mut inner: Vec<([u32; 2], u32)> = inner.map(|(&at, _)| at).collect();
        inner.sort_unstable();
        // Both sides of an outline that touches itself.
        let mut checked: Vec<u32> = inner.iter().map(|&(_, region)| region).collect();
        checked.sort_unstable();
        checked.dedup();
        let sides = checked.into_iter().flat_map(|r| sides[r as usize].iter().map(move |s| (s, r)));
        let ends = |side: &OutlineSide| [side.from.min(side.to).0, side.from.max(side.to).0];
        let outer: FxHashSet<([u32; 2], u32)> = sides.map(|(side, r)| (ends(side), r)).collect();
        inner.retain(|at| !outer.contains(at));
        let of_edge = inner.chunk_by(|a, b| a.0 == b.0);
        of_edge.map(|same| (same[0].0, same.iter().map(|&(_, r)| r).collect())).collect()
    }

    fn is_filled(&self, region: u32) -> bool {
        !self.regions.list[region as usize].is_kept
    }

    /// Flips an edge inside regions until no more than two faces are there. Returns the regions in
    /// which that is not possible.
    fn part(&mut self, (ends, regions): &([u32; 2], Vec<u32>)) -> Vec<usize> {
        let mut left = self.count[ends];
        let mut failed = Vec::new();
        for &region in regions {
            let pair = self.at[&(*ends, region)];
            if left > 2 && pair[1] != NONE {
                if !self.flip(*ends, pair) {
                    failed.push(region as usize);
                }
                left -= 2;
            }
        }
        failed
    }

    /// Flips the edge between two faces if they are a convex quadrilateral, whose other diagonal is
    /// nowhere yet.
    fn flip(&mut self, ends: [u32; 2], [a, b]: [u32; 2]) -> bool {
        let [first, second] = [a, b].map(|face| from_apex(self.list[face as usize], ends));
        let ([first_apex, from, to], [second_apex, ..]) = (first.vertices, second.vertices);
        let other = [first_apex.0.min(second_apex.0), first_apex.0.max(second_apex.0)];
        let is_there = self.count.get(&other).is_some_and(|&count| count > 0);
        let corners = [first_apex, from, second_apex, to];
        let plane = Plane::new(self.regions.list[self.region[a as usize] as usize].normal);
        let places = corners.map(|v| plane.place(self.mesh.positions[v.index()].into()));
        if is_there || first_apex == second_apex || !is_convex(places) {
            return false;
        }
        [a, b].into_iter().for_each(|face| self.leave(face));
        let wedge = [first.wedges[0], first.wedges[1], second.wedges[0], first.wedges[2]];
        let face = |k: [usize; 3]| NewFace {
            vertices: k.map(|k| corners[k]),
            wedges: k.map(|k| wedge[k]),
            like: first.like,
        };
        (self.list[a as usize], self.list[b as usize]) = (face([0, 1, 2]), face([0, 2, 3]));
        [a, b].into_iter().for_each(|face| self.enter(face));
        true
    }

    /// Returns the regions that have new faces with the same corners as another face, but for those that
    /// have failed; of several such regions the first may have it.
    fn twice(&self, failed: &[usize]) -> Vec<usize> {
        let mut sorted: Vec<([u32; 3], bool, u32)> = Vec::with_capacity(self.list.len());
        for (face, &region) in self.list.iter().zip(&self.region) {
            if failed.binary_search(&(region as usize)).is_err() {
                let mut corners = face.vertices.map(|v| v.0);
                corners.sort_unstable();
                sorted.push((corners, self.is_filled(region), region));
            }
        }
        sorted.sort_unstable();
        let same = sorted.chunk_by(|a, b| a.0 == b.0).flat_map(|same| &same[1..]);
        same.filter(|same| same.1).map(|&(.., region)| region as usize).collect()
    }
}

/// Returns the edges of a face, the ends of each in order.
fn edges(face: &NewFace) -> [[u32; 2]; 3] {
    [[0, 1], [1, 2], [2, 0]].map(|[i, j]| {
        let [a, b] = [face.vertices[i].0, face.vertices[j].0];
        [a.min(b), a.max(b)]
    })
}

/// Returns a face that begins with the corner opposite an edge.
fn from_apex(face: NewFace, ends: [u32; 2]) -> NewFace {
    let apex = face.vertices.iter().position(|v| !ends.contains(&v.0)).unwrap_or(0);
    let turn = [apex, (apex + 1) % 3, (apex + 2) % 3];
    NewFace {
        vertices: turn.map(|k| face.vertices[k]),
        wedges: turn.map(|k| face.wedges[k]),
        ..face
    }
}

/// Returns true if every corner of a quadrilateral is a turn to the left.
fn is_convex(places: [DVec2; 4]) -> bool {
    let at = |k: usize| Coord { x: places[k % 4].x, y: places[k % 4].y };
    (0..4).all(|k| orient2d(at(k), at(k + 1), at(k + 2)) > 0.0)
}
