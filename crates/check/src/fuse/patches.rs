//! Splits a surface into patches along its intersections with other components.

use meshlod_mesh::{Connectivity, FaceId, Mesh, Side, Twin, VertexId};
use rustc_hash::{FxHashMap, FxHashSet};

use crate::check::edges::lowest_first;
use crate::unique_positions::UniquePositions;

/// Faces connected without crossing an intersection, and bounded by one; at least one face.
pub struct Patch {
    pub faces: Vec<FaceId>,
}

/// Splits a mesh into patches along contact edges, in the order of their first faces. Parts that no
/// contact edge bounds are omitted. An edge that two components have at the same positions also
/// counts as a contact edge.
pub fn patches(
    mesh: &Mesh,
    component: &[u32],
    contact_edges: &FxHashSet<[VertexId; 2]>,
) -> Vec<Patch> {
    let shared = SharedEdges::of(mesh, component);
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    let is_contact = |side: Side| {
        contact_edges.contains(&lowest_first(side.ends(&mesh.faces))) || shared.contain(mesh, side)
    };
    let mut seen = vec![false; mesh.faces.len()];
    let mut patches = Vec::new();
    for first in (0..mesh.faces.len()).map(FaceId::new) {
        if std::mem::replace(&mut seen[first.index()], true) {
            continue;
        }
        let (mut faces, mut bounded, mut next) = (vec![first], false, 0);
        while let Some(&face) = faces.get(next) {
            next += 1;
            for side in [0, 1, 2].map(|k| Side::new(face, k)) {
                if is_contact(side) {
                    bounded = true;
                } else if let Twin::Side(twin) = connectivity.twin(side)
                    && !std::mem::replace(&mut seen[twin.face().index()], true)
                {
                    faces.push(twin.face());
                }
            }
        }
        if bounded {
            patches.push(Patch { faces });
        }
    }
    patches
}

/// Edges, as pairs of positions, that faces of two components share.
struct SharedEdges {
    unique: UniquePositions,
    /// Component of each edge; `None` if there are several.
    component: FxHashMap<[VertexId; 2], Option<u32>>,
}

impl SharedEdges {
    fn of(mesh: &Mesh, component: &[u32]) -> Self {
        let unique = UniquePositions::of(&mesh.positions);
        let mut duplicated = vec![false; mesh.positions.len()];
        unique.duplicates().for_each(|v| duplicated[unique.representative(v).index()] = true);
        let mut components = FxHashMap::default();
        for (face, &component) in mesh.faces.iter().zip(component) {
            for k in 0..3 {
                let ends = [face[k], face[(k + 1) % 3]].map(|v| unique.representative(v));
                // Only positions of several vertices can be shared.
                if ends.iter().all(|v| duplicated[v.index()]) {
                    let first = components.entry(lowest_first(ends)).or_insert(Some(component));
                    *first = first.filter(|first| *first == component);
                }
            }
        }
        Self { unique, component: components }
    }

    fn contain(&self, mesh: &Mesh, side: Side) -> bool {
        let ends = side.ends(&mesh.faces).map(|v| self.unique.representative(v));
        self.component.get(&lowest_first(ends)).is_some_and(Option::is_none)
    }
}
