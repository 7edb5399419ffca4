//! Simple polygon reduction [Mel98]: the cost of an edge is its length times the turn of the
//! surface at the removed end, and no vertex moves.
//!
//! cost(u→v) = |u−v| · max over the faces f at u of min over the faces n on uv of (1 − f·n) / 2.
//!
//! The inner minimum lets a crease be shortened along itself. Our choices: a boundary edge adds a
//! virtual face perpendicular to its own, so that the same formula preserves boundaries and their
//! corners. Both directions are tried and the cheaper one is taken. A small part of the length
//! always counts, so that flat regions are contracted short edges first.

use glam::DVec3;
use meshlod_mesh::{FaceId, VertexId};

use crate::engine::Algorithm;
use crate::engine::candidates::EdgeCandidates;
use crate::engine::policy::{Placement, Priority};
use crate::engine::prepared_surface::PreparedSurface;
use crate::refusal::Refusal;
use crate::run::Run;
use crate::surface::contracted::{Contracted, Freedom};
use crate::surface::neighbourhood::Neighbourhood;
use crate::surface::{Flags, Placed, Surface};

/// Weight of the length where nothing turns. Without it a flat region is contracted in the order of
/// ids and grows hubs.
const FLAT: f64 = 1e-4;

/// Number of faces, real and virtual, compared on an edge; an edge with more is refused anyway.
const MOST_SIDES: usize = 4;

/// Starts the method.
pub(super) fn start(ready: PreparedSurface) -> Box<dyn Run> {
    Algorithm { candidates: EdgeCandidates, memory: (), priority: Turn, placement: Turn }
        .start(ready)
}

/// Turn of the surface [Mel98], as priority and as placement.
struct Turn;

impl Priority<()> for Turn {
    fn cost(&self, surface: &Surface, _: &(), of: &Contracted, freedom: Freedom) -> Option<f64> {
        // A hub would be traversed for each of its edges, and is refused anyway.
        (!surface.is_crowded(of)).then(|| cheaper(surface, of, freedom).1)
    }
}

impl Placement<()> for Turn {
    fn place(
        &self,
        surface: &Surface,
        _: &(),
        neighbourhood: &Neighbourhood,
    ) -> Result<Placed, Refusal> {
        let (kept, _) = cheaper(surface, neighbourhood.contracted(), neighbourhood.freedom());
        let position = surface.position(neighbourhood.contracted()[kept]);
        Ok(Placed { position, kept, error_estimate: 0.0 })
    }
}

/// Returns the end to keep, and the cost.
fn cheaper(surface: &Surface, of: &Contracted, freedom: Freedom) -> (usize, f64) {
    let onto = |kept: usize| (kept, cost(surface, of[1 - kept], of[kept]));
    match freedom.kept() {
        Some(kept) => onto(kept),
        None => {
            let (first, second) = (onto(0), onto(1));
            if second.1 < first.1 { second } else { first }
        }
    }
}

/// Returns the cost of contracting `u` onto `v` [Mel98].
fn cost(surface: &Surface, u: VertexId, v: VertexId) -> f64 {
    let mut sides = [DVec3::ZERO; MOST_SIDES];
    let mut count = 0;
    let mut add = |normal: DVec3| {
        if count < MOST_SIDES {
            sides[count] = normal;
            count += 1;
        }
    };
    for face in surface.star(u).filter(|&face| surface.face(face).contains(&v)) {
        normals(surface, u, face, Some(v)).into_iter().flatten().for_each(&mut add);
    }
    let turn =
        |f: DVec3| sides[..count].iter().map(|&n| (1.0 - f.dot(n)) / 2.0).fold(1.0, f64::min);
    let around = surface.star(u).flat_map(|face| normals(surface, u, face, None));
    let sharpest = around.flatten().map(turn).fold(0.0, f64::max);
    surface.position(u).distance(surface.position(v)) * (sharpest + FLAT)
}

/// Returns the normals of a face at `u` and of the virtual faces on its boundary sides there, or
/// only on the side to `v`; nothing for a face without area.
fn normals(
    surface: &Surface,
    u: VertexId,
    face: FaceId,
    v: Option<VertexId>,
) -> [Option<DVec3>; 3] {
    let Some(normal) = surface.area_normal(face).try_normalize() else { return [None; 3] };
    if !surface.flags(u).any(Flags::BOUNDARY) {
        return [Some(normal), None, None];
    }
    let (vertices, corner) = (surface.face(face), surface.corner(face, u));
    let virtual_face = |from: VertexId, to: VertexId| {
        let other = if from == u { to } else { from };
        let wanted = v.is_none_or(|v| v == other);
        let faces = || surface.star(u).filter(|&face| surface.face(face).contains(&other));
        let along = surface.position(to) - surface.position(from);
        (wanted && faces().count() == 1).then(|| along.cross(normal).try_normalize()).flatten()
    };
    let (next, last) = (vertices[(corner + 1) % 3], vertices[(corner + 2) % 3]);
    [Some(normal), virtual_face(u, next), virtual_face(last, u)]
}

#[cfg(test)]
mod tests {
    use meshlod_mesh::{Connectivity, Mesh};

    use super::*;

    fn cost_in(mesh: &Mesh, u: u32, v: u32) -> f64 {
        let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
        cost(&Surface::new(mesh, &connectivity), VertexId(u), VertexId(v))
    }

    fn mesh(positions: &[[f64; 3]], faces: &[[u32; 3]]) -> Mesh {
        Mesh::new(positions.to_vec(), faces.iter().map(|face| face.map(VertexId)).collect())
    }

    /// Roof with a ridge of right angles along x, closed below, and with v0 and v1 on the ridge.
    fn roof() -> Mesh {
        let positions = [
            [0.0, 0.0, 1.0],
            [2.0, 0.0, 1.0],
            [-1.0, -1.0, 0.0],
            [3.0, -1.0, 0.0],
            [3.0, 1.0, 0.0],
            [-1.0, 1.0, 0.0],
        ];
        let faces = [
            [2, 3, 1],
            [2, 1, 0],
            [4, 5, 0],
            [4, 0, 1],
            [5, 2, 0],
            [3, 4, 1],
            [2, 5, 4],
            [2, 4, 3],
        ];
        mesh(&positions, &faces)
    }

    #[test]
    fn a_roof_costs_what_it_does_by_hand() {
        // At v0: the slopes (0, ∓1, 1) / √2 and the gable (−1, 0, 1) / √2. Both slopes meet at
        // v0v1, so only the gable turns: 1 − 1/2 from either, halved.
        let along_the_ridge = 2.0 * (0.25 + FLAT);
        assert!((cost_in(&roof(), 0, 1) - along_the_ridge).abs() < 1e-15);
        // On the edge to v2 are only the slope of −y and the gable. The other slope is at a right
        // angle to the first and 1 − 1/2 from the second, which is less.
        let down = 3f64.sqrt() * (0.25 + FLAT);
        assert!((cost_in(&roof(), 0, 2) - down).abs() < 1e-15);
    }

    #[test]
    fn an_outline_turns_at_its_corners_only() {
        // Open square of side 2 with v4 in its middle and v5 on a side.
        let positions = [
            [0.0, 0.0, 0.0],
            [2.0, 0.0, 0.0],
            [2.0, 2.0, 0.0],
            [0.0, 2.0, 0.0],
            [1.0, 1.0, 0.0],
            [1.0, 0.0, 0.0],
        ];
        let faces = [[0, 5, 4], [5, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        let mesh = mesh(&positions, &faces);
        let turn = |u: u32, v: u32| {
            let length = DVec3::from(mesh.positions[u as usize])
                .distance(DVec3::from(mesh.positions[v as usize]));
            cost_in(&mesh, u, v) / length - FLAT
        };
        assert!(turn(4, 5).abs() < 1e-12, "inside nothing turns");
        assert!(turn(5, 1).abs() < 1e-12, "nor along a side");
        assert!((turn(5, 4) - 0.5).abs() < 1e-12, "a side goes inwards");
        assert!((turn(1, 5) - 0.5).abs() < 1e-12, "a corner goes");
    }
}
