//! Instances of checked meshes, and findings of a mesh as an instance has them.

use glam::DMat4;
use meshlod_check::{Finding, Intersection, ObjectId};
use meshlod_io::{MeshInstance, Scene};
use meshlod_mesh::{FaceId, Mesh, VertexId};

use crate::jobs::JobError;
use crate::jobs::copies::Copies;
use crate::numbers::count;
use crate::scene::place::similarity;

/// The instances of a scene of copies, with their ids in the mesh that they would be merged into.
pub struct PlacedInstances {
    pub instances: Vec<PlacedMesh>,
    pub vertices: usize,
    pub faces: usize,
}

/// An instance of a mesh.
pub struct PlacedMesh {
    pub shown: MeshInstance,
    /// Factor of lengths.
    scale: f64,
    is_moved: bool,
    first_vertex: usize,
    first_face: usize,
}

impl PlacedInstances {
    /// Lists the instances of a scene; `None` unless it shows its meshes many times, in similar
    /// shapes, and these are valid.
    ///
    /// # Errors
    /// More faces or vertices than there are ids.
    pub fn of(scene: &Scene) -> Result<Option<Self>, JobError> {
        if Copies::of(scene).is_none() || !are_finite(scene) {
            return Ok(None);
        }
        let mut all = Self { instances: Vec::new(), vertices: 0, faces: 0 };
        for shown in scene.instances() {
            let mesh = &scene.meshes[shown.mesh].mesh;
            all.instances.push(PlacedMesh {
                shown,
                // A mesh without faces has no lengths, and any transform.
                scale: similarity(&shown).unwrap_or(1.0),
                is_moved: shown.transform != DMat4::IDENTITY.to_cols_array_2d(),
                first_vertex: all.vertices,
                first_face: all.faces,
            });
            all.vertices += mesh.positions.len();
            all.faces += mesh.faces.len();
        }
        match all.vertices.max(all.faces) < u32::MAX as usize {
            true => Ok(Some(all)),
            false => Err(JobError::input(format!(
                "shows {} faces and {} vertices, but ids end at {}: check its meshes alone",
                count(all.faces),
                count(all.vertices),
                count(u32::MAX as usize)
            ))),
        }
    }

    /// Returns the instance that has a vertex of the merged mesh.
    pub fn of_vertex(&self, vertex: VertexId) -> usize {
        self.instances.partition_point(|own| own.first_vertex <= vertex.index()) - 1
    }

    /// Returns the instance that has a face of the merged mesh.
    pub fn of_face(&self, face: FaceId) -> usize {
        self.instances.partition_point(|own| own.first_face <= face.index()) - 1
    }
}

/// Returns true if the meshes of a scene are valid, and no coordinate of an instance overflows.
fn are_finite(scene: &Scene) -> bool {
    let reaches: Vec<f64> = scene.meshes.iter().map(|mesh| reach(&mesh.mesh)).collect();
    let is_near = |shown: &MeshInstance| {
        let entries = shown.transform.as_flattened().iter();
        let largest = entries.fold(0.0, |most: f64, x| most.max(x.abs()));
        largest * (1.0 + reaches[shown.mesh]) < f64::MAX / 8.0
    };
    scene.meshes.iter().all(|mesh| mesh.mesh.validate().is_ok())
        && scene.instances().iter().all(is_near)
}

/// Returns the largest coordinate of a mesh, without its sign.
pub fn reach(mesh: &Mesh) -> f64 {
    mesh.positions.as_flattened().iter().fold(0.0, |most: f64, x| most.max(x.abs()))
}

impl PlacedMesh {
    /// Returns a point of the mesh where the instance has it.
    pub fn point(&self, at: [f64; 3]) -> [f64; 3] {
        let world = DMat4::from_cols_array_2d(&self.shown.transform);
        if self.is_moved { world.transform_point3(at.into()).to_array() } else { at }
    }

    /// Returns the largest number that moving a point of the mesh adds up, in units of the mesh:
    /// `reach` is its largest coordinate. Zero if the mesh is not moved.
    pub fn summands(&self, reach: f64) -> f64 {
        if !self.is_moved {
            return 0.0;
        }
        let [x, y, z, at] = self.shown.transform;
        let largest = |row: &[f64]| row.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let turned = [x, y, z].iter().map(|axis| largest(axis)).fold(0.0, f64::max) * reach;
        (3.0 * turned + largest(&at[..3])) / self.scale
    }

    pub fn vertex(&self, own: VertexId) -> VertexId {
        VertexId::new(self.first_vertex + own.index())
    }

    pub fn face(&self, own: FaceId) -> FaceId {
        FaceId::new(self.first_face + own.index())
    }

    /// Returns the id that the mesh has for a vertex of the merged mesh.
    pub fn own_vertex(&self, vertex: VertexId) -> VertexId {
        VertexId::new(vertex.index() - self.first_vertex)
    }

    /// Returns the intersection of two faces as the instance has it.
    pub fn touch(&self, own: Intersection) -> Intersection {
        Intersection { point: self.point(own.point), depth: own.depth * self.scale, ..own }
    }

    /// Returns a finding of the mesh as the instance has it. `object` gives the ids of objects.
    pub fn finding(&self, own: &Finding, object: impl Fn(ObjectId) -> ObjectId) -> Finding {
        let mut placed = own.clone();
        match &mut placed {
            Finding::BadAttributes { .. } | Finding::Crowded { .. } => {}
            Finding::NonFiniteVertex { vertex }
            | Finding::UnusedVertex { vertex }
            | Finding::NonManifoldVertex { vertex, .. } => *vertex = self.vertex(*vertex),
            Finding::BadIndex { face, vertex } => {
                (*face, *vertex) = (self.face(*face), self.vertex(*vertex));
            }
            Finding::CoincidentVertices { vertices } => self.move_vertices(vertices),
            Finding::BoundaryLoop { vertices, closed } => {
                self.move_vertices(vertices);
                // Mirrored faces go around the other way; a path begins with its lower end anyway.
                if *closed && self.shown.mirrors() {
                    vertices[1..].reverse();
                }
            }
            Finding::DegenerateFace { face, .. } => *face = self.face(*face),
            Finding::DuplicateFace { face, of } => {
                (*face, *of) = (self.face(*face), self.face(*of))
            }
            Finding::InconsistentEdge { edge, faces } => {
                self.move_vertices(edge);
                self.move_faces(faces);
            }
            Finding::NonManifoldEdge { edge, faces } => {
                self.move_vertices(edge);
                self.move_faces(faces);
            }
            Finding::InsideOut { face, volume } => {
                (*face, *volume) = (self.face(*face), *volume * self.scale.powi(3));
            }
            Finding::SelfIntersection { object: of, faces, intersection } => {
                *of = object(*of);
                self.move_faces(faces);
                *intersection = self.touch(*intersection);
            }
            Finding::Contact { objects, faces, intersection } => {
                *objects = objects.map(object);
                self.move_faces(faces);
                *intersection = self.touch(*intersection);
            }
        }
        placed
    }

    fn move_vertices(&self, own: &mut [VertexId]) {
        own.iter_mut().for_each(|v| *v = self.vertex(*v));
    }

    fn move_faces(&self, own: &mut [FaceId]) {
        own.iter_mut().for_each(|f| *f = self.face(*f));
    }
}
