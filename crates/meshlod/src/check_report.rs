//! Checking a mesh in one call, with a report of what was found.

use std::fmt;
use std::ops::ControlFlow;

use meshlod_check::{CheckOptions, Finding, Kind, Objects, Severity, Summary, check};
use meshlod_mesh::Mesh;

/// Findings of a mesh check: all of them counted, the first of each kind listed.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct CheckReport {
    /// Objects of the mesh, which the findings refer to by index.
    pub objects: Objects,
    /// Number of findings of each kind.
    pub summary: Summary,
    /// First findings of each kind, up to the requested number, in the order of [`Kind::ALL`].
    pub findings: Vec<Finding>,
}

impl CheckReport {
    /// Returns true if the check found neither errors nor warnings.
    pub fn is_clean(&self) -> bool {
        self.summary.total() == 0
    }

    /// Returns true if the check found at least one error; warnings do not count.
    pub fn has_errors(&self) -> bool {
        self.summary.worst() == Some(Severity::Error)
    }

    /// Iterates over the listed findings of one kind.
    pub fn of(&self, kind: Kind) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(move |finding| finding.kind() == kind)
    }
}

/// Prints one line for each kind found, with the number of its findings, or `clean` if nothing was
/// found.
impl fmt::Display for CheckReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_clean() {
            return f.write_str("clean");
        }
        for (i, (kind, count)) in self.summary.found().enumerate() {
            let newline = if i == 0 { "" } else { "\n" };
            write!(f, "{newline}{}: {count}", kind.name())?;
        }
        Ok(())
    }
}

/// Checks a mesh and reports the findings: counts of all of them, and at most `limit` of each kind
/// in full.
///
/// Any mesh is accepted, also one that [`Mesh::validate`] refuses. [`check`](crate::check) has the
/// kinds of findings, and a visitor for those who want to stop early.
///
/// Cost: linear, except for intersections of faces.
///
/// ```
/// use meshlod::check::{CheckOptions, Kind};
/// use meshlod::{check_report, samples};
///
/// let mut mesh = samples::sphere(500);
/// assert!(check_report(&mesh, &CheckOptions::default(), 10).is_clean());
///
/// mesh.faces.pop();
/// let report = check_report(&mesh, &CheckOptions::default(), 10);
/// assert_eq!(report.summary.count(Kind::BoundaryLoop), 1);
/// assert_eq!(report.to_string(), "boundary-loop: 1");
/// ```
pub fn check_report(mesh: &Mesh, options: &CheckOptions, limit: usize) -> CheckReport {
    let objects = Objects::of(mesh, options.objects);
    let (mut summary, mut findings) = (Summary::default(), Vec::new());
    let _ = check(mesh, options, &mut |finding| {
        summary.add(finding);
        if summary.count(finding.kind()) <= limit {
            findings.push(finding.clone());
        }
        ControlFlow::Continue(())
    });
    CheckReport { objects, summary, findings }
}

#[cfg(test)]
mod tests {
    use meshlod_mesh::VertexId;
    use meshlod_samples as samples;

    use super::*;

    #[test]
    fn all_are_counted_and_some_listed() {
        let mut mesh = samples::sphere(100);
        mesh.positions.extend([[0.0; 3], [1.0; 3], [2.0; 3]]);
        mesh.faces.push([VertexId(0), VertexId(0), VertexId(1)]);
        let report = check_report(&mesh, &CheckOptions::default(), 2);
        assert_eq!(report.summary.count(Kind::UnusedVertex), 3);
        assert_eq!(report.of(Kind::UnusedVertex).count(), 2);
        assert_eq!(report.of(Kind::DegenerateFace).count(), 1);
        assert!(!report.is_clean());
        let errors = Kind::DegenerateFace.severity() == Severity::Error;
        assert_eq!(report.has_errors(), errors);
        assert_eq!(report.to_string(), "unused-vertex: 3\ndegenerate-face: 1");
    }
}
