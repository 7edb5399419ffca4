//! Results of a mesh check, collected for its reports.

use std::ops::ControlFlow;

use meshlod::Mesh;
use meshlod::check::{CheckOptions, Finding, Kind, Kinds, Objects, Severity, Summary, check};

use crate::check::contacts::Contacts;
use crate::check::marks::Marks;

/// A mesh with the results of its check.
pub struct Inspection {
    pub mesh: Mesh,
    pub objects: Objects,
    pub summary: Summary,
    /// The first findings of each kind: as many as requested, and at least one.
    pub findings: Vec<Finding>,
    /// Largest number of findings listed of each kind.
    pub limit: usize,
    pub contacts: Contacts,
    /// Marks for the pictures of a report page, if one is requested.
    pub marks: Option<Marks>,
    pub kinds: Kinds,
}

/// Options for collecting the results of a mesh check.
pub struct InspectionOptions {
    pub options: CheckOptions,
    /// Largest number of findings listed of each kind.
    pub limit: usize,
    /// True to collect marks for the pictures of a report page.
    pub marks: bool,
}

impl Inspection {
    pub fn of(mesh: Mesh, order: InspectionOptions) -> Self {
        let InspectionOptions { options, limit, marks } = order;
        let mut this = Self {
            objects: Objects::of(&mesh, options.objects),
            summary: Summary::default(),
            findings: Vec::new(),
            limit,
            contacts: Contacts::default(),
            marks: marks.then(|| Marks::new(&mesh)),
            kinds: options.kinds,
            mesh: Mesh::default(),
        };
        let _ = check(&mesh, &options, &mut |finding| {
            this.add(&mesh, finding);
            ControlFlow::Continue(())
        });
        Self { mesh, ..this }
    }

    fn add(&mut self, mesh: &Mesh, finding: &Finding) {
        self.summary.add(finding);
        if self.summary.count(finding.kind()) <= self.limit.max(1) {
            self.findings.push(finding.clone());
        }
        if let &Finding::Contact { objects, faces, intersection } = finding {
            self.contacts.add(objects, faces, intersection);
        }
        if let Some(marks) = &mut self.marks {
            marks.add(mesh, &self.objects, finding);
        }
    }

    /// Returns the first finding of this kind.
    pub fn first(&self, kind: Kind) -> Option<&Finding> {
        self.findings.iter().find(|finding| finding.kind() == kind)
    }

    /// Iterates over the findings that reports list in full.
    pub fn listed(&self) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(|_| self.limit > 0)
    }

    /// Returns the number of findings of this kind that reports do not list.
    pub fn left_out(&self, kind: Kind) -> usize {
        self.summary.count(kind).saturating_sub(self.limit)
    }

    pub fn errors(&self) -> usize {
        self.summary.of_severity(Severity::Error)
    }

    pub fn warnings(&self) -> usize {
        self.summary.of_severity(Severity::Warning)
    }

    /// Returns the name of an object of the mesh.
    pub fn name(&self, object: meshlod::check::ObjectId) -> &str {
        self.objects.names.get(object.0 as usize).map_or("", String::as_str)
    }
}
