//! What every contraction must respect: as manifold, closed and oriented after as before.

use glam::DVec3;
use meshlod_mesh::VertexId;

use crate::refusal::Refusal;
use crate::surface::neighbourhood::Neighbourhood;
use crate::surface::{Flags, Surface};

/// The rules that do not ask for the new place, the cheapest and most often met first.
const OF_TOPOLOGY: [Check; 3] = [shape, link, closing];

/// A reason against a contraction, wherever its vertex goes.
type Check = fn(&Surface, &Neighbourhood) -> Result<(), Refusal>;

/// Whether what is around may become one vertex at all.
pub(crate) fn topology(surface: &Surface, neighbourhood: &Neighbourhood) -> Result<(), Refusal> {
    OF_TOPOLOGY.iter().try_for_each(|check| check(surface, neighbourhood))
}

/// The least cosine between a face's normal before and after; found on bunny, horse and dragon:
/// 0 lets folds through that raise the maximum, 0.5 costs a tenth of the accuracy at 1 %.
const LEAST_COSINE: f64 = 0.2;

/// An edge of at most two faces, or a face with as many neighbours as sides; not one that joins two
/// boundaries across the surface; not the last of what hangs together.
fn shape(surface: &Surface, neighbourhood: &Neighbourhood) -> Result<(), Refusal> {
    let inner = if neighbourhood.contracted.len() == 2 { 2 } else { 4 };
    if neighbourhood.dying.len() > inner {
        return Err(Refusal::NonManifold);
    }
    let on_boundary = |&v: &VertexId| surface.flags(v).any(Flags::BOUNDARY);
    if neighbourhood.dying.len() == inner && neighbourhood.contracted.iter().all(on_boundary) {
        return Err(Refusal::Boundary);
    }
    lasting(neighbourhood)
}

/// Something is left, and every wing still hangs on it by a face.
fn lasting(neighbourhood: &Neighbourhood) -> Result<(), Refusal> {
    let hangs_on = |wing: usize| {
        neighbourhood
            .spokes
            .iter()
            .any(|spoke| spoke.a as usize == wing || spoke.b as usize == wing)
    };
    let mut wings = neighbourhood.dying.iter().filter_map(|dying| dying.apex());
    if wings.all(hangs_on) && !neighbourhood.spokes.is_empty() {
        Ok(())
    } else {
        Err(Refusal::LastFaces)
    }
}

/// The link condition for vertices [DEGN99]: a common neighbour of contracted vertices is the apex
/// of a dying face on just these.
fn link(_: &Surface, neighbourhood: &Neighbourhood) -> Result<(), Refusal> {
    let apart = |adjacent: u8, wing: u8| adjacent.count_ones() < 2 || adjacent == wing;
    let ok = neighbourhood.ring.iter().all(|r| {
        apart(r.adjacent, r.wing) && (r.adjacent.count_ones() < 3 || neighbourhood.dying.len() == 1)
    });
    if ok { Ok(()) } else { Err(Refusal::Link) }
}

/// The link condition for edges: no two surviving faces on the same two wings, or they would
/// become one face twice. So does a tetrahedron end.
fn closing(_: &Surface, neighbourhood: &Neighbourhood) -> Result<(), Refusal> {
    let shared = |place: u32| neighbourhood.ring[place as usize].adjacent.count_ones() > 1;
    let across = neighbourhood.spokes.iter().filter(|spoke| shared(spoke.a) && shared(spoke.b));
    // The two sides of a leaf have one apex: with them would go what closes the edges to it.
    let leaf = matches!(neighbourhood.dying[..], [a, b] if a.apex() == b.apex());
    if across.count() < 2 && !leaf { Ok(()) } else { Err(Refusal::Link) }
}

/// No surviving face turns over, or by more than a limit, or loses its area. One without area
/// before may do as it likes.
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
