//! Joining borders that lie on each other.

use meshlod_mesh::{
    Connectivity, FaceId, Mesh, Side, Twin, VertexId, first_near, merge_equal_wedges,
};

use super::edit::own_wedges;
use crate::joined::Joined;
use crate::places::Places;
use crate::zero_area::has_zero_area;

/// Rounds after which joining within a distance is given up. Where vertices stay in place, the second
/// finds nothing more to undo; a border of a hundred edges that comes off one by one still settles.
const ROUNDS: usize = 64;

/// Joins the border edges that run opposite ways between the same two places, and says how many
/// pairs.
///
/// Places are one within `epsilon`, in model units; joined vertices go to where the first of them is.
/// Edges are joined only where exactly two sides lie there, of one object, and only where that leaves
/// every edge with two faces, every face with three vertices and an area, and no two with the same:
/// what would not is left open all around.
///
/// A vertex that stays apart after all may take the area of a face whose other corners have moved,
/// so that more have to stay. Where that does not end, only edges at one place are joined.
pub fn stitch(mesh: &mut Mesh, epsilon: f64) -> usize {
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    let near = candidates(mesh, &connectivity, epsilon);
    let (count, joined) = settle(mesh, &connectivity, near).unwrap_or_else(|| {
        let at_one_place = candidates(mesh, &connectivity, 0.0);
        settle(mesh, &connectivity, at_one_place).unwrap_or_default()
    });
    if count > 0 {
        mesh.faces.as_flattened_mut().iter_mut().for_each(|v| *v = joined[v.index()]);
        own_wedges(mesh);
        merge_equal_wedges(mesh);
    }
    count
}

/// Leaves out seams until none spoils anything: how many are left, and the vertex that each becomes.
/// `None` where that does not end soon.
fn settle(
    mesh: &Mesh,
    connectivity: &Connectivity,
    mut seams: Vec<[Side; 2]>,
) -> Option<(usize, Vec<VertexId>)> {
    for _ in 0..ROUNDS {
        let mut vertices = Joined::new(mesh.positions.len());
        for [a, b] in &seams {
            for [v, w] in meeting_ends(mesh, *a, *b) {
                vertices.join(v.0, w.0);
            }
        }
        let joined: Vec<VertexId> =
            (0..mesh.positions.len()).map(|v| VertexId(vertices.least(v as u32))).collect();
        let spoilt = spoilt(mesh, connectivity, &joined, &seams);
        let before = seams.len();
        seams.retain(|[side, _]| {
            side.ends(&mesh.faces).iter().all(|v| !spoilt[joined[v.index()].index()])
        });
        if seams.len() == before {
            return Some((before, joined));
        }
    }
    None
}

/// Pairs of border sides that lie on each other, and on no other side, in order.
fn candidates(mesh: &Mesh, connectivity: &Connectivity, epsilon: f64) -> Vec<[Side; 2]> {
    if connectivity.boundary_edges() < 2 {
        return Vec::new();
    }
    let place = places(mesh, epsilon);
    let mut at_border = vec![false; mesh.positions.len()];
    for v in (0..place.len()).filter(|&v| connectivity.marks(VertexId(v as u32)).boundary()) {
        at_border[place[v] as usize] = true;
    }
    // Sides that are no border count too: were they left out, a hole that is closed would make two
    // of three borders a pair.
    let mut sides: Vec<([u32; 2], Side)> = (0..mesh.faces.len())
        .flat_map(|f| [0, 1, 2].map(|k| Side::new(FaceId(f as u32), k)))
        .filter(|&side| connectivity.twin(side) != Twin::Degenerate)
        .map(|side| (side.ends(&mesh.faces).map(|v| place[v.index()]), side))
        .filter(|(ends, _)| {
            ends[0] != ends[1] && ends.iter().all(|&place| at_border[place as usize])
        })
        .map(|([a, b], side)| ([a.min(b), a.max(b)], side))
        .collect();
    sides.sort_unstable();
    let fits = |a: Side, b: Side| {
        let starts = [a, b].map(|side| place[side.ends(&mesh.faces)[0].index()]);
        let objects = mesh.objects.as_ref();
        let objects = [a, b].map(|side| objects.map(|labels| labels.of(side.face().index())));
        [a, b].iter().all(|&side| connectivity.twin(side) == Twin::Boundary)
            && a.face() != b.face()
            && starts[0] != starts[1]
            && objects[0] == objects[1]
    };
    let mut seams: Vec<[Side; 2]> = sides
        .chunk_by(|a, b| a.0 == b.0)
        .filter_map(|edge| match *edge {
            [(_, a), (_, b)] if fits(a, b) => Some([a, b]),
            _ => None,
        })
        .collect();
    seams.sort_unstable();
    seams
}

/// The place of every vertex: the first vertex there.
fn places(mesh: &Mesh, epsilon: f64) -> Vec<u32> {
    if epsilon > 0.0 {
        return first_near(&mesh.positions, epsilon);
    }
    let places = Places::of(&mesh.positions);
    (0..mesh.positions.len()).map(|v| places.first(VertexId(v as u32)).0).collect()
}

/// The vertices that become one where two sides that run opposite ways are joined.
fn meeting_ends(mesh: &Mesh, a: Side, b: Side) -> [[VertexId; 2]; 2] {
    let ([a0, a1], [b0, b1]) = (a.ends(&mesh.faces), b.ends(&mesh.faces));
    [[a0, b1], [a1, b0]]
}

/// The joined vertices at which something goes wrong.
fn spoilt(
    mesh: &Mesh,
    connectivity: &Connectivity,
    joined: &[VertexId],
    seams: &[[Side; 2]],
) -> Vec<bool> {
    let mut grown = vec![false; joined.len()];
    for v in seams.iter().flatten().flat_map(|side| side.ends(&mesh.faces)) {
        grown[joined[v.index()].index()] = true;
    }
    let mut spoilt = vec![false; joined.len()];
    let mut sides: Vec<([VertexId; 2], Side)> = Vec::new();
    let mut whole: Vec<[VertexId; 3]> = Vec::new();
    for (f, face) in mesh.faces.iter().enumerate() {
        if connectivity.twin(Side::new(FaceId(f as u32), 0)) == Twin::Degenerate {
            continue;
        }
        let now = face.map(|v| joined[v.index()]);
        let at = now.map(|v| grown[v.index()]);
        if at == [false; 3] {
            continue;
        }
        if now[0] == now[1] || now[1] == now[2] || now[2] == now[0] || loses_area(mesh, *face, now)
        {
            now.iter().for_each(|v| spoilt[v.index()] = true);
        }
        // Only what has grown at an end can have met another edge.
        for k in (0..3).filter(|&k| at[k] || at[(k + 1) % 3]) {
            let [a, b] = [now[k], now[(k + 1) % 3]];
            sides.push(([a.min(b), a.max(b)], Side::new(FaceId(f as u32), k)));
        }
        let mut sorted = now;
        sorted.sort_unstable();
        whole.push(sorted);
    }
    spoil_edges(sides, connectivity, seams, &mut spoilt);
    whole.sort_unstable();
    for same in whole.chunk_by(|a, b| a == b).filter(|same| same.len() > 1) {
        same[0].iter().for_each(|v| spoilt[v.index()] = true);
    }
    spoilt
}

fn loses_area(mesh: &Mesh, before: [VertexId; 3], now: [VertexId; 3]) -> bool {
    let at = |face: [VertexId; 3]| face.map(|v| mesh.positions[v.index()]);
    at(before) != at(now) && has_zero_area(at(now))
}

/// Marks the ends of edges at which other sides meet than belong together.
fn spoil_edges(
    mut sides: Vec<([VertexId; 2], Side)>,
    connectivity: &Connectivity,
    seams: &[[Side; 2]],
    spoilt: &mut [bool],
) {
    sides.sort_unstable();
    for edge in sides.chunk_by(|a, b| a.0 == b.0) {
        let fits = match *edge {
            [_] => true,
            [(_, a), (_, b)] => {
                connectivity.twin(a) == Twin::Side(b) || seams.binary_search(&[a, b]).is_ok()
            }
            _ => false,
        };
        if !fits {
            edge[0].0.iter().for_each(|v| spoilt[v.index()] = true);
        }
    }
}
