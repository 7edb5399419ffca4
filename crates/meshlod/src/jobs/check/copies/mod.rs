//! Checking a scene that shows its meshes many times: each mesh once, and where instances meet.

mod between;
mod collapsed;
mod merged;
mod near;
mod placed;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, HashSet};

use meshlod_check::{Kind, Kinds, ObjectId, Objects, ObjectsBy};
use meshlod_io::Scene;
use meshlod_mesh::{FaceId, VertexId};

use self::between::{Between, MOST_SEARCHED, SceneOfCopies, between};
use self::collapsed::bits;
use self::merged::MergedReport;
pub use self::placed::PlacedInstances;
use super::{CheckReport, CheckRequest, Grade, Group, look_through};
use crate::jobs::{About, JobError, Remark, Watch};
use crate::numbers::count;

/// Checks the meshes of a scene of copies, and what the copies have in common; `None` if these overlap
/// so much that it is less work to check the merged scene.
pub fn check(
    scene: &Scene,
    placed: &PlacedInstances,
    request: &CheckRequest,
    watch: &dyn Watch,
) -> Result<Option<CheckReport>, JobError> {
    let most_searched = MOST_SEARCHED.min(placed.faces);
    let report = check_within(most_searched, (scene, placed), request, watch)?;
    if report.not_compared > 0 && placed.faces <= MOST_SEARCHED {
        return Ok(None);
    }
    if report.not_compared > 0 {
        let numbers = [report.not_compared, placed.instances.len()];
        watch.remark(&Remark::new(About::Input, incomplete(numbers, request.options.kinds)));
    }
    Ok(Some(report))
}

/// Checks a scene of copies, and compares instances with each other until so many faces are searched.
fn check_within(
    most_searched: usize,
    (scene, placed): (&Scene, &PlacedInstances),
    request: &CheckRequest,
    watch: &dyn Watch,
) -> Result<CheckReport, JobError> {
    let meshes = CheckedMeshes::of(scene, placed, request, watch)?;
    let between = meshes.between(most_searched, request, watch);
    match watch.is_cancelled() {
        true => Err(JobError::Cancelled),
        false => Ok(MergedReport::new(&meshes, request).finish(between)),
    }
}

/// Says how many instances of all were not compared, and what may be missing of these kinds.
fn incomplete([not_compared, all]: [usize; 2], kinds: Kinds) -> String {
    let missing = match [Kind::Contact, Kind::CoincidentVertices].map(|kind| kinds.contains(kind)) {
        [true, true] => "Contacts and coincident vertices",
        [true, false] => "Contacts",
        [false, _] => "Coincident vertices",
    };
    format!(
        "{} of {} instances were not compared: too many faces lie close together. {missing} may be \
         missing.",
        count(not_compared),
        count(all)
    )
}

/// Meshes of a scene, each checked in its own place.
struct CheckedMeshes<'s> {
    scene: &'s Scene,
    placed: &'s PlacedInstances,
    /// By mesh; `None` if it is not shown.
    reports: Vec<Option<CheckReport>>,
    /// By instance: the id of its first object.
    first_objects: Vec<u32>,
    /// Objects of the merged scene, without their faces.
    objects: Objects,
}

impl<'s> CheckedMeshes<'s> {
    fn of(
        scene: &'s Scene,
        placed: &'s PlacedInstances,
        request: &CheckRequest,
        watch: &dyn Watch,
    ) -> Result<Self, JobError> {
        let mut own = request.clone();
        if own.options.objects == ObjectsBy::Auto {
            // Every instance has a name.
            own.options.objects = ObjectsBy::Names;
        }
        let mut reports: Vec<Option<CheckReport>> = vec![None; scene.meshes.len()];
        for index in placed.instances.iter().map(|own| own.shown.mesh) {
            if reports[index].is_none() {
                let mesh = &scene.meshes[index].mesh;
                reports[index] = Some(look_through(mesh, &own, watch, &mut |_, _| {})?);
            }
        }
        let objects = Objects {
            of_face: Vec::new(),
            names: Vec::new(),
            component_of_face: Vec::new(),
            components: 0,
        };
        let mut meshes = Self { scene, placed, reports, first_objects: Vec::new(), objects };
        meshes.name_objects(own.options.objects);
        Ok(meshes)
    }

    /// Lists the objects of all instances.
    fn name_objects(&mut self, by: ObjectsBy) {
        let (mut names, mut components, mut firsts) = (Vec::new(), 0, Vec::new());
        for own in &self.placed.instances {
            firsts.push(names.len() as u32);
            let of_mesh = &self.report(own.shown.mesh).owners.objects;
            let labels = self.scene.meshes[own.shown.mesh].mesh.objects.as_ref();
            let own = self.scene.names_of_instance(&own.shown);
            match by {
                ObjectsBy::Components => {
                    let owner = |face| &*own[labels.map_or(0, |labels| labels.of(face) as usize)];
                    names.extend(named_components(of_mesh, names.len(), owner));
                }
                _ => names.extend_from_slice(&own),
            }
            components += of_mesh.components;
        }
        self.first_objects = firsts;
        (self.objects.names, self.objects.components) = (names, components);
    }

    fn report(&self, mesh: usize) -> &CheckReport {
        self.reports[mesh].as_ref().expect("it is shown")
    }

    fn of_instance(&self, instance: usize) -> &CheckReport {
        self.report(self.placed.instances[instance].shown.mesh)
    }

    /// Returns the id of an object of an instance.
    fn object(&self, instance: usize, own: ObjectId) -> ObjectId {
        ObjectId(self.first_objects[instance] + own.0)
    }

    /// Looks for what instances have in common, if that is asked for.
    fn between(&self, most_searched: usize, request: &CheckRequest, watch: &dyn Watch) -> Between {
        let kinds = [Kind::Contact, Kind::CoincidentVertices];
        if !request.options.kinds.any_of(&kinds) {
            return Between::default();
        }
        let object = |instance: usize, face: FaceId| {
            let own = &self.of_instance(instance).owners.objects.of_face;
            self.object(instance, own[face.index()])
        };
        let scene = SceneOfCopies { scene: self.scene, placed: self.placed, object: &object };
        between(&scene, request, most_searched, watch).unwrap_or_default()
    }

    /// Returns the group of vertices at one place: a touch, if each is of another object.
    fn group_at_one_place(&self, vertices: &[VertexId]) -> Group {
        let grade = match self.objects_of(vertices).len() == vertices.len() {
            true => Grade::Touch,
            false => Grade::Warning,
        };
        Group { grade, kind: Kind::CoincidentVertices }
    }

    /// Returns those lists of some vertices of an instance, in order, that the report of its mesh has:
    /// two or more at one place of the mesh.
    fn at_one_place_in_mesh(&self, vertices: &[VertexId]) -> Vec<Vec<VertexId>> {
        let placed = &self.placed.instances[self.placed.of_vertex(vertices[0])];
        let mesh = &self.scene.meshes[placed.shown.mesh].mesh;
        let mut lists: BTreeMap<[u64; 3], Vec<VertexId>> = BTreeMap::new();
        for &v in vertices {
            let place = bits(mesh.positions[placed.own_vertex(v).index()]);
            lists.entry(place).or_default().push(v);
        }
        lists.into_values().filter(|list| list.len() > 1).collect()
    }

    /// Returns the place of a vertex of the merged scene.
    fn place_of(&self, vertex: VertexId) -> [f64; 3] {
        let placed = &self.placed.instances[self.placed.of_vertex(vertex)];
        let mesh = &self.scene.meshes[placed.shown.mesh].mesh;
        placed.point(mesh.positions[placed.own_vertex(vertex).index()])
    }

    /// Returns the objects that have some vertices, each once.
    fn objects_of(&self, vertices: &[VertexId]) -> Vec<ObjectId> {
        let mut seen = HashSet::new();
        let object = |v: &VertexId| {
            let instance = self.placed.of_vertex(*v);
            let own = self.placed.instances[instance].own_vertex(*v);
            Some(self.object(instance, self.of_instance(instance).owners.of_vertex(own)?))
        };
        vertices.iter().filter_map(object).filter(|object| seen.insert(*object)).collect()
    }
}

/// Names the components of an instance, numbered from `first`, by the objects of their first faces.
fn named_components<'n>(
    own: &Objects,
    first: usize,
    owner: impl Fn(usize) -> &'n str,
) -> Vec<String> {
    let mut names = Vec::new();
    for (face, &component) in own.component_of_face.iter().enumerate() {
        if component as usize == names.len() {
            let number = first + names.len();
            names.push(match owner(face) {
                "" => format!("component {number}"),
                owner => format!("{owner}, component {number}"),
            });
        }
    }
    names
}
