//! Taking apart edges of three faces or more, and vertices of several fans.

use meshlod_mesh::{Connectivity, FaceId, Mesh, Side, Twin, VertexId};

use super::edit::own_wedges;
use super::split_pairs::pair_up;
use crate::check::edges::lowest_first;
use crate::check::faces::duplicates;
use crate::joined::Joined;

/// What was taken apart.
#[derive(Debug, Default, PartialEq)]
pub struct Split {
    /// Edges of three faces or more.
    pub edges: usize,
    /// Vertices that came of it.
    pub vertices: usize,
}

/// Takes apart all edges of three faces or more, and all vertices of several fans.
///
/// At each edge faces are paired up ([`pair_up`]) and a face that is left is alone. Vertices are what
/// the pairs leave of them: the corners that can be reached from each other across paired sides
/// [GTLH98]. Nothing moves; new vertices have wedges of their own with the same values.
pub fn split(mesh: &mut Mesh) -> Split {
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    let doubles = duplicates(&mesh.faces, &connectivity);
    if connectivity.non_manifold_edges() + connectivity.pinched_vertices() + doubles.len() == 0 {
        return Split::default();
    }
    let edges = non_manifold_edges(&mesh.faces, &connectivity);
    let mut pairs = Pairs::of(&mesh.faces, &connectivity);
    for edge in &edges {
        for [a, b] in pair_up(mesh, edge) {
            pairs.join(a, b);
        }
    }
    pairs.part_meeting_edges(&mesh.faces, &edges);
    pairs.part_doubles(&mesh.faces, &doubles);
    let vertices = pairs.give_vertices(mesh);
    own_wedges(mesh);
    Split { edges: edges.len(), vertices }
}

/// The sides of every edge of three faces or more.
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

/// Which side goes with which. A side without a partner is a border.
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

    fn join(&mut self, a: Side, b: Side) {
        self.partner[index(a)] = Some(b);
        self.partner[index(b)] = Some(a);
    }

    fn part(&mut self, side: Side) {
        if let Some(partner) = self.partner[index(side)].take() {
            self.partner[index(partner)] = None;
        }
    }

    /// The corners that can be reached from each other across pairs, as sets of corner numbers.
    fn fans(&self, faces: &[[VertexId; 3]]) -> Joined {
        let mut fans = Joined::new(faces.len() * 3);
        for (s, partner) in self.partner.iter().enumerate() {
            let Some(partner) = *partner else { continue };
            let (f, k) = (s / 3, s % 3);
            let other = faces[partner.face().index()];
            for k in [k, (k + 1) % 3] {
                let there = partner.face().index() * 3;
                if let Some(l) = other.iter().position(|&v| v == faces[f][k]) {
                    fans.join((f * 3 + k) as u32, (there + l) as u32);
                }
            }
        }
        fans
    }

    /// Where pairs of one edge still run between the same two fans, they would be one edge again:
    /// all but the first are cut off from the fan at its lower end. That opens slits, and is rare:
    /// it takes a fan that passes the edge twice.
    fn part_meeting_edges(&mut self, faces: &[[VertexId; 3]], edges: &[Vec<Side>]) {
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
            self.part(at_lower_end(faces, side));
        }
    }

    /// The fans at the ends of a side, the one at the lower end first.
    fn ends(&self, faces: &[[VertexId; 3]], fans: &mut Joined, side: Side) -> [u32; 2] {
        let (f, k) = (side.face().index(), side.corner());
        let [a, b] = [k, (k + 1) % 3].map(|k| fans.least((f * 3 + k) as u32));
        let [from, to] = side.ends(faces);
        if from < to { [a, b] } else { [b, a] }
    }

    /// Cuts off faces that still have the same three fans as another.
    fn part_doubles(&mut self, faces: &[[VertexId; 3]], doubles: &[(FaceId, FaceId)]) {
        let mut fans = self.fans(faces);
        let mut three = |face: FaceId| {
            let mut three = [0, 1, 2].map(|k| fans.least(face.0 * 3 + k));
            three.sort_unstable();
            three
        };
        let still: Vec<FaceId> = doubles
            .iter()
            .filter(|&&(face, of)| three(face) == three(of))
            .map(|&(face, _)| face)
            .collect();
        for side in still.into_iter().flat_map(|face| [0, 1, 2].map(|k| Side::new(face, k))) {
            self.part(side);
        }
    }

    /// Gives every fan a vertex: the first of each vertex keeps it. Says how many are new.
    fn give_vertices(&self, mesh: &mut Mesh) -> usize {
        let before = mesh.positions.len();
        let mut fans = self.fans(&mesh.faces);
        let mut vertex_of_fan: Vec<Option<VertexId>> = vec![None; mesh.faces.len() * 3];
        let mut taken = vec![false; before];
        for (f, face) in mesh.faces.iter_mut().enumerate() {
            // A face that repeats a vertex has no sides to reach others by.
            if face[0] == face[1] || face[1] == face[2] || face[2] == face[0] {
                continue;
            }
            for (k, vertex) in face.iter_mut().enumerate() {
                let fan = fans.least((f * 3 + k) as u32) as usize;
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

/// The other side of the same face that ends where the side has its lower end.
fn at_lower_end(faces: &[[VertexId; 3]], side: Side) -> Side {
    let [from, to] = side.ends(faces);
    let k = if from < to { side.corner() + 2 } else { side.corner() + 1 };
    Side::new(side.face(), k % 3)
}
