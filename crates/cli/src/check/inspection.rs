//! Results of a mesh check, collected for its reports.

use std::collections::BTreeMap;
use std::ops::ControlFlow;

use meshlod::Mesh;
use meshlod::check::{CheckOptions, Finding, Kind, Kinds, ObjectId, Objects, Summary, check};

use crate::check::contacts::Contacts;
use crate::check::group::{Grade, Group, Ownership};
use crate::check::marks::Marks;

/// A mesh with the results of its check.
pub struct Inspection {
    pub mesh: Mesh,
    pub owners: Ownership,
    pub summary: Summary,
    /// Number of findings in each group.
    groups: BTreeMap<Group, usize>,
    /// The first findings of each group, in the order of [`Kind::ALL`]: as many as requested, and at
    /// least one.
    findings: Vec<(Group, Finding)>,
    /// Largest number of findings listed of each group.
    pub limit: usize,
    pub contacts: Contacts,
    /// Marks for the pictures of a report page, if one is requested.
    pub marks: Option<Marks>,
    pub kinds: Kinds,
}

/// Options for collecting the results of a mesh check.
pub struct InspectionOptions {
    pub options: CheckOptions,
    /// Largest number of findings listed of each group.
    pub limit: usize,
    /// True to collect marks for the pictures of a report page.
    pub marks: bool,
}

impl Inspection {
    pub fn of(mesh: Mesh, order: InspectionOptions) -> Self {
        let InspectionOptions { options, limit, marks } = order;
        let mut this = Self {
            owners: Ownership::new(&mesh, Objects::of(&mesh, options.objects)),
            summary: Summary::default(),
            groups: BTreeMap::new(),
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
        let group = self.owners.group(finding);
        let count = self.groups.entry(group).or_default();
        *count += 1;
        if *count <= self.limit.max(1) {
            self.findings.push((group, finding.clone()));
        }
        if let &Finding::Contact { objects, faces, intersection } = finding {
            self.contacts.add(objects, faces, intersection);
        }
        if let Some(marks) = &mut self.marks {
            marks.add(mesh, &self.owners.objects, finding);
        }
    }

    /// Iterates over the groups with at least one finding, with their counts, errors first.
    pub fn groups(&self) -> impl Iterator<Item = (Group, usize)> {
        self.groups.iter().map(|(&group, &count)| (group, count))
    }

    /// Iterates over the first findings of a group; at least one.
    pub fn first_of(&self, group: Group) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(move |(of, _)| *of == group).map(|(_, finding)| finding)
    }

    /// Iterates over the findings that reports list in full.
    pub fn listed(&self) -> impl Iterator<Item = &(Group, Finding)> {
        self.findings.iter().filter(|_| self.limit > 0)
    }

    /// Returns the number of findings of this kind that reports do not list.
    pub fn left_out(&self, kind: Kind) -> usize {
        let groups = self.groups().filter(|(group, _)| group.kind == kind);
        groups.map(|(_, count)| count.saturating_sub(self.limit)).sum()
    }

    /// Returns the number of findings of this grade.
    pub fn count(&self, grade: Grade) -> usize {
        self.groups().filter(|(group, _)| group.grade == grade).map(|(_, count)| count).sum()
    }

    /// Returns the name of an object of the mesh.
    pub fn name(&self, object: ObjectId) -> &str {
        self.owners.objects.names.get(object.0 as usize).map_or("", String::as_str)
    }
}
