//! Faces as candidates: a proof that the loop does not know what it contracts.

use meshlod_mesh::{Connectivity, FaceId, Mesh, sample};

use crate::candidates::CandidateId;
use crate::checks::FACE_CHECKS;
use crate::contracted::{Contracted, Freedom};
use crate::engine::{Algorithm, Engine, Run};
use crate::level::level;
use crate::neighbourhood::Neighbourhood;
use crate::policy::{Books, Candidates, Memory, Placement, Priority, Stop};
use crate::refusal::Refusal;
use crate::surface::{Placed, Surface};

/// Every face.
struct Faces;

impl Candidates for Faces {
    fn seed(&self, surface: &Surface, _: &Connectivity) -> Vec<CandidateId> {
        (0..surface.face_count())
            .map(FaceId::new)
            .filter(|&face| surface.is_alive(face))
            .map(|face| CandidateId::side(face, 0))
            .collect()
    }

    fn vertices(&self, surface: &Surface, id: CandidateId) -> Contracted {
        Contracted::face(surface.face(id.face()))
    }

    fn settle(&self, hood: &Neighbourhood, books: &mut dyn Books) {
        hood.dying().iter().for_each(|dying| books.close(CandidateId::side(dying.face, 0)));
    }
}

/// Keeps nothing.
struct Memoryless;

impl Memory for Memoryless {
    fn merge(&mut self, _: &Surface, _: &Neighbourhood, _: &Placed) {}
}

/// The smallest face first, to its centroid.
struct Smallest;

impl Priority<Memoryless> for Smallest {
    fn cost(&self, surface: &Surface, _: &Memoryless, of: &Contracted, _: Freedom) -> Option<f64> {
        let [a, b, c] = [of[0], of[1], of[2]].map(|v| surface.position(v));
        Some((b - a).cross(c - a).length())
    }
}

impl Placement<Memoryless> for Smallest {
    fn place(
        &self,
        surface: &Surface,
        _: &Memoryless,
        hood: &Neighbourhood,
    ) -> Result<Placed, Refusal> {
        let corners = hood.contracted().iter().map(|&v| surface.position(v));
        let position = corners.sum::<glam::DVec3>() / 3.0;
        Ok(Placed { position, kept: 0, error_estimate: 0.0 })
    }
}

fn contract_faces(mesh: &Mesh, faces: usize) -> Mesh {
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    let surface = Surface::new(mesh, &connectivity);
    let algorithm = Algorithm {
        candidates: Faces,
        memory: Memoryless,
        priority: Smallest,
        placement: Smallest,
        checks: FACE_CHECKS,
    };
    let mut engine = Engine::new(algorithm, surface, connectivity);
    engine.run(&Stop { faces, ..Stop::NEVER }, &mut ());
    level(mesh, engine.surface())
}

#[test]
fn contracting_faces_keeps_a_closed_surface_closed() {
    for mesh in [sample::sphere(2000), sample::torus(2000), sample::gyroid(2000)] {
        let level = contract_faces(&mesh, mesh.faces.len() / 4);
        let edges = |mesh: &Mesh| Connectivity::new(&mesh.faces, mesh.positions.len());
        let (before, after) = (edges(&mesh), edges(&level));
        assert!(after.is_closed() && after.inconsistent_edges() == 0);
        assert_eq!(after.pinched_vertices(), 0);
        let euler = |mesh: &Mesh, c: &Connectivity| {
            mesh.positions.len() as i64 - c.edge_count() as i64 + mesh.faces.len() as i64
        };
        assert_eq!(euler(&mesh, &before), euler(&level, &after));
        assert!(level.faces.len() <= mesh.faces.len() / 4);
    }
}
