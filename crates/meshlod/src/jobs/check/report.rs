//! Findings of a check, counted and listed.

use std::collections::BTreeMap;
use std::fmt;

use meshlod_check::{Finding, Kind, Kinds, ObjectId, Severity, Summary};
use meshlod_mesh::Mesh;

use super::{CheckRequest, Contacts, Grade, Group, Ownership};

/// Findings of a check: how many of each kind and urgency, the first of them, and the contacts
/// between objects.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct CheckReport {
    /// Number of vertices.
    pub vertices: usize,
    /// Number of faces.
    pub faces: usize,
    /// The objects of the mesh, with the owners of its vertices; without the owners in a scene of
    /// [copies](super::check_scene).
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub owners: Ownership,
    /// Kinds that were looked for.
    pub kinds: Kinds,
    /// Number of findings of each kind.
    pub summary: Summary,
    /// The first findings of each group, at least one, in the order in which they were found.
    pub findings: Vec<Finding>,
    /// Maximum number of findings listed of each group.
    pub limit: usize,
    /// Number of instances of a scene of [copies](super::check_scene) that were not compared with
    /// others, as too many faces lie close together: what they have in common may be missing.
    pub not_compared: usize,
    /// Contacts by pairs of objects.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub contacts: Contacts,
    #[cfg_attr(feature = "serde", serde(skip))]
    groups: BTreeMap<Group, usize>,
    /// Groups, objects and places of the listed findings.
    #[cfg_attr(feature = "serde", serde(skip))]
    details: Vec<Details>,
}

/// Group, objects and place of a finding.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Details {
    pub group: Group,
    pub objects: Vec<ObjectId>,
    pub place: Option<[f64; 3]>,
}

/// A finding that a report lists.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ListedFinding<'r> {
    /// The finding, with its ids.
    pub finding: &'r Finding,
    /// Kind and urgency.
    pub group: Group,
    /// Objects that it concerns, each once, in the order of the finding's ids.
    pub objects: &'r [ObjectId],
    /// Position, as [`Finding::place`] returns it.
    pub place: Option<[f64; 3]>,
}

impl CheckReport {
    /// Creates the report of a check of so many vertices and faces that has found nothing yet.
    pub(super) fn new(
        [vertices, faces]: [usize; 2],
        owners: Ownership,
        request: &CheckRequest,
    ) -> Self {
        Self {
            vertices,
            faces,
            owners,
            kinds: request.options.kinds,
            summary: Summary::default(),
            findings: Vec::new(),
            limit: request.limit,
            not_compared: 0,
            contacts: Contacts::default(),
            groups: BTreeMap::new(),
            details: Vec::new(),
        }
    }

    /// Adds a finding of the mesh that is checked.
    pub(super) fn add(&mut self, mesh: &Mesh, finding: &Finding) {
        let group = self.owners.group(finding);
        self.count_more(group, 1);
        if self.groups[&group] <= self.limit.max(1) {
            let (objects, place) = (self.owners.of(finding), finding.place(mesh));
            self.list(finding.clone(), Details { group, objects, place });
        }
        if let &Finding::Contact { objects, faces, intersection } = finding {
            self.contacts.add(objects, faces, intersection);
        }
    }

    /// Counts findings of a group.
    pub(super) fn count_more(&mut self, group: Group, count: usize) {
        self.summary.add_many(group.kind, count);
        *self.groups.entry(group).or_default() += count;
    }

    /// Lists a finding, which is counted by itself.
    pub(super) fn list(&mut self, finding: Finding, details: Details) {
        self.findings.push(finding);
        self.details.push(details);
    }

    /// Returns true if nothing was found in a search that is complete.
    pub fn is_clean(&self) -> bool {
        self.summary.total() == 0 && self.not_compared == 0
    }

    /// Returns true if a finding is an error.
    pub fn has_errors(&self) -> bool {
        self.summary.worst() == Some(Severity::Error)
    }

    /// Iterates over the listed findings of a kind.
    pub fn of(&self, kind: Kind) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(move |finding| finding.kind() == kind)
    }

    /// Iterates over the groups of findings with their numbers, errors first.
    pub fn groups(&self) -> impl Iterator<Item = (Group, usize)> {
        self.groups.iter().map(|(&group, &count)| (group, count))
    }

    /// Iterates over the listed findings with their groups, objects and places.
    pub fn listed(&self) -> impl Iterator<Item = ListedFinding<'_>> {
        self.findings.iter().zip(&self.details).map(|(finding, details)| ListedFinding {
            finding,
            group: details.group,
            objects: &details.objects,
            place: details.place,
        })
    }

    /// Iterates over the first findings of a group; at least one.
    pub fn of_group(&self, group: Group) -> impl Iterator<Item = ListedFinding<'_>> {
        self.listed().filter(move |found| found.group == group)
    }

    /// Returns the number of findings of a kind that are not listed.
    pub fn left_out(&self, kind: Kind) -> usize {
        let groups = self.groups().filter(|(group, _)| group.kind == kind);
        groups.map(|(_, count)| count.saturating_sub(self.limit)).sum()
    }

    /// Returns the number of findings of an urgency.
    pub fn count(&self, grade: Grade) -> usize {
        self.groups().filter(|(group, _)| group.grade == grade).map(|(_, count)| count).sum()
    }

    /// Returns the name of an object; empty if it has none.
    pub fn name(&self, object: ObjectId) -> &str {
        self.owners.objects.names.get(object.0 as usize).map_or("", String::as_str)
    }
}

/// Prints the number of findings of each kind, a line each, or `clean`.
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
