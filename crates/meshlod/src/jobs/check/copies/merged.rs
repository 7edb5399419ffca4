//! The report of a scene of copies, merged from those of its meshes and what instances share.

use std::collections::{BTreeMap, HashSet};

use meshlod_check::{Finding, Kind};
use meshlod_mesh::VertexId;

use super::CheckedMeshes;
use super::between::Between;
use crate::jobs::check::contacts::ObjectPair;
use crate::jobs::check::report::Details;
use crate::jobs::check::{CheckReport, CheckRequest, Grade, Group, Ownership};

/// Instances of a mesh whose pairs of objects are listed, at least: text shows some, whatever the
/// limit.
const LEAST_LISTED: usize = 100;

/// A report in the making.
pub(super) struct MergedReport<'m> {
    meshes: &'m CheckedMeshes<'m>,
    report: CheckReport,
    counts: BTreeMap<Group, usize>,
    listed: Vec<(Finding, Details)>,
    /// Lists of vertices at one place of a mesh that are part of a longer list: each by its instance
    /// and first vertex.
    joined: HashSet<(usize, VertexId)>,
}

impl<'m> MergedReport<'m> {
    pub fn new(meshes: &'m CheckedMeshes<'m>, request: &CheckRequest) -> Self {
        let owners = Ownership::of_objects(meshes.objects.clone());
        let sizes = [meshes.placed.vertices, meshes.placed.faces];
        Self {
            meshes,
            report: CheckReport::new(sizes, owners, request),
            counts: BTreeMap::new(),
            listed: Vec::new(),
            joined: HashSet::new(),
        }
    }

    /// Adds all findings and returns the report.
    pub fn finish(mut self, between: Between) -> CheckReport {
        let times = self.times();
        self.count_own(&times);
        self.add_pairs(&times);
        self.report.not_compared = between.not_compared;
        self.add_between(between);
        self.list_own();
        self.list_in_order();
        self.report
    }

    /// Returns the number of instances of each mesh.
    fn times(&self) -> Vec<usize> {
        let mut times = vec![0; self.meshes.reports.len()];
        self.meshes.placed.instances.iter().for_each(|own| times[own.shown.mesh] += 1);
        times
    }

    /// Counts the findings of each mesh for all its instances.
    fn count_own(&mut self, times: &[usize]) {
        for (own, times) in self.meshes.reports.iter().zip(times) {
            for (group, count) in own.iter().flat_map(CheckReport::groups) {
                *self.counts.entry(group).or_default() += count * times;
            }
        }
        // However many searches are given up, that is one finding.
        self.counts.retain(|group, _| group.kind != Kind::Crowded);
    }

    /// Adds the pairs of objects of each mesh that meet, for all its instances.
    fn add_pairs(&mut self, times: &[usize]) {
        let most = self.report.limit.max(LEAST_LISTED);
        let mut left: Vec<usize> = times.iter().map(|times| most.min(*times)).collect();
        for (i, placed) in self.meshes.placed.instances.iter().enumerate() {
            let mesh = placed.shown.mesh;
            if left[mesh] == 0 {
                continue;
            }
            left[mesh] -= 1;
            for (objects, pair) in self.meshes.report(mesh).contacts.by_size() {
                let deepest = placed.touch(pair.deepest);
                let faces = pair.faces.map(|face| placed.face(face));
                let objects = objects.map(|own| self.meshes.object(i, own));
                let pair = ObjectPair { counts: pair.counts, deepest, faces };
                self.report.contacts.add_pair(objects, pair);
            }
        }
        for (own, times) in self.meshes.reports.iter().zip(times) {
            let pairs = own.iter().flat_map(|own| own.contacts.by_size());
            let more = times.saturating_sub(most);
            pairs.for_each(|(_, pair)| self.report.contacts.count_more(pair, more));
        }
    }

    /// Adds what instances have in common.
    fn add_between(&mut self, between: Between) {
        for (objects, pair) in between.contacts.by_size() {
            self.report.contacts.add_pair(objects, pair.clone());
        }
        for (group, count) in between.counts {
            *self.counts.entry(group).or_default() += count;
        }
        for finding in between.listed {
            let Finding::Contact { objects, intersection, .. } = &finding else { continue };
            let group = Group::of_contact(intersection.kind);
            let (objects, place) = (objects.to_vec(), Some(intersection.point));
            self.listed.push((finding, Details { group, objects, place }));
        }
        between.coincident.into_iter().for_each(|vertices| self.add_joined(vertices));
        let mut own = self.meshes.reports.iter().flatten();
        let is_given_up = own.any(|own| own.summary.count(Kind::Crowded) > 0);
        if is_given_up || between.is_crowded {
            self.add_crowded();
        }
    }

    /// Adds vertices at one place, of several instances or apart in their mesh, instead of the lists
    /// of vertices that a mesh has there.
    fn add_joined(&mut self, vertices: Vec<VertexId>) {
        let placed = self.meshes.placed;
        for own in vertices.chunk_by(|a, b| placed.of_vertex(*a) == placed.of_vertex(*b)) {
            let instance = placed.of_vertex(own[0]);
            for list in self.meshes.at_one_place_in_mesh(own) {
                self.joined.insert((instance, placed.instances[instance].own_vertex(list[0])));
                let group = self.meshes.group_at_one_place(&list);
                let count = self.counts.entry(group).or_default();
                debug_assert!(*count > 0, "the report of the mesh counts it");
                *count = count.saturating_sub(1);
            }
        }
        let group = self.meshes.group_at_one_place(&vertices);
        let count = self.counts.entry(group).or_default();
        *count += 1;
        let objects = self.meshes.objects_of(&vertices);
        let place = self.meshes.place_of(vertices[0]);
        let details = Details { group, objects, place: Some(place) };
        self.listed.push((Finding::CoincidentVertices { vertices }, details));
    }

    fn add_crowded(&mut self) {
        let group = Group { grade: Grade::Warning, kind: Kind::Crowded };
        let found = |kind| {
            let groups = self.counts.iter().filter(|(group, _)| group.kind == kind);
            groups.map(|(_, count)| count).sum::<usize>()
        };
        let found = found(Kind::SelfIntersection) + found(Kind::Contact);
        self.counts.insert(group, 1);
        let details = Details { group, objects: Vec::new(), place: None };
        self.listed.push((Finding::Crowded { found }, details));
    }

    /// Lists the first findings of each mesh for each of its instances, up to the limit.
    fn list_own(&mut self) {
        let most = self.report.limit.max(1);
        let mut listed: BTreeMap<Group, usize> = BTreeMap::new();
        for (i, placed) in self.meshes.placed.instances.iter().enumerate() {
            let own = self.meshes.report(placed.shown.mesh);
            let is_full = |group: &Group| listed.get(group).is_some_and(|count| *count >= most);
            if own.groups().all(|(group, _)| is_full(&group)) {
                continue;
            }
            for found in own.listed().filter(|found| found.group.kind != Kind::Crowded) {
                let count = listed.entry(found.group).or_default();
                if *count >= most || self.is_joined(i, found.finding) {
                    continue;
                }
                *count += 1;
                let object = |own| self.meshes.object(i, own);
                let details = Details {
                    group: found.group,
                    objects: found.objects.iter().copied().map(object).collect(),
                    place: found.place.map(|at| placed.point(at)),
                };
                self.listed.push((placed.finding(found.finding, object), details));
            }
        }
    }

    fn is_joined(&self, instance: usize, own: &Finding) -> bool {
        match own {
            Finding::CoincidentVertices { vertices } => {
                self.joined.contains(&(instance, vertices[0]))
            }
            _ => false,
        }
    }

    /// Gives the report the counts and, in the order of a check, the first findings.
    fn list_in_order(&mut self) {
        let most = self.report.limit.max(1);
        self.counts.retain(|_, count| *count > 0);
        self.counts.iter().for_each(|(group, count)| self.report.count_more(*group, *count));
        // Other kinds are in order: no two instances have such findings together.
        self.listed.sort_by_key(|(finding, details)| {
            let ids = match finding {
                Finding::CoincidentVertices { vertices } => [vertices[0].0, vertices[1].0],
                Finding::Contact { faces: [a, b], .. } => [a.0.min(b.0), a.0.max(b.0)],
                _ => [0; 2],
            };
            (details.group.kind, ids)
        });
        let mut listed: BTreeMap<Group, usize> = BTreeMap::new();
        for (finding, details) in std::mem::take(&mut self.listed) {
            let count = listed.entry(details.group).or_default();
            *count += 1;
            if *count <= most {
                self.report.list(finding, details);
            }
        }
    }
}
