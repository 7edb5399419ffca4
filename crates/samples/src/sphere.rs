//! Sample mesh of a geodesic sphere.

use glam::DVec3;
use meshlod_mesh::{Mesh, VertexId};

/// Builds a geodesic unit sphere: an icosahedron with every face split into n², projected onto the
/// sphere.
///
/// Faces: 20 n² with the closest n, off by at most about one part in n; at least 20.
pub fn sphere(faces: usize) -> Mesh {
    let n = (faces as f64 / 20.0).sqrt().round().max(1.0) as usize;
    let corners = icosahedron();
    let mut growth = Growth { n, corners, edges: Vec::with_capacity(30), mesh: Mesh::default() };
    growth.mesh.positions.extend(corners.map(<[f64; 3]>::from));
    for face in ICOSAHEDRON_FACES {
        growth.split(face);
    }
    growth.mesh
}

/// Corners of the icosahedron's faces, counter-clockwise from outside.
#[rustfmt::skip]
const ICOSAHEDRON_FACES: [[usize; 3]; 20] = [
    [0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11],
    [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6], [7, 1, 8],
    [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9],
    [4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1],
];

/// Returns the corners of the icosahedron: three golden rectangles, one in each coordinate plane.
fn icosahedron() -> [DVec3; 12] {
    let g = (1.0 + 5f64.sqrt()) / 2.0;
    let flat = [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)];
    let mut corners = [DVec3::ZERO; 12];
    for (i, (s, t)) in flat.into_iter().enumerate() {
        corners[i] = DVec3::new(s, t, 0.0).normalize();
        corners[i + 4] = DVec3::new(0.0, s, t).normalize();
        corners[i + 8] = DVec3::new(t, 0.0, s).normalize();
    }
    corners
}

/// The sphere while it is built: corners first, then edges and interiors, face by face.
struct Growth {
    n: usize,
    corners: [DVec3; 12],
    /// Two corners, the least first, and the first of the n − 1 vertices between them.
    edges: Vec<([usize; 2], usize)>,
    mesh: Mesh,
}

impl Growth {
    /// Adds the n² parts of one face of the icosahedron, row by row from its first corner.
    fn split(&mut self, [a, b, c]: [usize; 3]) {
        let mut above = vec![VertexId::new(a)];
        for row in 1..=self.n {
            let below = self.row([a, b, c], row);
            for i in 0..row {
                self.mesh.faces.push([above[i], below[i], below[i + 1]]);
                if i + 1 < row {
                    self.mesh.faces.push([above[i], below[i + 1], above[i + 1]]);
                }
            }
            above = below;
        }
    }

    /// Returns the `row + 1` vertices of a row, from side ab to side ac.
    fn row(&mut self, [a, b, c]: [usize; 3], row: usize) -> Vec<VertexId> {
        let mut ids = vec![self.on_edge(a, b, row)];
        for i in 1..row {
            ids.push(if row == self.n {
                self.on_edge(b, c, i)
            } else {
                let [a, b, c] = [a, b, c].map(|corner| self.corners[corner]);
                let point = a * (self.n - row) as f64 + b * (row - i) as f64 + c * i as f64;
                self.add(point)
            });
        }
        ids.push(self.on_edge(a, c, row));
        ids
    }

    /// Returns the vertex `step` of n steps from corner `a` to corner `b`.
    fn on_edge(&mut self, a: usize, b: usize, step: usize) -> VertexId {
        if step == 0 || step == self.n {
            return VertexId::new(if step == 0 { a } else { b });
        }
        if a > b {
            return self.on_edge(b, a, self.n - step);
        }
        let known = self.edges.iter().find(|(ends, _)| *ends == [a, b]).map(|&(_, first)| first);
        let first = known.unwrap_or_else(|| self.add_edge(a, b));
        VertexId::new(first + step - 1)
    }

    /// Adds the vertices between two corners; returns the index of the first.
    fn add_edge(&mut self, a: usize, b: usize) -> usize {
        let first = self.mesh.positions.len();
        self.edges.push(([a, b], first));
        for step in 1..self.n {
            self.add(self.corners[a] * (self.n - step) as f64 + self.corners[b] * step as f64);
        }
        first
    }

    fn add(&mut self, direction: DVec3) -> VertexId {
        self.mesh.positions.push(direction.normalize().into());
        VertexId::new(self.mesh.positions.len() - 1)
    }
}
