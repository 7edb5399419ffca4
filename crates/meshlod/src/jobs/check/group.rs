//! Groups of findings as reports show them: by kind, and by what a finding calls for.

use std::collections::HashSet;

use meshlod_check::{Finding, IntersectionKind, Kind, ObjectId, Objects, Severity};
use meshlod_mesh::{FaceId, Mesh, VertexId};

/// Urgency of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "kebab-case"))]
pub enum Grade {
    /// Most programs reject the mesh or process it incorrectly.
    Error,
    /// The mesh is usable, but the finding is worth knowing.
    Warning,
    /// Objects touch without passing through each other, as parts of a model are meant to.
    Touch,
}

/// Findings of one kind and grade; errors come first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Group {
    /// Urgency of the findings.
    pub grade: Grade,
    /// Kind of the findings.
    pub kind: Kind,
}

impl Grade {
    /// Returns the name that reports use: `error`, `warning` or `touch`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
            Self::Touch => "touch",
        }
    }
}

impl Group {
    /// Returns the group of contacts of a kind.
    pub(super) fn of_contact(kind: IntersectionKind) -> Self {
        let grade = if is_touch(kind) { Grade::Touch } else { Grade::Warning };
        Self { grade, kind: Kind::Contact }
    }
}

/// Objects that the vertices and faces of a mesh belong to.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Ownership {
    /// The objects of the mesh.
    pub objects: Objects,
    /// Object of the first face at each vertex; `None` for a vertex that no face uses.
    of_vertex: Vec<Option<ObjectId>>,
}

impl Ownership {
    /// Finds the owner of every vertex.
    pub fn new(mesh: &Mesh, objects: Objects) -> Self {
        let mut of_vertex = vec![None; mesh.positions.len()];
        for (face, &object) in mesh.faces.iter().zip(&objects.of_face) {
            for v in face {
                if let Some(of @ None) = of_vertex.get_mut(v.index()) {
                    *of = Some(object);
                }
            }
        }
        Self { objects, of_vertex }
    }

    /// Lists objects alone, without what belongs to them.
    pub(super) fn of_objects(objects: Objects) -> Self {
        Self { objects, of_vertex: Vec::new() }
    }

    /// Returns the object of the first face at a vertex.
    pub(super) fn of_vertex(&self, vertex: VertexId) -> Option<ObjectId> {
        self.of_vertex.get(vertex.index()).copied().flatten()
    }

    /// Returns the group of a finding.
    pub fn group(&self, finding: &Finding) -> Group {
        let kind = finding.kind();
        let grade = match kind.severity() {
            Severity::Error => Grade::Error,
            Severity::Warning if self.is_touch(finding) => Grade::Touch,
            Severity::Warning => Grade::Warning,
        };
        Group { kind, grade }
    }

    /// Returns the objects that a finding concerns, each once, in the order of the finding's ids.
    pub fn of(&self, finding: &Finding) -> Vec<ObjectId> {
        let vertex = |v: &VertexId| self.of_vertex(*v);
        let face = |f: &FaceId| self.objects.of_face.get(f.index()).copied();
        let mut found: Vec<ObjectId> = match finding {
            Finding::BadAttributes { .. } | Finding::Crowded { .. } => Vec::new(),
            Finding::NonFiniteVertex { vertex: v }
            | Finding::UnusedVertex { vertex: v }
            | Finding::NonManifoldVertex { vertex: v, .. } => vertex(v).into_iter().collect(),
            Finding::CoincidentVertices { vertices } => {
                vertices.iter().filter_map(vertex).collect()
            }
            Finding::BoundaryLoop { vertices, .. } => {
                vertices.first().and_then(vertex).into_iter().collect()
            }
            Finding::BadIndex { face: f, .. }
            | Finding::DegenerateFace { face: f, .. }
            | Finding::InsideOut { face: f, .. } => face(f).into_iter().collect(),
            Finding::DuplicateFace { face: f, of } => {
                [f, of].into_iter().filter_map(face).collect()
            }
            Finding::InconsistentEdge { faces, .. } => faces.iter().filter_map(face).collect(),
            Finding::NonManifoldEdge { faces, .. } => faces.iter().filter_map(face).collect(),
            Finding::SelfIntersection { object, .. } => vec![*object],
            Finding::Contact { objects, .. } => objects.to_vec(),
        };
        let mut seen = HashSet::new();
        found.retain(|object| seen.insert(*object));
        found
    }

    /// Returns whether a finding is only a place where objects touch: faces of two objects that do
    /// not pass through each other, or vertices at one place that are each of another object.
    fn is_touch(&self, finding: &Finding) -> bool {
        match finding {
            Finding::CoincidentVertices { vertices } => self.of(finding).len() == vertices.len(),
            Finding::Contact { intersection, .. } => is_touch(intersection.kind),
            _ => false,
        }
    }
}

/// Returns whether two faces touch without passing through each other or lying in each other.
pub fn is_touch(kind: IntersectionKind) -> bool {
    matches!(kind, IntersectionKind::Point | IntersectionKind::Segment)
}

#[cfg(test)]
mod tests {
    use meshlod_check::ObjectsBy;

    use super::*;

    #[test]
    fn vertices_at_one_place_touch_if_each_is_of_another_object() {
        let v = VertexId;
        let faces = vec![[v(0), v(1), v(2)], [v(2), v(1), v(3)], [v(4), v(5), v(6)]];
        let mesh = Mesh::new(vec![[0.0; 3]; 8], faces);
        let ownership = Ownership::new(&mesh, Objects::of(&mesh, ObjectsBy::Components));
        let grade = |vertices: &[u32]| {
            let vertices = vertices.iter().map(|&index| v(index)).collect();
            ownership.group(&Finding::CoincidentVertices { vertices }).grade
        };
        assert_eq!(grade(&[0, 4]), Grade::Touch);
        assert_eq!(grade(&[0, 3]), Grade::Warning, "both are of the first object");
        assert_eq!(grade(&[0, 3, 4]), Grade::Warning);
        assert_eq!(grade(&[4, 7]), Grade::Warning, "no object has the last vertex");
    }
}
