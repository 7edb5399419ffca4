//! Splits non-manifold edges and non-manifold vertices.
//!
//! docs/notes/splitting.md says how this differs from the other splitters and sewers.

use meshlod_mesh::{Connectivity, FaceId, Mesh, Side, Twin, UnionFind, VertexId};

use super::edit::own_wedges;
use super::pair_sides::pair_sides;
use crate::check::edges::lowest_first;
use crate::check::faces::duplicates;

/// Counts of non-manifold edges split and vertices added.
#[derive(Debug, Default, PartialEq)]
pub struct Split {
    /// Number of non-manifold edges split.
    pub edges: usize,
    /// Number of vertices added.
    pub vertices: usize,
}

/// Splits all non-manifold edges and all non-manifold vertices of a mesh.
///
/// At each non-manifold edge sides are paired ([`pair_sides`]); an unpaired side becomes a
/// boundary. A vertex of the result is a set of corners connected across paired sides [GTLH98].
/// Nothing moves; new vertices have their own wedges with the same values.
pub fn split(mesh: &mut Mesh) -> Split {
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    let duplicate_faces = duplicates(&mesh.faces, &connectivity);
    if connectivity.non_manifold_edges() + connectivity.pinched_vertices() + duplicate_faces.len()
        == 0
    {
        return Split::default();
    }
    let edges = non_manifold_edges(&mesh.faces, &connectivity);
    let mut pairs = Pairs::of(&mesh.faces, &connectivity);
    for edge in &edges {
        for [a, b] in pair_sides(mesh, edge) {
            pairs.pair(a, b);
        }
    }
    pairs.separate_merged_edges(&mesh.faces, &edges);
    pairs.separate_duplicates(&mesh.faces, &duplicate_faces);
    let vertices = pairs.give_vertices(mesh);
    own_wedges(mesh);
    Split { edges: edges.len(), vertices }
}

/// Returns the sides of every non-manifold edge.
fn non_manifold_edges(faces: &[[VertexId; 3]], connectivity: &Connectivity) -> Vec<Vec<Side>> {
    let mut sides: Vec<([VertexId; 2], Side)> = (0..faces.len())
        .flat_map(|f| [0, 1, 2].map(|k| Side::new(FaceId(f as u32), k)))
        .filter(|&side| connectivity.twin(side) == Twin::NonManifold)
        .map(|side| (lowest_first(side.ends(faces)), side))
        .collect();
    sides.sort_unstable();
    let edges = sides.chunk_by(|a, b| a.0 == b.0);
    edges.map(|edge| edge.iter().map(|&(_, side)| side).collect()).collect()
}

/// Pairing of sides. A side without a partner is a boundary.
struct Pairs {
    partner: Vec<Option<Side>>,
}

impl Pairs {
    fn of(faces: &[[VertexId; 3]], connectivity: &Connectivity) -> Self {
        let sides =
            (0..faces.len()).flat_map(|f| [0, 1, 2].map(|k| Side::new(FaceId(f as u32), k)));
        let partner = sides.map(|side| match connectivity.twin(side) {
            Twin::Side(twin) => Some(twin),
            _ => None,
        });
        Self { partner: partner.collect() }
    }

    fn pair(&mut self, a: Side, b: Side) {
        self.partner[index(a)] = Some(b);
        self.partner[index(b)] = Some(a);
    }

    fn unpair(&mut self, side: Side) {
        if let Some(partner) = self.partner[index(side)].take() {
            self.partner[index(partner)] = None;
        }
    }

    /// Returns the sets of corners connected across pairs, by corner numbers.
    fn fans(&self, faces: &[[VertexId; 3]]) -> UnionFind {
        let mut fans = UnionFind::new(faces.len() * 3);
        for (s, partner) in self.partner.iter().enumerate() {
            let Some(partner) = *partner else { continue };
            let (f, k) = (s / 3, s % 3);
            let other = faces[partner.face().index()];
            for k in [k, (k + 1) % 3] {
                let there = partner.face().index() * 3;
                if let Some(l) = other.iter().position(|&v| v == faces[f][k]) {
                    fans.union((f * 3 + k) as u32, (there + l) as u32);
                }
            }
        }
        fans
    }

    /// Separates pairs of one edge that still connect the same two fans and would be one edge
    /// again.
    ///
    /// All but the first are cut off from the fan at the lower end. That opens slits, but it is
    /// rare: it takes a fan that passes the edge twice.
    fn separate_merged_edges(&mut self, faces: &[[VertexId; 3]], edges: &[Vec<Side>]) {
        let mut fans = self.fans(faces);
        let mut cut = Vec::new();
        for edge in edges {
            let mut between: Vec<([u32; 2], Side)> =
                edge.iter().map(|&side| (self.ends(faces, &mut fans, side), side)).collect();
            between.sort_unstable();
            for meeting in between.chunk_by(|a, b| a.0 == b.0) {
                let first = meeting[0].1;
                let kept = |side| side == first || self.partner[index(first)] == Some(side);
                cut.extend(meeting.iter().map(|&(_, side)| side).filter(|&side| !kept(side)));
            }
        }
        for side in cut {
            self.unpair(at_lower_end(faces, side));
        }
    }

    /// Returns the fans at the ends of a side, the one at the lower end first.
    fn ends(&self, faces: &[[VertexId; 3]], fans: &mut UnionFind, side: Side) -> [u32; 2] {
        let (f, k) = (side.face().index(), side.corner());
        let [a, b] = [k, (k + 1) % 3].map(|k| fans.find((f * 3 + k) as u32));
        let [from, to] = side.ends(faces);
        if from < to { [a, b] } else { [b, a] }
    }

    /// Cuts off faces that still have the same three fans as another face.
    fn separate_duplicates(
        &mut self,
        faces: &[[VertexId; 3]],
        duplicate_faces: &[(FaceId, FaceId)],
    ) {
        let mut fans = self.fans(faces);
        let mut three = |face: FaceId| {
            let mut three = [0, 1, 2].map(|k| fans.find(face.0 * 3 + k));
            three.sort_unstable();
            three
        };
        let still: Vec<FaceId> = duplicate_faces
            .iter()
            .filter(|&&(face, of)| three(face) == three(of))
            .map(|&(face, _)| face)
            .collect();
        for side in still.into_iter().flat_map(|face| [0, 1, 2].map(|k| Side::new(face, k))) {
            self.unpair(side);
        }
    }

    /// Gives every fan its own vertex, the first fan of each vertex keeping it; returns the number
    /// of new vertices.
    fn give_vertices(&self, mesh: &mut Mesh) -> usize {
        let before = mesh.positions.len();
        let mut fans = self.fans(&mesh.faces);
        let mut vertex_of_fan: Vec<Option<VertexId>> = vec![None; mesh.faces.len() * 3];
        let mut taken = vec![false; before];
        for (f, face) in mesh.faces.iter_mut().enumerate() {
            // A face that repeats a vertex has no sides to connect it to others.
            if face[0] == face[1] || face[1] == face[2] || face[2] == face[0] {
                continue;
            }
            for (k, vertex) in face.iter_mut().enumerate() {
                let fan = fans.find((f * 3 + k) as u32) as usize;
                *vertex = *vertex_of_fan[fan].get_or_insert_with(|| {
                    if !std::mem::replace(&mut taken[vertex.index()], true) {
                        return *vertex;
                    }
                    mesh.positions.push(mesh.positions[vertex.index()]);
                    VertexId::new(mesh.positions.len() - 1)
                });
            }
        }
        mesh.positions.len() - before
    }
}

fn index(side: Side) -> usize {
    side.face().index() * 3 + side.corner()
}

/// Returns the other side of the same face at the side's lower end.
fn at_lower_end(faces: &[[VertexId; 3]], side: Side) -> Side {
    let [from, to] = side.ends(faces);
    let k = if from < to { side.corner() + 2 } else { side.corner() + 1 };
    Side::new(side.face(), k % 3)
}
