//! New edges that are elsewhere already: two coats of a card may both be cut along one diagonal.

use glam::DVec2;
use meshlod_mesh::Mesh;
use robust::{Coord, orient2d};
use rustc_hash::FxHashMap;

use crate::flat::NewFace;
use crate::flat::linear::Plane;
use crate::flat::regions::Regions;

/// Faces of all regions, with where each edge is.
struct Faces<'m> {
    mesh: &'m Mesh,
    regions: &'m Regions,
    list: Vec<NewFace>,
    /// Region of each face.
    region: Vec<u32>,
    /// Faces at each edge, whose ends are in order; empty while no edge has too many.
    at: FxHashMap<[u32; 2], Vec<u32>>,
}

/// Returns the faces of the mesh with its regions filled, region after region. An edge inside a
/// region that would be in another place too is flipped.
///
/// # Errors
/// Regions that have an edge or face which would be there twice.
pub(super) fn take_apart(
    mesh: &Mesh,
    regions: &Regions,
    filled: Vec<Vec<NewFace>>,
) -> Result<Vec<NewFace>, Vec<usize>> {
    let mut faces = Faces::new(mesh, regions, filled);
    let mut together: Vec<usize> =
        faces.crowded().into_iter().filter_map(|ends| faces.part(ends)).collect();
    together.extend(faces.twice());
    together.sort_unstable();
    together.dedup();
    if together.is_empty() { Ok(faces.list) } else { Err(together) }
}

impl<'m> Faces<'m> {
    fn new(mesh: &'m Mesh, regions: &'m Regions, filled: Vec<Vec<NewFace>>) -> Self {
        let (mut list, mut region) = (Vec::new(), Vec::new());
        for (r, (old, new)) in regions.list.iter().zip(filled).enumerate() {
            if old.is_kept {
                list.extend(old.faces.iter().map(|&face| NewFace {
                    vertices: mesh.faces[face as usize],
                    wedges: mesh.corner_wedges(face as usize),
                    like: face,
                }));
            } else {
                list.extend(new);
            }
            region.resize(list.len(), r as u32);
        }
        Self { mesh, regions, list, region, at: FxHashMap::default() }
    }

    fn enter(&mut self, face: u32) {
        for ends in edges(&self.list[face as usize]) {
            self.at.entry(ends).or_default().push(face);
        }
    }

    fn leave(&mut self, face: u32) {
        for ends in edges(&self.list[face as usize]) {
            self.at.entry(ends).or_default().retain(|&other| other != face);
        }
    }

    /// Returns the edges of more than two faces, two of which are of a region that was filled.
    fn crowded(&mut self) -> Vec<[u32; 2]> {
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
        let is_crowded = |(ends, count): ([u32; 2], u32)| (count > 2).then_some(ends);
        let mut crowded: Vec<[u32; 2]> = count.into_iter().filter_map(is_crowded).collect();
        if !crowded.is_empty() {
            (0..self.list.len() as u32).for_each(|face| self.enter(face));
        }
        crowded.retain(|&ends| self.inner(ends).is_some());
        crowded.sort_unstable();
        crowded
    }

    fn is_filled(&self, region: u32) -> bool {
        !self.regions.list[region as usize].is_kept
    }

    /// Returns the two faces of a region that was filled at an edge, if there are any.
    fn inner(&self, ends: [u32; 2]) -> Option<[u32; 2]> {
        let faces = &self.at[&ends];
        let is_filled = |face: &&u32| self.is_filled(self.region[**face as usize]);
        faces.iter().filter(is_filled).find_map(|&a| {
            let is_other =
                |b: &&u32| **b != a && self.region[**b as usize] == self.region[a as usize];
            faces.iter().find(is_other).map(|&b| [a, b])
        })
    }

    /// Flips edges at two ends until no more than two faces are there. Returns a region in which that
    /// is not possible.
    fn part(&mut self, ends: [u32; 2]) -> Option<usize> {
        while self.at[&ends].len() > 2
            && let Some(pair) = self.inner(ends)
        {
            if !self.flip(ends, pair) {
                return Some(self.region[pair[0] as usize] as usize);
            }
        }
        None
    }

    /// Flips the edge between two faces if they are a convex quadrilateral, whose other diagonal is
    /// nowhere yet.
    fn flip(&mut self, ends: [u32; 2], [a, b]: [u32; 2]) -> bool {
        let [first, second] = [a, b].map(|face| from_apex(self.list[face as usize], ends));
        let ([first_apex, from, to], [second_apex, ..]) = (first.vertices, second.vertices);
        let other = [first_apex.0.min(second_apex.0), first_apex.0.max(second_apex.0)];
        let is_there = self.at.get(&other).is_some_and(|faces| !faces.is_empty());
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

    /// Returns the regions that have new faces with the same corners as another face.
    fn twice(&self) -> Vec<usize> {
        let mut sorted: Vec<([u32; 3], u32)> = Vec::with_capacity(self.list.len());
        for (face, &region) in self.list.iter().zip(&self.region) {
            let mut corners = face.vertices.map(|v| v.0);
            corners.sort_unstable();
            sorted.push((corners, region));
        }
        sorted.sort_unstable();
        let same = sorted.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() > 1);
        let last = |same: &[([u32; 3], u32)]| {
            let found = same.iter().rfind(|(_, region)| self.is_filled(*region));
            found.map(|&(_, region)| region as usize)
        };
        same.filter_map(last).collect()
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
