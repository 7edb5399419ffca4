use meshlod_check::{Kind, Severity};
use meshlod_mesh::VertexId;
use meshlod_samples as samples;

use super::*;

fn report(mesh: &Mesh, limit: usize) -> CheckReport {
    check(mesh, &CheckRequest { limit, ..CheckRequest::default() }, &()).unwrap()
}

#[test]
fn all_are_counted_and_some_listed() {
    let mut mesh = samples::sphere(100);
    mesh.positions.extend([[0.0; 3], [1.0; 3], [2.0; 3]]);
    mesh.faces.push([VertexId(0), VertexId(0), VertexId(1)]);
    let report = report(&mesh, 2);
    assert_eq!(report.summary.count(Kind::UnusedVertex), 3);
    assert_eq!(report.of(Kind::UnusedVertex).count(), 2);
    assert_eq!(report.of(Kind::DegenerateFace).count(), 1);
    assert!(!report.is_clean());
    let errors = Kind::DegenerateFace.severity() == Severity::Error;
    assert_eq!(report.has_errors(), errors);
    assert_eq!(report.to_string(), "unused-vertex: 3\ndegenerate-face: 1");
}
