//! Counts, measures and topology of a mesh.

use meshlod::Mesh;
use meshlod::measure::{area, volume};
use meshlod::mesh::{Connectivity, face_components};
use serde::Serialize;

/// Counts, measures and topology of a mesh.
#[derive(Serialize)]
pub struct Counts {
    pub vertices: usize,
    pub faces: usize,
    pub boundary_edges: usize,
    pub non_manifold_edges: usize,
    pub components: usize,
    pub closed: bool,
    /// Genus summed over all components; `None` unless the surface is closed and manifold.
    pub genus: Option<usize>,
    pub diagonal: f64,
    pub area: f64,
    pub volume: f64,
}

impl Counts {
    /// Computes the counts and measures of a mesh, without unused vertices.
    pub fn of(mesh: &Mesh) -> Self {
        let vertices = used(mesh);
        let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
        let components = face_components(&mesh.faces, mesh.positions.len()).1;
        Self {
            vertices,
            faces: mesh.faces.len(),
            boundary_edges: connectivity.boundary_edges(),
            non_manifold_edges: connectivity.non_manifold_edges(),
            components,
            closed: connectivity.is_closed(),
            genus: genus(vertices, mesh.faces.len(), &connectivity, components),
            diagonal: mesh.bounds().diagonal(),
            area: area(mesh),
            volume: volume(mesh),
        }
    }
}

fn used(mesh: &Mesh) -> usize {
    let mut used = vec![false; mesh.positions.len()];
    mesh.faces.iter().flatten().for_each(|v| used[v.index()] = true);
    used.into_iter().filter(|&used| used).count()
}

/// Computes the genus by Euler's formula: vertices - edges + faces = 2 components - 2 genus.
fn genus(
    vertices: usize,
    faces: usize,
    connectivity: &Connectivity,
    components: usize,
) -> Option<usize> {
    let manifold = connectivity.is_closed() && connectivity.pinched_vertices() == 0;
    let doubled = (2 * components + connectivity.edge_count()).checked_sub(vertices + faces)?;
    manifold.then_some(doubled / 2)
}

#[cfg(test)]
mod tests {
    use meshlod::samples;

    use super::*;

    #[test]
    fn a_sphere_has_no_tunnel_and_a_torus_one() {
        let genus = |mesh: Mesh| Counts::of(&mesh).genus;
        assert_eq!(genus(samples::sphere(500)), Some(0));
        assert_eq!(genus(samples::torus(500)), Some(1));
        assert_eq!(genus(samples::terrain(500)), None, "it is open");
    }

    #[test]
    fn a_vertex_that_no_face_uses_makes_no_tunnel() {
        let mut mesh = samples::sphere(500);
        let alone = Counts::of(&mesh).vertices;
        mesh.positions.push([9.0; 3]);
        let counts = Counts::of(&mesh);
        assert_eq!((counts.genus, counts.vertices), (Some(0), alone));
    }
}
