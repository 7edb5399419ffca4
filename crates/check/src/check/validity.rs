//! Finds invalid data: non-finite positions, indices out of range, arrays of the wrong size.

use std::ops::ControlFlow;

use meshlod_mesh::{FaceId, VertexId};

use super::Visit;
use super::subject::Subject;
use crate::finding::Finding;

pub fn non_finite_vertices(subject: &Subject, visit: &mut Visit) -> ControlFlow<()> {
    let positions = subject.mesh.positions.iter().enumerate();
    for (v, _) in positions.filter(|(_, p)| p.iter().any(|x| !x.is_finite())) {
        visit(&Finding::NonFiniteVertex { vertex: VertexId::new(v) })?;
    }
    ControlFlow::Continue(())
}

pub fn bad_indices(subject: &Subject, visit: &mut Visit) -> ControlFlow<()> {
    if subject.all_valid {
        return ControlFlow::Continue(());
    }
    for (f, face) in subject.mesh.faces.iter().enumerate() {
        let missing = face.iter().find(|v| v.index() >= subject.mesh.positions.len());
        if let Some(&vertex) = missing {
            visit(&Finding::BadIndex { face: FaceId::new(f), vertex })?;
        }
    }
    ControlFlow::Continue(())
}

pub fn bad_attributes(subject: &Subject, visit: &mut Visit) -> ControlFlow<()> {
    match subject.mesh.validate_attributes() {
        Ok(()) => ControlFlow::Continue(()),
        Err(error) => visit(&Finding::BadAttributes { error }),
    }
}
