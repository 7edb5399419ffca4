//! Vertices in which faces only touch.

use std::ops::ControlFlow;

use meshlod_mesh::VertexId;

use super::Visit;
use super::subject::Subject;
use crate::finding::Finding;

pub fn non_manifold_vertices(subject: &Subject, visit: &mut Visit) -> ControlFlow<()> {
    let mut fans = Fans::default();
    for vertex in (0..subject.mesh.positions.len()).map(|v| VertexId(v as u32)) {
        // Connectivity counts the faces of an edge of three or more apart, so that it marks these
        // vertices and maybe others.
        if subject.connectivity().marks(vertex).pinched() {
            let fans = fans.count(subject, vertex);
            if fans > 1 {
                visit(&Finding::NonManifoldVertex { vertex, fans })?;
            }
        }
    }
    ControlFlow::Continue(())
}

/// Counts the fans of a vertex: a union-find over its faces.
#[derive(Default)]
struct Fans {
    /// Two for each face of the star: a neighbour, and the place of the face in the star.
    spokes: Vec<(VertexId, u32)>,
    parents: Vec<u32>,
}

impl Fans {
    /// How many fans the faces of `vertex` form. Cost: k log k, k = faces.
    fn count(&mut self, subject: &Subject, vertex: VertexId) -> usize {
        let star = subject.connectivity().star(vertex);
        self.spokes.clear();
        self.parents.clear();
        for (place, face) in (0..).zip(star) {
            let others = subject.faces[face.index()].into_iter().filter(|&v| v != vertex);
            self.spokes.extend(others.map(|v| (v, place)));
            self.parents.push(place);
        }
        self.spokes.sort_unstable();
        let mut count = star.len();
        for i in 1..self.spokes.len() {
            let (a, b) = (self.spokes[i - 1], self.spokes[i]);
            count -= usize::from(a.0 == b.0 && self.join(a.1, b.1));
        }
        count
    }

    /// False where they are one already.
    fn join(&mut self, a: u32, b: u32) -> bool {
        let (a, b) = (self.root(a), self.root(b));
        self.parents[a.max(b) as usize] = a.min(b);
        a != b
    }

    fn root(&mut self, mut i: u32) -> u32 {
        while self.parents[i as usize] != i {
            self.parents[i as usize] = self.parents[self.parents[i as usize] as usize];
            i = self.parents[i as usize];
        }
        i
    }
}
