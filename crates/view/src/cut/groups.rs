//! Groups of triangles that are drawn together: those of one mesh of the scene in one material.

use std::collections::BTreeMap;

use meshlod::mesh::Bounds;
use meshlod::model::SceneLayout;
use meshlod::multires::{Hierarchy, Implicit};

/// Groups of a model, and the one of each vertex.
#[derive(Clone, Debug)]
pub(super) struct Groups {
    pub(super) all: Vec<Group>,
    /// Group of each vertex; empty if there is only one.
    of_vertices: Vec<u32>,
}

/// Mesh and material of triangles that are drawn together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Group {
    /// Mesh of the scene.
    pub(super) mesh: u32,
    /// Material label of the scene's flattened mesh.
    pub(super) material: u32,
}

impl Groups {
    /// Finds the groups in which the vertices of all levels are drawn, in the order of meshes and
    /// materials.
    pub(super) fn new(levels: &Hierarchy, layout: &SceneLayout) -> Self {
        let one = Self { all: vec![Group::default()], of_vertices: Vec::new() };
        let Hierarchy::Contractions(model) = levels else { return one };
        let group = |vertex: u32| group_of(model, layout, vertex);
        let count = model.wedge_count() as u32;
        let mut numbers: BTreeMap<Group, u32> = BTreeMap::new();
        for vertex in 0..count {
            numbers.insert(group(vertex), 0);
        }
        if numbers.is_empty() {
            return one;
        }
        numbers.values_mut().zip(0..).for_each(|(number, next)| *number = next);
        let of_vertices = match numbers.len() {
            1 => Vec::new(),
            _ => (0..count).map(|vertex| numbers[&group(vertex)]).collect(),
        };
        Self { all: numbers.into_keys().collect(), of_vertices }
    }

    /// Returns the group of a triangle, by one of its vertices.
    #[inline]
    pub(super) fn of(&self, vertex: u32) -> u32 {
        self.of_vertices.get(vertex as usize).copied().unwrap_or(0)
    }

    /// Returns the box of each mesh of the groups, around its vertices.
    pub(super) fn boxes(&self, levels: &Hierarchy) -> BTreeMap<u32, Bounds> {
        let mut boxes: BTreeMap<u32, Bounds> =
            self.all.iter().map(|group| (group.mesh, Bounds::EMPTY)).collect();
        let wedges = |node: u32| match levels {
            Hierarchy::Contractions(model) if model.wedge_count() > 0 => model.wedges_of(node),
            _ => node..node + 1,
        };
        for node in 0..levels.node_count() as u32 {
            let place = Bounds::of(&[levels.position(node)]);
            // A node has wedges of one mesh: meshes share no vertices.
            let mesh = self.all[self.of(wedges(node).start) as usize].mesh;
            boxes.entry(mesh).and_modify(|bounds| bounds.merge(&place));
        }
        boxes
    }
}

/// Returns the group of the triangles that use a wedge.
fn group_of(model: &Implicit, layout: &SceneLayout, wedge: u32) -> Group {
    let label = model.material_of(wedge);
    let in_scene = |label: u32| layout.materials.get(label as usize).or(layout.materials.last());
    let material = match layout.materials.is_empty() {
        true => label.unwrap_or(0),
        false => *in_scene(label.unwrap_or(u32::MAX)).unwrap_or(&0),
    };
    let object = model.object_of(wedge).unwrap_or(0);
    Group { mesh: layout.meshes.get(object as usize).copied().unwrap_or(0), material }
}
