//! Counts of the findings of a mesh check, by kind.

use crate::finding::{Finding, Kind, Severity};

/// Counts of the findings of a mesh check, by kind.
///
/// ```
/// use std::ops::ControlFlow;
/// use meshlod_check::{CheckOptions, Kind, Summary, check};
/// use meshlod_samples as samples;
///
/// let mut summary = Summary::default();
/// let _ = check(&samples::terrain(1000), &CheckOptions::default(), &mut |finding| {
///     summary.add(finding);
///     ControlFlow::Continue(())
/// });
/// assert_eq!((summary.count(Kind::BoundaryLoop), summary.total()), (1, 1));
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Summary {
    counts: [usize; Kind::ALL.len()],
}

impl Summary {
    /// Adds one finding to the counts.
    pub fn add(&mut self, finding: &Finding) {
        self.add_many(finding.kind(), 1);
    }

    /// Adds a number of findings of one kind.
    pub fn add_many(&mut self, kind: Kind, count: usize) {
        self.counts[kind as usize] += count;
    }

    /// Returns the number of findings of this kind.
    pub fn count(&self, kind: Kind) -> usize {
        self.counts[kind as usize]
    }

    /// Returns the number of findings of this severity.
    pub fn of_severity(&self, severity: Severity) -> usize {
        self.found().filter(|(kind, _)| kind.severity() == severity).map(|(_, count)| count).sum()
    }

    /// Returns the total number of findings.
    pub fn total(&self) -> usize {
        self.counts.iter().sum()
    }

    /// Returns the highest severity among the findings; `None` if there are no findings.
    pub fn worst(&self) -> Option<Severity> {
        self.found().map(|(kind, _)| kind.severity()).max()
    }

    /// Iterates over the kinds with at least one finding, in the order of [`Kind::ALL`], with their
    /// counts.
    pub fn found(&self) -> impl Iterator<Item = (Kind, usize)> + '_ {
        Kind::ALL.into_iter().map(|kind| (kind, self.count(kind))).filter(|&(_, count)| count > 0)
    }
}

/// Writes the counts of the kinds that were found under their names.
#[cfg(feature = "serde")]
impl serde::Serialize for Summary {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.found())
    }
}

impl<'a> FromIterator<&'a Finding> for Summary {
    fn from_iter<I: IntoIterator<Item = &'a Finding>>(findings: I) -> Self {
        let mut summary = Self::default();
        findings.into_iter().for_each(|finding| summary.add(finding));
        summary
    }
}

#[cfg(test)]
mod tests {
    use meshlod_mesh::VertexId;

    use super::*;

    #[test]
    fn one_error_outweighs_warnings() {
        let unused = Finding::UnusedVertex { vertex: VertexId(1) };
        let mut summary: Summary = [&unused, &unused].into_iter().collect();
        assert_eq!(
            (summary.worst(), summary.of_severity(Severity::Error)),
            (Some(Severity::Warning), 0)
        );
        summary.add(&Finding::NonFiniteVertex { vertex: VertexId(0) });
        assert_eq!(
            (summary.worst(), summary.of_severity(Severity::Error)),
            (Some(Severity::Error), 1)
        );
        let found = [(Kind::NonFiniteVertex, 1), (Kind::UnusedVertex, 2)];
        assert!(summary.found().eq(found) && summary.total() == 3);
    }

    #[test]
    fn nothing_has_no_severity() {
        assert_eq!(Summary::default().worst(), None);
    }
}
