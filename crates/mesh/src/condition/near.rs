//! Borders that lie near each other without lying on each other.

use crate::condition::pairing;
use crate::condition::stitch::{Places, lie_on_each_other};
use crate::condition::suspects::{Around, unbalanced};
use crate::{Connectivity, Mesh, Side};

/// Boundary edges of a mesh, and how many of them a small distance keeps apart from others.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct NearBorders {
    /// Distance between the ends of edges, in model units.
    pub distance: f64,
    /// Number of boundary edges of the mesh.
    pub boundary_edges: usize,
    /// Number of boundary edges that another boundary edge is within the distance of, so that
    /// welding by the distance would join the two.
    pub near_edges: usize,
}

impl NearBorders {
    /// Adds the edges of another mesh, found at the same distance.
    pub fn add(&mut self, other: &Self) {
        self.boundary_edges += other.boundary_edges;
        self.near_edges += other.near_edges;
    }
}

/// Counts the boundary edges of a mesh that lie near each other, for each of some distances.
///
/// Edges are near if their ends are, each to the other's, and they run in opposite directions.
///
/// Cost: linear in the size of the mesh; O(n log n) per distance, n = boundary edges.
/// # Panics
/// If the mesh is not valid, see [`Mesh::validate`].
pub fn near_borders(mesh: &Mesh, distances: &[f64]) -> Vec<NearBorders> {
    let around = Around::new(mesh, &unbalanced(mesh));
    let mesh = &around.mesh;
    let border = around.border(&Connectivity::new(&mesh.faces, mesh.positions.len()));
    let at = |&distance: &f64| {
        let places = Places::new(mesh, &border, distance);
        let may_meet = |a: Side, b: Side| lie_on_each_other(mesh, &places, a, b);
        let edges = places.by_edge(mesh, &border);
        let pairs: usize = edges.iter().map(|edge| pairing::pair(mesh, edge, may_meet).len()).sum();
        NearBorders { distance, boundary_edges: border.len(), near_edges: 2 * pairs }
    };
    distances.iter().map(at).collect()
}
