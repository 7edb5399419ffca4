//! Finds degenerate and duplicate faces.

use std::ops::ControlFlow;

use meshlod_mesh::{Connectivity, FaceId, Side, Twin, VertexId};

use super::Visit;
use super::subject::Subject;
use crate::finding::{Degeneracy, Finding};
use crate::zero_area::has_zero_area;

pub fn degenerate(subject: &Subject, visit: &mut Visit) -> ControlFlow<()> {
    for (face, [a, b, c]) in subject.valid_faces() {
        let at = |v: VertexId| subject.mesh.positions[v.index()];
        let shape = if a == b || b == c || c == a {
            Degeneracy::RepeatedVertex
        } else if has_zero_area([at(a), at(b), at(c)]) {
            Degeneracy::ZeroArea
        } else {
            continue;
        };
        visit(&Finding::DegenerateFace { face, shape })?;
    }
    ControlFlow::Continue(())
}

pub fn duplicate(subject: &Subject, visit: &mut Visit) -> ControlFlow<()> {
    for (face, of) in duplicates(&subject.faces, subject.connectivity()) {
        visit(&Finding::DuplicateFace { face, of })?;
    }
    ControlFlow::Continue(())
}

/// Pairs each face that has the same vertices as an earlier face, in either orientation, with the
/// first such face. Faces that repeat a vertex are left out; lowest id first.
pub(crate) fn duplicates(
    faces: &[[VertexId; 3]],
    connectivity: &Connectivity,
) -> Vec<(FaceId, FaceId)> {
    let mut suspects: Vec<([VertexId; 3], FaceId)> = (0..faces.len())
        .map(|f| FaceId(f as u32))
        .filter(|&face| may_have_duplicate(connectivity, face))
        .map(|face| {
            let mut vertices = faces[face.index()];
            vertices.sort_unstable();
            (vertices, face)
        })
        .collect();
    suspects.sort_unstable();
    let mut found = Vec::new();
    for same in suspects.chunk_by(|a, b| a.0 == b.0) {
        found.extend(same[1..].iter().map(|&(_, face)| (face, same[0].1)));
    }
    found.sort_unstable();
    found
}

/// Returns true if another face may have the same vertices. Such a face lies across each of the
/// three sides, alone or among several.
#[inline]
fn may_have_duplicate(connectivity: &Connectivity, face: FaceId) -> bool {
    let mut other = None;
    (0..3).all(|k| match connectivity.twin(Side::new(face, k)) {
        Twin::NonManifold => true,
        Twin::Side(side) => *other.get_or_insert(side.face()) == side.face(),
        Twin::Boundary | Twin::Degenerate => false,
    })
}
