//! What lines of contact part a surface into.

use meshlod_mesh::{Connectivity, FaceId, Mesh, Side, Twin, VertexId};
use rustc_hash::{FxHashMap, FxHashSet};

use crate::check::edges::lowest_first;
use crate::places::Places;

/// Faces that hang together without crossing a line, and are bounded by one; at least one face.
pub struct Patch {
    pub faces: Vec<FaceId>,
}

/// The patches of a mesh between lines, by their first faces; what no line bounds is none. An edge
/// that two components have at the same two places is a line too.
pub fn patches(mesh: &Mesh, component: &[u32], lines: &FxHashSet<[VertexId; 2]>) -> Vec<Patch> {
    let shared = SharedEdges::of(mesh, component);
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    let on_line = |side: Side| {
        lines.contains(&lowest_first(side.ends(&mesh.faces))) || shared.hold(mesh, side)
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
                if on_line(side) {
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

/// The edges, as pairs of places, that faces of two components have.
struct SharedEdges {
    places: Places,
    /// The one component, or none where there are several.
    of: FxHashMap<[VertexId; 2], Option<u32>>,
}

impl SharedEdges {
    fn of(mesh: &Mesh, component: &[u32]) -> Self {
        let places = Places::of(&mesh.positions);
        let mut doubled = vec![false; mesh.positions.len()];
        places.doubles().for_each(|v| doubled[places.first(v).index()] = true);
        let mut of = FxHashMap::default();
        for (face, &component) in mesh.faces.iter().zip(component) {
            for k in 0..3 {
                let ends = [face[k], face[(k + 1) % 3]].map(|v| places.first(v));
                // Only between places of several vertices.
                if ends.iter().all(|v| doubled[v.index()]) {
                    let first = of.entry(lowest_first(ends)).or_insert(Some(component));
                    *first = first.filter(|first| *first == component);
                }
            }
        }
        Self { places, of }
    }

    fn hold(&self, mesh: &Mesh, side: Side) -> bool {
        let ends = side.ends(&mesh.faces).map(|v| self.places.first(v));
        self.of.get(&lowest_first(ends)).is_some_and(Option::is_none)
    }
}
