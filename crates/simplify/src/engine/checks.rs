//! Checks that a contraction keeps the surface manifold and oriented, and closed where it was.

use glam::DVec3;
use meshlod_mesh::VertexId;

use crate::refusal::Refusal;
use crate::surface::neighbourhood::Neighbourhood;
use crate::surface::{Flags, Surface};

/// Checks that do not depend on the new position, the cheapest and most selective first.
const OF_TOPOLOGY: [Check; 3] = [shape, link, closing];

/// Check of a contraction, independent of the new position.
type Check = fn(&Surface, &Neighbourhood) -> Result<(), Refusal>;

/// Checks that merging the vertices of an edge or face keeps the topology of the surface.
pub(crate) fn topology(surface: &Surface, neighbourhood: &Neighbourhood) -> Result<(), Refusal> {
    OF_TOPOLOGY.iter().try_for_each(|check| check(surface, neighbourhood))
}

/// Smallest allowed cosine between a face's normals before and after. Found on bunny, horse and
/// dragon: 0 lets folds through that raise the maximum error, 0.5 costs a tenth of the accuracy at
/// 1 %.
const LEAST_COSINE: f64 = 0.2;

/// Allows an edge with at most two faces, or a face with as many neighbours as sides. Refuses to
/// join two boundaries across the surface, and to remove the last faces of a component.
fn shape(surface: &Surface, neighbourhood: &Neighbourhood) -> Result<(), Refusal> {
    let inner = if neighbourhood.contracted.len() == 2 { 2 } else { 4 };
    if neighbourhood.removed_faces.len() > inner {
        return Err(Refusal::NonManifold);
    }
    let on_boundary = |&v: &VertexId| surface.flags(v).any(Flags::BOUNDARY);
    if neighbourhood.removed_faces.len() == inner
        && neighbourhood.contracted.iter().all(on_boundary)
    {
        return Err(Refusal::Boundary);
    }
    lasting(neighbourhood)
}

/// Checks that some face survives and every wing keeps one.
fn lasting(neighbourhood: &Neighbourhood) -> Result<(), Refusal> {
    let hangs_on = |wing: usize| {
        neighbourhood
            .spokes
            .iter()
            .any(|spoke| spoke.a as usize == wing || spoke.b as usize == wing)
    };
    let mut wings = neighbourhood.removed_faces.iter().filter_map(|removed| removed.apex());
    if wings.all(hangs_on) && !neighbourhood.spokes.is_empty() {
        Ok(())
    } else {
        Err(Refusal::LastFaces)
    }
}

/// Checks the link condition for vertices [DEGN99]: a common neighbour of contracted vertices must
/// be the apex of a removed face on exactly these.
fn link(_: &Surface, neighbourhood: &Neighbourhood) -> Result<(), Refusal> {
    let apart = |adjacent: u8, wing: u8| adjacent.count_ones() < 2 || adjacent == wing;
    let ok = neighbourhood.ring.iter().all(|r| {
        apart(r.adjacent, r.wing)
            && (r.adjacent.count_ones() < 3 || neighbourhood.removed_faces.len() == 1)
    });
    if ok { Ok(()) } else { Err(Refusal::Link) }
}

/// Checks the link condition for edges: no two surviving faces share the same two wings, or they
/// would become duplicates. This also protects tetrahedra.
fn closing(_: &Surface, neighbourhood: &Neighbourhood) -> Result<(), Refusal> {
    let shared = |place: u32| neighbourhood.ring[place as usize].adjacent.count_ones() > 1;
    let across = neighbourhood.spokes.iter().filter(|spoke| shared(spoke.a) && shared(spoke.b));
    // The two sides of a thin sheet share one apex: removing both would also remove what closes the
    // edges to it.
    let leaf = matches!(neighbourhood.removed_faces[..], [a, b] if a.apex() == b.apex());
    if across.count() < 2 && !leaf { Ok(()) } else { Err(Refusal::Link) }
}

/// Checks that no remaining face flips, turns by more than the limit or loses its area. Faces that
/// had no area before are not checked.
pub(crate) fn flip(
    surface: &Surface,
    neighbourhood: &Neighbourhood,
    position: DVec3,
) -> Result<(), Refusal> {
    for spoke in &neighbourhood.spokes {
        let (a, b) = (
            neighbourhood.ring[spoke.a as usize].position,
            neighbourhood.ring[spoke.b as usize].position,
        );
        let old = surface.position(neighbourhood.contracted[spoke.owner()]);
        let before = (a - old).cross(b - old);
        let after = (a - position).cross(b - position);
        let turn = before.dot(after);
        let sizes = before.length_squared() * after.length_squared();
        if !(turn > 0.0 && turn * turn > LEAST_COSINE * LEAST_COSINE * sizes)
            && before.length_squared() > 0.0
        {
            return Err(Refusal::Flip);
        }
    }
    Ok(())
}
