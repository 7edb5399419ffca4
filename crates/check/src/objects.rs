//! Which faces belong together: the named objects of the file, or its connected components.

use meshlod_mesh::{Labels, Mesh, VertexId, face_components};

/// An object of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ObjectId(pub u32);

/// What makes an object.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ObjectsBy {
    /// The names that the file gives, where it gives two or more; else components.
    #[default]
    Auto,
    /// The names that the file gives; all faces are one object where it gives none.
    Names,
    /// Faces that share vertices, whatever they are named.
    Components,
}

/// The objects of a mesh, and the components, which move apart when a mesh is coarsened.
#[derive(Clone, Debug, PartialEq)]
pub struct Objects {
    /// The object of every face.
    pub of_face: Vec<ObjectId>,
    /// The name of every object; components are `component 0` and so on, in the order of their
    /// first faces, after the name of the file's object that the first face is in.
    pub names: Vec<String>,
    /// The component of every face.
    pub component_of_face: Vec<u32>,
    /// How many components there are.
    pub components: usize,
}

impl Objects {
    /// The objects of any mesh. Names that do not fit the faces are no names; faces that name
    /// vertices that are not there are one component.
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

/// The components, as far as indices are in range.
fn components(mesh: &Mesh) -> (Vec<u32>, usize) {
    let count = mesh.positions.len();
    let sound = |face: &[VertexId; 3]| face.iter().all(|v| v.index() < count);
    if mesh.faces.iter().all(sound) {
        return face_components(&mesh.faces, count);
    }
    // All others are at one more vertex.
    let elsewhere = [VertexId::new(count); 3];
    let faces: Vec<_> =
        mesh.faces.iter().map(|face| if sound(face) { *face } else { elsewhere }).collect();
    face_components(&faces, count + 1)
}

/// The names of objects, where every face has one.
fn labels(mesh: &Mesh) -> Option<&Labels> {
    let fits = |labels: &&Labels| {
        let count = labels.names.len();
        labels.of_face.len() == mesh.faces.len()
            && labels.of_face.iter().all(|&name| (name as usize) < count)
    };
    mesh.objects.as_ref().filter(fits)
}

/// How many different names faces have, as far as it matters: none, one, or two for more.
fn used_names(of_face: &[u32]) -> usize {
    let Some(first) = of_face.first() else { return 0 };
    1 + usize::from(of_face.iter().any(|name| name != first))
}

/// A name for every component.
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
