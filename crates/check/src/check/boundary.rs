//! Boundary loops: a walk over the edges of one face.

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
    for line in boundary.lines_in_order() {
        let vertices = boundary.vertices(line).to_vec();
        visit(&Finding::BoundaryLoop { vertices, closed: line.closed })?;
    }
    ControlFlow::Continue(())
}

/// The boundary of a mesh, taken apart into lines: each edge of one face is in one of them.
pub(crate) struct Boundary {
    vertices: Vec<VertexId>,
    lines: Vec<Line>,
}

/// A loop, or a path between non-manifold edges. No vertex comes twice.
#[derive(Clone, Copy)]
pub(crate) struct Line {
    start: u32,
    len: u32,
    pub closed: bool,
}

impl Line {
    /// How many vertices it has.
    pub fn len(self) -> usize {
        self.len as usize
    }
}

impl Boundary {
    /// Takes the boundary of `faces` apart. Cost: linear, however many loops meet in a vertex.
    pub fn of(faces: &[[VertexId; 3]], connectivity: &Connectivity) -> Self {
        let mut walk = Walk::new(faces, connectivity);
        let starts: Vec<VertexId> = (0..walk.reached.len())
            .map(|v| VertexId(v as u32))
            .filter(|&v| connectivity.marks(v).boundary())
            .collect();
        // Paths have ends. Once these are walked, only loops are left.
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

    pub fn vertices(&self, line: Line) -> &[VertexId] {
        &self.vertices[line.start as usize..][..line.len as usize]
    }

    /// Every line, by its vertices.
    pub fn lines_in_order(&self) -> Vec<Line> {
        let mut lines = self.lines.clone();
        lines.sort_by(|&a, &b| self.vertices(a).cmp(self.vertices(b)));
        lines
    }

    /// Keeps a line, turned so that the lowest vertex of a loop, or the lower end of a path, is
    /// first.
    fn keep(&mut self, vertices: &[VertexId], closed: bool) {
        let start = self.vertices.len();
        self.vertices.extend_from_slice(vertices);
        let line = &mut self.vertices[start..];
        if closed {
            let lowest = (0..line.len()).min_by_key(|&i| line[i]).unwrap_or(0);
            line.rotate_left(lowest);
        } else if line.first() > line.last() {
            line.reverse();
        }
        self.lines.push(Line { start: start as u32, len: vertices.len() as u32, closed });
    }
}

/// A walk along the boundary that cuts off a loop whenever it comes back to itself.
struct Walk<'a> {
    faces: &'a [[VertexId; 3]],
    connectivity: &'a Connectivity,
    /// Which sides were walked.
    walked: Vec<bool>,
    /// How far the star of each vertex is searched for sides that leave it, and that arrive: every
    /// star is searched once, however often the walk comes through.
    searched: [Vec<u32>; 2],
    /// One more than the place of each vertex on the path; 0 where it is not on it.
    reached: Vec<u32>,
    path: Vec<VertexId>,
    found: Boundary,
}

impl<'a> Walk<'a> {
    fn new(faces: &'a [[VertexId; 3]], connectivity: &'a Connectivity) -> Self {
        let vertices = connectivity.vertex_count();
        Self {
            faces,
            connectivity,
            walked: vec![false; faces.len() * 3],
            searched: [vec![0; vertices], vec![0; vertices]],
            reached: vec![0; vertices],
            path: Vec::new(),
            found: Boundary { vertices: Vec::new(), lines: Vec::new() },
        }
    }

    /// Whether an odd number of boundary edges is left there.
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

    /// Walks from a vertex until no way is left there.
    fn from(&mut self, start: VertexId) {
        self.step_to(start);
        while let Some(&at) = self.path.last() {
            if let Some(next) = self.next(at) {
                match self.reached[next.index()] {
                    0 => self.step_to(next),
                    place => self.cut_loop(place as usize - 1),
                }
            } else {
                if self.path.len() > 1 {
                    self.found.keep(&self.path, false);
                }
                self.path.drain(..).for_each(|v| self.reached[v.index()] = 0);
            }
        }
    }

    fn step_to(&mut self, vertex: VertexId) {
        self.path.push(vertex);
        self.reached[vertex.index()] = self.path.len() as u32;
    }

    /// The path from `place` on, which is back there now, is a loop.
    fn cut_loop(&mut self, place: usize) {
        self.found.keep(&self.path[place..], true);
        self.path.drain(place + 1..).for_each(|v| self.reached[v.index()] = 0);
    }

    /// Takes a boundary edge at a vertex and gives its other end. Along its face where there is
    /// such an edge, against it where faces disagree.
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
