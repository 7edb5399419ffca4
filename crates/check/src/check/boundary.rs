//! Boundary loops, traced along the boundary edges.

use std::ops::ControlFlow;

use meshlod_mesh::{Connectivity, Side, Twin, VertexId};

use super::Visit;
use super::subject::Subject;
use crate::finding::Finding;

pub fn loops(subject: &Subject, visit: &mut Visit) -> ControlFlow<()> {
    if subject.connectivity().boundary_edges() == 0 {
        return ControlFlow::Continue(());
    }
    let boundary = Boundary::of(&subject.faces, subject.connectivity());
    for polyline in boundary.sorted_polylines() {
        let vertices = boundary.vertices(polyline).to_vec();
        visit(&Finding::BoundaryLoop { vertices, closed: polyline.closed })?;
    }
    ControlFlow::Continue(())
}

/// The boundary of a mesh, split into polylines that cover each boundary edge once.
pub(crate) struct Boundary {
    vertices: Vec<VertexId>,
    polylines: Vec<BoundaryPolyline>,
}

/// A boundary loop, or a path between non-manifold edges. No vertex occurs twice.
#[derive(Clone, Copy)]
pub(crate) struct BoundaryPolyline {
    start: u32,
    len: u32,
    pub closed: bool,
}

impl BoundaryPolyline {
    /// Returns the number of vertices of the polyline.
    pub fn len(self) -> usize {
        self.len as usize
    }
}

impl Boundary {
    /// Splits the boundary of `faces` into polylines. Cost: linear, however many loops meet in a
    /// vertex.
    pub fn of(faces: &[[VertexId; 3]], connectivity: &Connectivity) -> Self {
        let mut walk = BoundaryWalk::new(faces, connectivity);
        let starts: Vec<VertexId> = (0..walk.reached.len())
            .map(|v| VertexId(v as u32))
            .filter(|&v| connectivity.marks(v).boundary())
            .collect();
        // Paths have ends. Once these are walked, only loops remain.
        if connectivity.non_manifold_edges() > 0 {
            for &start in &starts {
                if walk.is_end(start) {
                    walk.from(start);
                }
            }
        }
        for &start in &starts {
            walk.from(start);
        }
        walk.found
    }

    pub fn vertices(&self, of: BoundaryPolyline) -> &[VertexId] {
        &self.vertices[of.start as usize..][..of.len as usize]
    }

    /// Returns all polylines of the boundary, sorted by their vertices.
    pub fn sorted_polylines(&self) -> Vec<BoundaryPolyline> {
        let mut polylines = self.polylines.clone();
        polylines.sort_by(|&a, &b| self.vertices(a).cmp(self.vertices(b)));
        polylines
    }

    /// Adds a polyline, rotated so that a loop starts at its lowest vertex, or reversed so that a
    /// path starts at its lower end.
    fn add(&mut self, vertices: &[VertexId], closed: bool) {
        let start = self.vertices.len();
        self.vertices.extend_from_slice(vertices);
        let added = &mut self.vertices[start..];
        if closed {
            let lowest = (0..added.len()).min_by_key(|&i| added[i]).unwrap_or(0);
            added.rotate_left(lowest);
        } else if added.first() > added.last() {
            added.reverse();
        }
        let len = vertices.len() as u32;
        self.polylines.push(BoundaryPolyline { start: start as u32, len, closed });
    }
}

/// A walk along the boundary that cuts off a loop whenever it returns to its own path.
struct BoundaryWalk<'a> {
    faces: &'a [[VertexId; 3]],
    connectivity: &'a Connectivity,
    /// Flag per side: true once walked.
    walked: Vec<bool>,
    /// Number of faces of each vertex's star already searched for sides that leave it, and for
    /// sides that arrive. Each star is searched once, however often the walk passes through.
    searched: [Vec<u32>; 2],
    /// Index of each vertex on the path, plus one; 0 if it is not on the path.
    reached: Vec<u32>,
    path: Vec<VertexId>,
    found: Boundary,
}

impl<'a> BoundaryWalk<'a> {
    fn new(faces: &'a [[VertexId; 3]], connectivity: &'a Connectivity) -> Self {
        let vertices = connectivity.vertex_count();
        Self {
            faces,
            connectivity,
            walked: vec![false; faces.len() * 3],
            searched: [vec![0; vertices], vec![0; vertices]],
            reached: vec![0; vertices],
            path: Vec::new(),
            found: Boundary { vertices: Vec::new(), polylines: Vec::new() },
        }
    }

    /// Returns true if an odd number of unwalked boundary edges remains at a vertex.
    fn is_end(&self, vertex: VertexId) -> bool {
        let star = self.connectivity.star(vertex).iter();
        let left = star
            .flat_map(|&face| [0, 1, 2].map(|k| Side::new(face, k)))
            .filter(|side| side.ends(self.faces).contains(&vertex) && self.is_left(*side));
        left.count() % 2 == 1
    }

    fn is_left(&self, side: Side) -> bool {
        self.connectivity.twin(side) == Twin::Boundary
            && !self.walked[side.face().index() * 3 + side.corner()]
    }

    /// Walks from a vertex until no unwalked boundary edge remains there.
    fn from(&mut self, start: VertexId) {
        self.step_to(start);
        while let Some(&at) = self.path.last() {
            if let Some(next) = self.next(at) {
                match self.reached[next.index()] {
                    0 => self.step_to(next),
                    index => self.cut_loop(index as usize - 1),
                }
            } else {
                if self.path.len() > 1 {
                    self.found.add(&self.path, false);
                }
                self.path.drain(..).for_each(|v| self.reached[v.index()] = 0);
            }
        }
    }

    fn step_to(&mut self, vertex: VertexId) {
        self.path.push(vertex);
        self.reached[vertex.index()] = self.path.len() as u32;
    }

    /// Cuts off the loop that the path forms from `index` on.
    fn cut_loop(&mut self, index: usize) {
        self.found.add(&self.path[index..], true);
        self.path.drain(index + 1..).for_each(|v| self.reached[v.index()] = 0);
    }

    /// Takes an unwalked boundary edge at a vertex and returns its other end. Prefers an edge in
    /// the direction of its face; if faces disagree, takes one against it.
    fn next(&mut self, vertex: VertexId) -> Option<VertexId> {
        (0..2).find_map(|arriving| {
            let star = self.connectivity.star(vertex);
            loop {
                let searched = &mut self.searched[arriving][vertex.index()];
                let face = *star.get(*searched as usize)?;
                *searched += 1;
                let k = (0..3).find(|&k| self.faces[face.index()][k] == vertex)?;
                let side = Side::new(face, (k + 2 * arriving) % 3);
                if self.is_left(side) {
                    self.walked[face.index() * 3 + side.corner()] = true;
                    return Some(side.ends(self.faces)[1 - arriving]);
                }
            }
        })
    }
}
