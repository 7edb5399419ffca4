//! Objects of a mesh: the named objects of the file, or the connected components.

use meshlod_mesh::{Labels, Mesh, VertexId, face_components};

/// Index of an object among the objects of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(transparent))]
pub struct ObjectId(pub u32);

/// Rule by which the faces of a mesh are grouped into objects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum ObjectsBy {
    /// Named objects of the file if there are two or more, otherwise connected components.
    #[default]
    Auto,
    /// Named objects of the file; if there are no names, the mesh is one object.
    Names,
    /// Connected components: faces connected through shared vertices, whatever their names.
    Components,
}

/// Objects and connected components of a mesh.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Objects {
    /// Object that each face belongs to.
    pub of_face: Vec<ObjectId>,
    /// Name of each object. Components are called `component 0` and so on, in the order of their
    /// first faces, prefixed by the name of the file's object that contains the first face.
    pub names: Vec<String>,
    /// Connected component that each face belongs to.
    pub component_of_face: Vec<u32>,
    /// Number of connected components.
    pub components: usize,
}

impl Objects {
    /// Groups the faces of a mesh into objects. Labels that do not match the faces are ignored;
    /// faces with missing vertices form one component.
    pub fn of(mesh: &Mesh, by: ObjectsBy) -> Self {
        let (component_of_face, components) = components(mesh);
        let labels = labels(mesh).filter(|labels| match by {
            ObjectsBy::Auto => used_names(&labels.of_face) > 1,
            ObjectsBy::Names => true,
            ObjectsBy::Components => false,
        });
        let (of_face, names) = match (labels, by) {
            (Some(labels), _) => (labels.of_face.clone(), labels.names.clone()),
            (None, ObjectsBy::Names) => (vec![0; mesh.faces.len()], vec!["mesh".to_owned()]),
            (None, _) => (component_of_face.clone(), component_names(mesh, &component_of_face)),
        };
        let of_face = of_face.into_iter().map(ObjectId).collect();
        Self { of_face, names, component_of_face, components }
    }
}

/// Labels the components; faces with indices out of range form one more.
fn components(mesh: &Mesh) -> (Vec<u32>, usize) {
    let count = mesh.positions.len();
    let valid = |face: &[VertexId; 3]| face.iter().all(|v| v.index() < count);
    if mesh.faces.iter().all(valid) {
        return face_components(&mesh.faces, count);
    }
    // Faces with a missing vertex move to an extra vertex.
    let elsewhere = [VertexId::new(count); 3];
    let faces: Vec<_> =
        mesh.faces.iter().map(|face| if valid(face) { *face } else { elsewhere }).collect();
    face_components(&faces, count + 1)
}

/// Returns the object labels if every face has a valid one.
fn labels(mesh: &Mesh) -> Option<&Labels> {
    let fits = |labels: &&Labels| {
        let count = labels.names.len();
        labels.of_face.len() == mesh.faces.len()
            && labels.of_face.iter().all(|&name| (name as usize) < count)
    };
    mesh.objects.as_ref().filter(fits)
}

/// Returns the number of different names in use, at most 2.
fn used_names(of_face: &[u32]) -> usize {
    let Some(first) = of_face.first() else { return 0 };
    1 + usize::from(of_face.iter().any(|name| name != first))
}

/// Returns a name for every component.
fn component_names(mesh: &Mesh, component_of_face: &[u32]) -> Vec<String> {
    let labels = labels(mesh);
    let mut names = Vec::new();
    for (face, &component) in component_of_face.iter().enumerate() {
        if component as usize == names.len() {
            let owner = labels.map(|labels| &labels.names[labels.of(face) as usize]);
            names.push(match owner.filter(|name| !name.is_empty()) {
                Some(owner) => format!("{owner}, component {component}"),
                None => format!("component {component}"),
            });
        }
    }
    names
}
