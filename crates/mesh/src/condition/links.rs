//! Links between sides: which two sides of faces are the two halves of one edge.

use crate::condition::pairing;
use crate::condition::suspects::continues;
use crate::{Connectivity, FaceId, Mesh, Side, Twin, VertexId, duplicates};

/// No side.
const NONE: u32 = u32::MAX;

/// The partner of each side across its edge, if it has one.
pub(super) struct Links {
    /// Partner of side 3 f + k of face f.
    twins: Vec<Option<Side>>,
}

impl Links {
    /// Links the two sides of each edge that has two, if they run in opposite directions, and pairs
    /// those of an edge that has more.
    pub(super) fn new(mesh: &Mesh, connectivity: &Connectivity) -> Self {
        let twins = vec![None; mesh.faces.len() * 3];
        let mut this = Self { twins };
        let mut many: Vec<([VertexId; 2], Side)> = Vec::new();
        for side in connectivity.edges() {
            match connectivity.twin(side) {
                Twin::Side(twin) if continues(mesh, side, twin) => {
                    this.link(side, twin);
                }
                Twin::NonManifold => {
                    let mut ends = side.ends(&mesh.faces);
                    ends.sort_unstable();
                    many.push((ends, side));
                }
                Twin::Side(_) | Twin::Boundary | Twin::Degenerate => {}
            }
        }
        many.sort_unstable();
        for edge in many.chunk_by(|a, b| a.0 == b.0) {
            let sides: Vec<Side> = edge.iter().map(|&(_, side)| side).collect();
            for pair in pairing::pair(mesh, &sides, |a, b| continues(mesh, a, b)) {
                this.link(pair[0], pair[1]);
            }
        }
        this
    }

    pub(super) fn link(&mut self, a: Side, b: Side) {
        self.twins[index(a)] = Some(b);
        self.twins[index(b)] = Some(a);
    }

    /// Makes a side and its partner boundary edges.
    pub(super) fn cut(&mut self, side: Side) {
        if let Some(twin) = self.twins[index(side)].take() {
            self.twins[index(twin)] = None;
        }
    }

    pub(super) fn is_linked(&self, side: Side) -> bool {
        self.twins[index(side)].is_some()
    }

    /// Iterates over all linked pairs of sides.
    pub(super) fn pairs(&self) -> impl Iterator<Item = [Side; 2]> + '_ {
        let sides = self.twins.iter().enumerate();
        let first = |(i, twin): (usize, &Option<Side>)| {
            let twin = (*twin)?;
            (i < index(twin)).then(|| [side(i), twin])
        };
        sides.filter_map(first)
    }
}

fn index(side: Side) -> usize {
    side.face().index() * 3 + side.corner()
}

fn side(index: usize) -> Side {
    Side::new(FaceId::new(index / 3), index % 3)
}

/// Returns the faces that repeat one with a lower id, with the same material and orientation.
pub(super) fn duplicate_faces(mesh: &Mesh, connectivity: &Connectivity) -> Vec<FaceId> {
    let material =
        |face: FaceId| mesh.materials.as_ref().map_or(NONE, |labels| labels.of(face.index()));
    duplicates::duplicate_faces(&mesh.faces, connectivity, material)
}
