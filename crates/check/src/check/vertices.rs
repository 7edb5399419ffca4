//! Finds unused and coincident vertices.

use std::ops::ControlFlow;

use meshlod_mesh::VertexId;

use super::Visit;
use super::subject::Subject;
use crate::finding::Finding;

pub fn unused(subject: &Subject, visit: &mut Visit) -> ControlFlow<()> {
    for (v, _) in subject.used().iter().enumerate().filter(|(_, used)| !**used) {
        visit(&Finding::UnusedVertex { vertex: VertexId::new(v) })?;
    }
    ControlFlow::Continue(())
}

pub fn coincident(subject: &Subject, visit: &mut Visit) -> ControlFlow<()> {
    let used = subject.used();
    let finite = |v: VertexId| subject.mesh.positions[v.index()].iter().all(|x| x.is_finite());
    for vertices in subject.unique_positions().groups(|v| used[v.index()] && finite(v)) {
        visit(&Finding::CoincidentVertices { vertices })?;
    }
    ControlFlow::Continue(())
}
