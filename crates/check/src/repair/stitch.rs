//! Stitches boundary edges that coincide.
//!
//! docs/notes/splitting.md says how this differs from the other splitters and sewers.

use meshlod_mesh::{
    Connectivity, FaceId, Mesh, Side, Twin, UnionFind, VertexId, first_near, merge_equal_wedges,
};

use super::edit::own_wedges;
use crate::unique_positions::UniquePositions;
use crate::zero_area::has_zero_area;

/// Limit on rounds before stitching within a distance is given up. If vertices do not move, the
/// second round finds nothing more to undo; a boundary of a hundred edges undone one by one still
/// converges.
const ROUNDS: usize = 64;

/// Stitches boundary edges that run in opposite directions between the same two positions; returns
/// the number of pairs stitched.
///
/// Positions are the same within `epsilon`, in model units; joined vertices move to the first of
/// them. Edges are joined only if exactly two sides of one object lie there, and only if every edge
/// then has at most two faces, every face three vertices and an area, and no two faces the same
/// vertices. Vertices that would break this stay open all around.
///
/// A vertex that stays apart may leave a face whose other corners have moved without area, so that
/// more vertices must stay apart. If that does not converge, only edges at equal positions are
/// stitched.
pub fn stitch(mesh: &mut Mesh, epsilon: f64) -> usize {
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    let near = candidates(mesh, &connectivity, epsilon);
    let (count, joined) = resolve(mesh, &connectivity, near).unwrap_or_else(|| {
        let at_equal_positions = candidates(mesh, &connectivity, 0.0);
        resolve(mesh, &connectivity, at_equal_positions).unwrap_or_default()
    });
    if count > 0 {
        mesh.faces.as_flattened_mut().iter_mut().for_each(|v| *v = joined[v.index()]);
        own_wedges(mesh);
        merge_equal_wedges(mesh);
    }
    count
}

/// Drops pairs until none does harm; returns the number left and the vertex that each vertex
/// becomes. `None` if that does not converge.
fn resolve(
    mesh: &Mesh,
    connectivity: &Connectivity,
    mut pairs: Vec<[Side; 2]>,
) -> Option<(usize, Vec<VertexId>)> {
    for _ in 0..ROUNDS {
        let mut vertices = UnionFind::new(mesh.positions.len());
        for [a, b] in &pairs {
            for [v, w] in joined_ends(mesh, *a, *b) {
                vertices.union(v.0, w.0);
            }
        }
        let joined: Vec<VertexId> =
            (0..mesh.positions.len()).map(|v| VertexId(vertices.find(v as u32))).collect();
        let damaged = damaged(mesh, connectivity, &joined, &pairs);
        let before = pairs.len();
        pairs.retain(|[side, _]| {
            side.ends(&mesh.faces).iter().all(|v| !damaged[joined[v.index()].index()])
        });
        if pairs.len() == before {
            return Some((before, joined));
        }
    }
    None
}

/// Returns the pairs of boundary sides that coincide with each other and no other side, sorted.
fn candidates(mesh: &Mesh, connectivity: &Connectivity, epsilon: f64) -> Vec<[Side; 2]> {
    if connectivity.boundary_edges() < 2 {
        return Vec::new();
    }
    let merged = merged_vertices(mesh, epsilon);
    let mut at_boundary = vec![false; mesh.positions.len()];
    for v in (0..merged.len()).filter(|&v| connectivity.marks(VertexId(v as u32)).boundary()) {
        at_boundary[merged[v] as usize] = true;
    }
    // Interior sides count too, or else a filled hole would make a pair of two out of three
    // coincident boundaries.
    let mut sides: Vec<([u32; 2], Side)> = (0..mesh.faces.len())
        .flat_map(|f| [0, 1, 2].map(|k| Side::new(FaceId(f as u32), k)))
        .filter(|&side| connectivity.twin(side) != Twin::Degenerate)
        .map(|side| (side.ends(&mesh.faces).map(|v| merged[v.index()]), side))
        .filter(|(ends, _)| ends[0] != ends[1] && ends.iter().all(|&v| at_boundary[v as usize]))
        .map(|([a, b], side)| ([a.min(b), a.max(b)], side))
        .collect();
    sides.sort_unstable();
    let fits = |a: Side, b: Side| {
        let starts = [a, b].map(|side| merged[side.ends(&mesh.faces)[0].index()]);
        let objects = mesh.objects.as_ref();
        let objects = [a, b].map(|side| objects.map(|labels| labels.of(side.face().index())));
        [a, b].iter().all(|&side| connectivity.twin(side) == Twin::Boundary)
            && a.face() != b.face()
            && starts[0] != starts[1]
            && objects[0] == objects[1]
    };
    let mut pairs: Vec<[Side; 2]> = sides
        .chunk_by(|a, b| a.0 == b.0)
        .filter_map(|edge| match *edge {
            [(_, a), (_, b)] if fits(a, b) => Some([a, b]),
            _ => None,
        })
        .collect();
    pairs.sort_unstable();
    pairs
}

/// Returns for every vertex the first vertex at its position.
fn merged_vertices(mesh: &Mesh, epsilon: f64) -> Vec<u32> {
    if epsilon > 0.0 {
        return first_near(&mesh.positions, epsilon);
    }
    let unique = UniquePositions::of(&mesh.positions);
    (0..mesh.positions.len()).map(|v| unique.representative(VertexId(v as u32)).0).collect()
}

/// Returns the pairs of vertices that become one if two opposite sides are joined.
fn joined_ends(mesh: &Mesh, a: Side, b: Side) -> [[VertexId; 2]; 2] {
    let ([a0, a1], [b0, b1]) = (a.ends(&mesh.faces), b.ends(&mesh.faces));
    [[a0, b1], [a1, b0]]
}

/// Flags the joined vertices at which stitching would do damage.
fn damaged(
    mesh: &Mesh,
    connectivity: &Connectivity,
    joined: &[VertexId],
    pairs: &[[Side; 2]],
) -> Vec<bool> {
    let mut is_joined = vec![false; joined.len()];
    for v in pairs.iter().flatten().flat_map(|side| side.ends(&mesh.faces)) {
        is_joined[joined[v.index()].index()] = true;
    }
    let mut damaged = vec![false; joined.len()];
    let mut sides: Vec<([VertexId; 2], Side)> = Vec::new();
    let mut whole: Vec<[VertexId; 3]> = Vec::new();
    for (f, face) in mesh.faces.iter().enumerate() {
        if connectivity.twin(Side::new(FaceId(f as u32), 0)) == Twin::Degenerate {
            continue;
        }
        let now = face.map(|v| joined[v.index()]);
        let at = now.map(|v| is_joined[v.index()]);
        if at == [false; 3] {
            continue;
        }
        if now[0] == now[1] || now[1] == now[2] || now[2] == now[0] || loses_area(mesh, *face, now)
        {
            now.iter().for_each(|v| damaged[v.index()] = true);
        }
        // Only an edge with a joined end can coincide with another.
        for k in (0..3).filter(|&k| at[k] || at[(k + 1) % 3]) {
            let [a, b] = [now[k], now[(k + 1) % 3]];
            sides.push(([a.min(b), a.max(b)], Side::new(FaceId(f as u32), k)));
        }
        let mut sorted = now;
        sorted.sort_unstable();
        whole.push(sorted);
    }
    mark_damaged_edges(sides, connectivity, pairs, &mut damaged);
    whole.sort_unstable();
    for same in whole.chunk_by(|a, b| a == b).filter(|same| same.len() > 1) {
        same[0].iter().for_each(|v| damaged[v.index()] = true);
    }
    damaged
}

fn loses_area(mesh: &Mesh, before: [VertexId; 3], now: [VertexId; 3]) -> bool {
    let at = |face: [VertexId; 3]| face.map(|v| mesh.positions[v.index()]);
    at(before) != at(now) && has_zero_area(at(now))
}

/// Marks the ends of edges at which sides meet that do not belong together.
fn mark_damaged_edges(
    mut sides: Vec<([VertexId; 2], Side)>,
    connectivity: &Connectivity,
    pairs: &[[Side; 2]],
    damaged: &mut [bool],
) {
    sides.sort_unstable();
    for edge in sides.chunk_by(|a, b| a.0 == b.0) {
        let fits = match *edge {
            [_] => true,
            [(_, a), (_, b)] => {
                connectivity.twin(a) == Twin::Side(b) || pairs.binary_search(&[a, b]).is_ok()
            }
            _ => false,
        };
        if !fits {
            edge[0].0.iter().for_each(|v| damaged[v.index()] = true);
        }
    }
}
