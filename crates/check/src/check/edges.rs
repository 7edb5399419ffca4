//! Finds inconsistently oriented edges and non-manifold edges.

use std::ops::ControlFlow;

use meshlod_mesh::{FaceId, Side, Twin, VertexId};

use super::Visit;
use super::subject::Subject;
use crate::finding::Finding;

pub fn inconsistent(subject: &Subject, visit: &mut Visit) -> ControlFlow<()> {
    let connectivity = subject.connectivity();
    if connectivity.inconsistent_edges() == 0 {
        return ControlFlow::Continue(());
    }
    let mut found: Vec<([VertexId; 2], [FaceId; 2])> = connectivity
        .edges()
        .filter_map(|side| {
            let Twin::Side(twin) = connectivity.twin(side) else { return None };
            let ends = side.ends(&subject.faces);
            let same_way = ends == twin.ends(&subject.faces);
            same_way.then(|| (lowest_first(ends), lowest_first([side.face(), twin.face()])))
        })
        .collect();
    found.sort_unstable();
    for (edge, faces) in found {
        visit(&Finding::InconsistentEdge { edge, faces })?;
    }
    ControlFlow::Continue(())
}

pub fn non_manifold(subject: &Subject, visit: &mut Visit) -> ControlFlow<()> {
    let connectivity = subject.connectivity();
    if connectivity.non_manifold_edges() == 0 {
        return ControlFlow::Continue(());
    }
    let mut sides: Vec<([VertexId; 2], FaceId)> = (0..subject.faces.len())
        .flat_map(|f| [0, 1, 2].map(|k| Side::new(FaceId(f as u32), k)))
        .filter(|&side| connectivity.twin(side) == Twin::NonManifold)
        .map(|side| (lowest_first(side.ends(&subject.faces)), side.face()))
        .collect();
    sides.sort_unstable();
    for edge in sides.chunk_by(|a, b| a.0 == b.0) {
        let faces = edge.iter().map(|&(_, face)| face).collect();
        visit(&Finding::NonManifoldEdge { edge: edge[0].0, faces })?;
    }
    ControlFlow::Continue(())
}

/// Returns two values with the smaller one first.
pub(crate) fn lowest_first<T: Ord>([a, b]: [T; 2]) -> [T; 2] {
    if a <= b { [a, b] } else { [b, a] }
}
