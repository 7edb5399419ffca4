//! Vertices in which faces only touch.

use std::ops::ControlFlow;

use meshlod_mesh::VertexId;

use super::Visit;
use super::subject::Subject;
use crate::finding::Finding;
use crate::joined::Joined;

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
    joined: Joined,
}

impl Fans {
    /// How many fans the faces of `vertex` form. Cost: k log k, k = faces.
    fn count(&mut self, subject: &Subject, vertex: VertexId) -> usize {
        let star = subject.connectivity().star(vertex);
        self.spokes.clear();
        self.joined.reset(star.len());
        for (place, face) in (0..).zip(star) {
            let others = subject.faces[face.index()].into_iter().filter(|&v| v != vertex);
            self.spokes.extend(others.map(|v| (v, place)));
        }
        self.spokes.sort_unstable();
        let mut count = star.len();
        for i in 1..self.spokes.len() {
            let (a, b) = (self.spokes[i - 1], self.spokes[i]);
            count -= usize::from(a.0 == b.0 && self.joined.join(a.1, b.1));
        }
        count
    }
}
