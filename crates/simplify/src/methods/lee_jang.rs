//! Face constriction that conserves the volume [LJ05].

use glam::DVec3;

use crate::engine::Algorithm;
use crate::engine::candidates::FaceAndEdgeCandidates;
use crate::engine::policy::Placement;
use crate::engine::prepared_surface::PreparedSurface;
use crate::methods::creases::{Creases, Turns};
use crate::methods::face_order::FaceOrder;
use crate::methods::lindstrom_turk;
use crate::methods::volume::{VolumePlane, old_faces};
use crate::refusal::Refusal;
use crate::run::Run;
use crate::surface::contracted::Freedom;
use crate::surface::neighbourhood::Neighbourhood;
use crate::surface::{Placed, Surface};

/// Largest deviation of the ratio of the volumes from 1. Beyond it the face is postponed and its
/// shortest edge becomes a candidate. Mean error of bunny and igea at 10 %: 0.5 .0430, .0141; 0.1
/// .0387, .0134; 0.05 .0333, .0116; 0.02 .0268, .0092. But at 0.05 every third candidate is
/// refused, and at 0.02 most are, which leaves a method for edges.
const MOST_STRETCH: f64 = 0.1;

/// Starts the method.
pub(super) fn start(ready: PreparedSurface) -> Box<dyn Run> {
    let surface = &ready.surface;
    Algorithm {
        candidates: FaceAndEdgeCandidates,
        memory: Creases::new(surface, weight),
        priority: FaceOrder::new(surface),
        placement: Constriction,
    }
    .start(ready)
}

/// M: weight of a vertex by its least typical edge (eq. 5), so that a vertex whose edges are all
/// alike, such as the tip of a pyramid, still counts.
fn weight(turns: &Turns) -> f64 {
    turns.farthest.exp()
}

/// Placement at the centroid, moved along the line from a point below the surface until the volume
/// is conserved (eqs. 8 to 12).
struct Constriction;

impl Placement<Creases> for Constriction {
    fn place(
        &self,
        surface: &Surface,
        creases: &Creases,
        neighbourhood: &Neighbourhood,
    ) -> Result<Placed, Refusal> {
        match (neighbourhood.freedom(), neighbourhood.contracted().len()) {
            (Freedom::Free, 3) => constrict(surface, creases, neighbourhood),
            _ => lindstrom_turk::place(surface, neighbourhood),
        }
    }
}

fn constrict(
    surface: &Surface,
    creases: &Creases,
    neighbourhood: &Neighbourhood,
) -> Result<Placed, Refusal> {
    let corners = [0, 1, 2].map(|i| surface.position(neighbourhood.contracted()[i]));
    let [a, b, c] = corners;
    let centroid = (a + b + c) / 3.0;
    let depth = (a.distance(b) + b.distance(c) + c.distance(a)) / 2.0;
    let inward = direction(creases, neighbourhood, (b - a).cross(c - a).normalize_or_zero());
    let base = centroid - depth * inward;
    let mut volume = VolumePlane::default();
    let mut seen = true;
    old_faces(surface, neighbourhood, base, |normal, corner| {
        volume.add(normal, corner);
        seen &= normal.dot(corner) >= 0.0;
    });
    let k = volume.level / volume.normal.dot(depth * inward);
    // Written so that NaN is refused.
    if !(seen && (k - 1.0).abs() <= MOST_STRETCH) {
        return Err(Refusal::Volume);
    }
    let position = base + k * depth * inward;
    Ok(Placed { position, kept: 0, error_estimate: 0.0 })
}

/// Returns the mean outward direction of the patch: the face's normal, plus each other normal
/// weighted by its difference (eq. 10).
fn direction(creases: &Creases, neighbourhood: &Neighbourhood, normal: DVec3) -> DVec3 {
    let faces = neighbourhood
        .spokes()
        .iter()
        .map(|s| s.face)
        .chain(neighbourhood.removed_faces().iter().map(|d| d.face));
    let sum = faces.fold(normal, |sum, face| {
        let other = creases.normal(face);
        sum + (1.0 - normal.dot(other)) * other
    });
    sum.try_normalize().unwrap_or(normal)
}

#[cfg(test)]
mod tests {
    use meshlod_mesh::{Connectivity, Mesh, VertexId};

    use super::*;
    use crate::methods::wu;
    use crate::surface::contracted::Contracted;

    /// Regular pyramid without its base; the tip is vertex 0.
    fn pyramid() -> Mesh {
        let rim = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]];
        let positions = [[0.0, 0.0, 1.0]].into_iter().chain(rim).collect();
        let face = |i: u32| [VertexId(0), VertexId(1 + i), VertexId(1 + (i + 1) % 4)];
        Mesh::new(positions, (0..4).map(face).collect())
    }

    #[test]
    fn a_tip_whose_edges_are_alike_counts_here_and_not_with_wu() {
        let mesh = pyramid();
        let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
        let surface = Surface::new(&mesh, &connectivity);
        let tip = VertexId(0);
        let turn = |weigh| {
            let creases = Creases::new(&surface, weigh);
            (creases.at(&surface, tip), creases.turn(&surface, &Contracted::face(mesh.faces[0])))
        };
        let ((ours, with_tip), (theirs, without)) = (turn(weight), turn(wu::weight));
        assert_eq!((ours.weight, theirs.weight), (1.0, 0.0));
        // The sides' normals are (±1, ±1, 1)/√3: neighbours turn by 1 − 1/3.
        assert!((f64::from(ours.mean) - 2.0 / 3.0).abs() < 1e-6);
        let at_the_rim = |v: u32| Creases::new(&surface, wu::weight).turn(&surface, &edge(v));
        assert!((without - at_the_rim(1)).abs() < 1e-6, "the face counts for its rim alone");
        assert!((with_tip - without).abs() > 0.01);
    }

    fn edge(v: u32) -> Contracted {
        Contracted::edge([VertexId(v), VertexId(v + 1)])
    }
}
