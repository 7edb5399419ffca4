//! Contacts of instances with each other, and vertices that they have at one place.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::ops::ControlFlow;

use meshlod_check::{CheckOptions, Finding, Kind, ObjectId, ObjectsBy};
use meshlod_io::Scene;
use meshlod_mesh::{FaceId, Labels, Mesh, VertexId};

use super::collapsed::{bits, collapsed};
use super::near::NearFaces;
use super::placed::PlacedInstances;
use crate::jobs::Watch;
use crate::jobs::check::{CheckRequest, Contacts, Group};

/// Findings that are of several instances.
#[derive(Default)]
pub struct Between {
    /// Pairs of objects that meet, by the ids of the merged mesh.
    pub contacts: Contacts,
    /// Number of contacts of each group, and the first of each.
    pub counts: BTreeMap<Group, usize>,
    pub listed: Vec<Finding>,
    /// Vertices at one place that are of several instances, or apart in their mesh: each list sorted,
    /// by lowest vertex.
    pub coincident: Vec<Vec<VertexId>>,
    /// Number of instances that were not compared with each other, as there are too many faces.
    pub not_compared: usize,
    /// True if a search among some instances was given up.
    pub is_crowded: bool,
}

/// Faces from which on a batch of pairs is searched. With batches of 2^18 faces, 2,000 copies of 4,000
/// faces take as long as with 2^20, and 100,000 take 100 MB less.
const BATCH: usize = 1 << 18;

/// Most faces of a batch, which holds all pairs of its instances with later ones if it has fewer.
const MOST_IN_BATCH: usize = 4 * BATCH;

/// Most faces that are searched: a few seconds.
pub const MOST_SEARCHED: usize = 1 << 23;

/// Most faces that are looked at for each that may be searched.
const LOOKS: usize = 8;

/// A batch that is given up as crowded costs this part of the search: it takes some seconds itself.
const CROWDED: usize = 8;

/// A scene of copies, with a function from a face of an instance to its object.
#[derive(Clone, Copy)]
pub struct SceneOfCopies<'s> {
    pub scene: &'s Scene,
    pub placed: &'s PlacedInstances,
    pub object: &'s dyn Fn(usize, FaceId) -> ObjectId,
}

/// Looks for what instances have in common, until so many faces are searched or the watch cancels;
/// `None` without faces.
pub fn between(
    scene: &SceneOfCopies<'_>,
    request: &CheckRequest,
    most_searched: usize,
    watch: &dyn Watch,
) -> Option<Between> {
    let near = NearFaces::of(scene.scene, scene.placed)?;
    let (found, mut coincident) = (Between::default(), HashMap::<_, Vec<VertexId>>::new());
    if request.options.kinds.contains(Kind::CoincidentVertices) {
        for (place, vertices) in collapsed(scene.scene, scene.placed) {
            coincident.entry(place).or_default().extend(vertices);
        }
    }
    let left = LOOKS * most_searched;
    let price_of_crowded = left / CROWDED;
    let mut search = Search { scene, request, found, coincident, left, price_of_crowded };
    let mut batch = Batch::default();
    let count = scene.placed.instances.len();
    for instance in (0..count).take_while(|_| !watch.is_cancelled()) {
        for other in near.after(instance) {
            let pair = near.pair([instance, other]);
            let added = batch.add([instance, other], pair.faces);
            if !search.pay(1 + pair.visited + LOOKS * added) {
                search.run(&batch);
                return Some(search.give_up(count - instance));
            }
            if batch.faces >= MOST_IN_BATCH {
                search.run(&std::mem::take(&mut batch));
            }
        }
        // All faces of a batch are compared with each other: pairs of another batch are lost work.
        if batch.faces >= BATCH {
            search.run(&std::mem::take(&mut batch));
        }
    }
    search.run(&batch);
    Some(search.finish())
}

/// Pairs of instances whose faces are searched together.
#[derive(Default)]
struct Batch {
    pairs: Vec<[usize; 2]>,
    faces_of: BTreeMap<usize, HashSet<FaceId>>,
    faces: usize,
}

impl Batch {
    /// Adds a pair; returns how many of its faces are new.
    fn add(&mut self, pair: [usize; 2], faces: [Vec<FaceId>; 2]) -> usize {
        if faces.iter().any(Vec::is_empty) {
            return 0;
        }
        self.pairs.push(pair);
        let before = self.faces;
        for (instance, faces) in pair.into_iter().zip(faces) {
            let known = self.faces_of.entry(instance).or_default();
            self.faces += faces.into_iter().filter(|face| known.insert(*face)).count();
        }
        self.faces - before
    }

    /// Returns the number of instances that are compared with later ones.
    fn compared(&self) -> usize {
        self.pairs.chunk_by(|a, b| a[0] == b[0]).count()
    }
}

/// A search through the batches.
struct Search<'s> {
    scene: &'s SceneOfCopies<'s>,
    request: &'s CheckRequest,
    found: Between,
    /// Vertices that are of several instances, or apart in their mesh, by their place as bits.
    coincident: HashMap<[u64; 3], Vec<VertexId>>,
    /// Work that may still be done, in faces looked at.
    left: usize,
    price_of_crowded: usize,
}

impl Search<'_> {
    /// Takes work from what is left; false if there is not so much.
    fn pay(&mut self, work: usize) -> bool {
        let is_left = work <= self.left;
        self.left = self.left.saturating_sub(work);
        is_left
    }

    fn run(&mut self, batch: &Batch) {
        let is_wanted = |kind: &Kind| self.request.options.kinds.contains(*kind);
        let kinds = [Kind::Contact, Kind::CoincidentVertices].into_iter().filter(is_wanted);
        // Pairs that are lost are counted, whether or not that is to be a finding.
        let crowded = is_wanted(&Kind::Contact).then_some(Kind::Crowded);
        let options = CheckOptions {
            kinds: kinds.chain(crowded).collect(),
            objects: ObjectsBy::Names,
            ..self.request.options
        };
        let merged = MergedFaces::of(self.scene, batch);
        let (mut heard, mut is_crowded) = (0, false);
        let flow = meshlod_check::check(&merged.mesh, &options, &mut |finding| {
            heard += 1;
            match finding {
                Finding::Contact { .. } => self.add_contact(&merged, &batch.pairs, finding),
                Finding::CoincidentVertices { vertices } => self.add_place(&merged, vertices),
                _ => is_crowded = true,
            }
            ControlFlow::Continue(())
        });
        // What is left may be less: that ends the search at the next pair.
        self.pay(LOOKS * heard);
        if is_crowded {
            self.pay(self.price_of_crowded);
            self.found.is_crowded |= self.request.options.kinds.contains(Kind::Crowded);
            self.found.not_compared += batch.compared();
        }
        debug_assert!(flow.is_continue(), "nothing ends it");
    }

    /// Adds a contact of a pair of the batch: another pair has its turn in a later batch.
    fn add_contact(&mut self, merged: &MergedFaces, pairs: &[[usize; 2]], finding: &Finding) {
        let &Finding::Contact { objects, faces, intersection } = finding else { return };
        let faces = faces.map(|face| merged.faces[face.index()]);
        let mut pair = faces.map(|face| self.scene.placed.of_face(face));
        pair.sort_unstable();
        if pairs.binary_search(&pair).is_ok() {
            let objects = objects.map(|object| merged.objects[object.0 as usize]);
            self.found.contacts.add(objects, faces, intersection);
            let count = self.found.counts.entry(Group::of_contact(intersection.kind)).or_default();
            *count += 1;
            if *count <= self.request.limit.max(1) {
                self.found.listed.push(Finding::Contact { objects, faces, intersection });
            }
        }
    }

    fn add_place(&mut self, merged: &MergedFaces, vertices: &[VertexId]) {
        let own = |v: &VertexId| merged.vertices[v.index()];
        let instance = |v: &VertexId| self.scene.placed.of_vertex(own(v));
        let first = instance(&vertices[0]);
        if vertices.iter().all(|v| instance(v) == first) {
            return;
        }
        let place = bits(merged.mesh.positions[vertices[0].index()]);
        self.coincident.entry(place).or_default().extend(vertices.iter().map(own));
    }

    /// Returns what was found before so many instances were compared with each other.
    fn give_up(mut self, not_compared: usize) -> Between {
        // One of them may be in a batch that was crowded.
        let all = self.scene.placed.instances.len();
        self.found.not_compared = all.min(self.found.not_compared + not_compared);
        self.found.is_crowded = self.request.options.kinds.contains(Kind::Crowded);
        self.finish()
    }

    fn finish(mut self) -> Between {
        let mut places: Vec<Vec<VertexId>> = self.coincident.into_values().collect();
        for place in &mut places {
            place.sort_unstable();
            place.dedup();
        }
        places.sort_unstable();
        self.found.coincident = places;
        self.found
    }
}

/// Faces of instances in one mesh, in their order in the mesh that the scene would be merged into.
#[derive(Default)]
struct MergedFaces {
    mesh: Mesh,
    /// Ids of its vertices, faces and objects in the merged scene.
    vertices: Vec<VertexId>,
    faces: Vec<FaceId>,
    objects: Vec<ObjectId>,
}

impl MergedFaces {
    fn of(scene: &SceneOfCopies<'_>, batch: &Batch) -> Self {
        let (mut merged, mut of_face) = (Self::default(), Vec::new());
        for (&instance, faces) in &batch.faces_of {
            let mut faces: Vec<FaceId> = faces.iter().copied().collect();
            faces.sort_unstable();
            merged.add(scene, instance, &faces);
            of_face.extend(faces.iter().map(|face| (scene.object)(instance, *face)));
        }
        merged.objects = of_face.clone();
        merged.objects.sort_unstable();
        merged.objects.dedup();
        let label = |object| merged.objects.partition_point(|known| *known < object) as u32;
        merged.mesh.objects = Some(Labels {
            of_face: of_face.into_iter().map(label).collect(),
            names: vec![String::new(); merged.objects.len()],
        });
        merged
    }

    /// Adds faces of an instance, in the order of their ids.
    fn add(&mut self, scene: &SceneOfCopies<'_>, instance: usize, faces: &[FaceId]) {
        let own = &scene.placed.instances[instance];
        let mesh = &scene.scene.meshes[own.shown.mesh].mesh;
        let mut used: Vec<VertexId> =
            faces.iter().flat_map(|face| mesh.faces[face.index()]).collect();
        used.sort_unstable();
        used.dedup();
        let first = self.mesh.positions.len();
        let mirrors = own.shown.mirrors();
        for face in faces {
            let [a, b, c] = mesh.faces[face.index()]
                .map(|v| VertexId::new(first + used.partition_point(|known| *known < v)));
            self.mesh.faces.push(if mirrors { [a, c, b] } else { [a, b, c] });
            self.faces.push(own.face(*face));
        }
        self.mesh.positions.extend(used.iter().map(|v| own.point(mesh.positions[v.index()])));
        self.vertices.extend(used.iter().map(|v| own.vertex(*v)));
    }
}
