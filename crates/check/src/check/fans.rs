//! Finds non-manifold vertices: those whose faces form more than one fan.

use std::ops::ControlFlow;

use meshlod_mesh::{UnionFind, VertexId};

use super::Visit;
use super::subject::Subject;
use crate::finding::Finding;

pub fn non_manifold_vertices(subject: &Subject, visit: &mut Visit) -> ControlFlow<()> {
    let mut fans = Fans::default();
    for vertex in (0..subject.mesh.positions.len()).map(|v| VertexId(v as u32)) {
        // Connectivity treats the faces of a non-manifold edge as unconnected, so it marks a
        // superset of these vertices.
        if subject.connectivity().marks(vertex).pinched() {
            let fans = fans.count(subject, vertex);
            if fans > 1 {
                visit(&Finding::NonManifoldVertex { vertex, fans })?;
            }
        }
    }
    ControlFlow::Continue(())
}

/// Counts the fans of a vertex by union-find over its faces.
#[derive(Default)]
struct Fans {
    /// Two spokes for each face of the star: a neighbour vertex and the index of the face in the
    /// star.
    spokes: Vec<(VertexId, u32)>,
    sets: UnionFind,
}

impl Fans {
    /// Returns the number of fans that the faces of `vertex` form. Cost: O(k log k), k = faces.
    fn count(&mut self, subject: &Subject, vertex: VertexId) -> usize {
        let star = subject.connectivity().star(vertex);
        self.spokes.clear();
        self.sets.reset(star.len());
        for (index, face) in (0..).zip(star) {
            let others = subject.faces[face.index()].into_iter().filter(|&v| v != vertex);
            self.spokes.extend(others.map(|v| (v, index)));
        }
        self.spokes.sort_unstable();
        let mut count = star.len();
        for i in 1..self.spokes.len() {
            let (a, b) = (self.spokes[i - 1], self.spokes[i]);
            count -= usize::from(a.0 == b.0 && self.sets.union(a.1, b.1));
        }
        count
    }
}
