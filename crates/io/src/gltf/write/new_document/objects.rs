//! Objects of meshes as nodes, since glTF has no named parts of a mesh.

use std::collections::BTreeMap;

use meshlod_mesh::{Attributes, Buckets, Labels, Layer, Mesh, VertexId, WedgeId};

use crate::gltf::write::levels::Level;
use crate::scene::{Node, Scene, SceneMesh};

/// Scene in which each object is a separate mesh, without its images, and its levels.
pub(crate) struct ObjectNodes {
    pub scene: Scene,
    pub levels: Vec<Level>,
}

/// Splits meshes of two or more objects into one mesh per object, shown by named child nodes;
/// vertices between objects are repeated. An unnamed node takes the name of a mesh's only object.
/// Returns `None` if no mesh has objects.
///
/// Cost: linear.
pub(crate) fn split_objects(scene: &Scene, levels: &[Level]) -> Option<ObjectNodes> {
    scene.meshes.iter().find(|mesh| mesh.mesh.objects.is_some())?;
    let mut new = ObjectNodes {
        scene: Scene {
            nodes: scene.nodes.clone(),
            roots: scene.roots.clone(),
            materials: scene.materials.clone(),
            ply: scene.ply.clone(),
            ..Scene::default()
        },
        levels: levels
            .iter()
            .map(|level| Level { meshes: Vec::new(), screen_coverage: level.screen_coverage })
            .collect(),
    };
    let mut nodes_of: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (node, mesh) in scene.nodes.iter().enumerate().filter_map(|(i, n)| Some((i, n.mesh?))) {
        nodes_of.entry(mesh).or_default().push(node);
    }
    for (index, mesh) in scene.meshes.iter().enumerate() {
        let coarser: Vec<Option<&Mesh>> =
            levels.iter().map(|level| level.meshes.get(index)).collect();
        let shown_by = nodes_of.remove(&index).unwrap_or_default();
        new.add(mesh, &coarser, &shown_by);
    }
    Some(new)
}

impl ObjectNodes {
    /// Adds a mesh and its levels, split if possible, to these nodes.
    fn add(&mut self, mesh: &SceneMesh, coarser: &[Option<&Mesh>], shown_by: &[usize]) {
        let first = self.scene.meshes.len();
        let objects = used_objects(&mesh.mesh);
        let fits = |level: &Option<&Mesh>| {
            let names = |mesh: &Mesh| mesh.objects.as_ref().map(|objects| objects.names.clone());
            level.is_some_and(|level| names(level) == names(&mesh.mesh))
        };
        if objects.len() < 2 || !coarser.iter().all(fits) {
            let only = objects.first().map_or("", |&(_, name)| name);
            for &node in shown_by {
                let node = &mut self.scene.nodes[node];
                node.mesh = Some(first);
                if node.name.is_empty() {
                    node.name = only.to_owned();
                }
            }
            self.scene.meshes.push(mesh.clone());
            for (level, own) in self.levels.iter_mut().zip(coarser) {
                level.meshes.extend(own.cloned());
            }
            return;
        }
        let materials = materials_of(&mesh.mesh, &objects);
        for (part, (labels, &(_, name))) in
            parts(&mesh.mesh, &objects, &materials).into_iter().zip(materials.iter().zip(&objects))
        {
            let material = |&label: &u32| mesh.materials.get(label as usize).copied().flatten();
            let materials = match mesh.mesh.materials {
                Some(_) => labels.iter().map(material).collect(),
                None => mesh.materials.clone(),
            };
            self.scene.meshes.push(SceneMesh { name: name.to_owned(), mesh: part, materials });
        }
        for (level, own) in self.levels.iter_mut().zip(coarser) {
            level.meshes.extend(own.iter().flat_map(|own| parts(own, &objects, &materials)));
        }
        for &shown in shown_by {
            self.scene.nodes[shown].mesh = None;
            for (part, &(_, name)) in objects.iter().enumerate() {
                let child = self.scene.nodes.len();
                let mesh = Some(first + part);
                self.scene.nodes.push(Node { name: name.to_owned(), mesh, ..Node::default() });
                self.scene.nodes[shown].children.push(child);
            }
        }
    }
}

/// Lists the labels and names of the objects in use.
fn used_objects(mesh: &Mesh) -> Vec<(u32, &str)> {
    let Some(objects) = &mesh.objects else { return Vec::new() };
    let mut used = vec![false; objects.names.len()];
    objects.of_face.iter().for_each(|&label| used[label as usize] = true);
    let names = objects.names.iter().zip(0..);
    names.filter(|&(_, label)| used[label as usize]).map(|(name, label)| (label, &**name)).collect()
}

/// Lists the material labels of each object, by first use.
fn materials_of(mesh: &Mesh, objects: &[(u32, &str)]) -> Vec<Vec<u32>> {
    let Some(materials) = &mesh.materials else { return vec![Vec::new(); objects.len()] };
    let mut numbers = FirstUses::new(materials.names.len());
    let faces = faces_by_object(mesh);
    let used = objects.iter().map(|&(object, _)| {
        for &face in faces.of(object as usize) {
            numbers.of(materials.of(face as usize));
        }
        numbers.take()
    });
    used.collect()
}

fn faces_by_object(mesh: &Mesh) -> Buckets {
    let labels = mesh.objects.as_ref().map_or(&[][..], |objects| &objects.of_face);
    let count = mesh.objects.as_ref().map_or(0, |objects| objects.names.len());
    Buckets::new(count, labels.iter().map(|&label| label as usize))
}

/// Splits a mesh into its objects, with the material labels of each.
fn parts(mesh: &Mesh, objects: &[(u32, &str)], materials: &[Vec<u32>]) -> Vec<Mesh> {
    let faces = faces_by_object(mesh);
    let wedges = mesh.attributes.as_ref().map_or(0, |attributes| attributes.wedge_count);
    let names = mesh.materials.as_ref().map_or(0, |labels| labels.names.len());
    let [mut vertices, mut wedges, mut labels] =
        [mesh.positions.len(), wedges, names].map(FirstUses::new);
    let mut parts = Vec::with_capacity(objects.len());
    for (&(object, _), materials) in objects.iter().zip(materials) {
        let own = faces.of(object as usize);
        let mut part = Mesh::default();
        for &face in own {
            let vertex = |v: VertexId| VertexId(vertices.of(v.0));
            part.faces.push(mesh.faces[face as usize].map(vertex));
        }
        part.positions = vertices.take().into_iter().map(|v| mesh.positions[v as usize]).collect();
        part.attributes = mesh.attributes.as_ref().map(|all| attributes(all, own, &mut wedges));
        if let Some(all) = &mesh.materials {
            for &label in materials {
                labels.of(label);
            }
            let of_face = own.iter().map(|&face| labels.of(all.of(face as usize))).collect();
            let names = labels.take().into_iter().map(|l| all.names[l as usize].clone()).collect();
            part.materials = Some(Labels { names, of_face });
        }
        parts.push(part);
    }
    parts
}

fn attributes(all: &Attributes, faces: &[u32], wedges: &mut FirstUses) -> Attributes {
    let mut corners = Vec::with_capacity(faces.len());
    for &face in faces {
        corners.push(all.corners[face as usize].map(|w| WedgeId(wedges.of(w.0))));
    }
    let used = wedges.take();
    let layer = |layer: &Layer| {
        let values = used.iter().flat_map(|&w| layer.of(WedgeId(w))).copied().collect();
        Layer { kind: layer.kind, name: layer.name.clone(), width: layer.width, values }
    };
    Attributes { corners, wedge_count: used.len(), layers: all.layers.iter().map(layer).collect() }
}

/// Numbering of used items by first use.
struct FirstUses {
    numbers: Vec<u32>,
    used: Vec<u32>,
}

/// Marks items without a number.
const NONE: u32 = u32::MAX;

impl FirstUses {
    fn new(count: usize) -> Self {
        Self { numbers: vec![NONE; count], used: Vec::new() }
    }

    /// Returns the number of an item.
    fn of(&mut self, old: u32) -> u32 {
        let number = &mut self.numbers[old as usize];
        if *number == NONE {
            *number = self.used.len() as u32;
            self.used.push(old);
        }
        *number
    }

    /// Returns the numbered items in order, and resets the numbering.
    fn take(&mut self) -> Vec<u32> {
        let used = std::mem::take(&mut self.used);
        used.iter().for_each(|&old| self.numbers[old as usize] = NONE);
        used
    }
}

#[cfg(test)]
mod tests {
    use meshlod_fixtures::cube;

    use super::*;
    use crate::gltf::{read, write_glb};
    use crate::{Format, Note, Weld};

    /// Returns a cube of three objects, of two materials each but for the last.
    fn boxes() -> Scene {
        let mut mesh = cube();
        let labels = |names: &[&str], of_face: Vec<u32>| {
            let names = names.iter().map(|&name| name.to_owned()).collect();
            Some(Labels { names, of_face })
        };
        mesh.objects =
            labels(&["a", "never", "b", ""], (0..12).map(|f| [0, 2, 3][f / 4]).collect());
        let of_face = (0..12).map(|f| if f >= 8 { 1 } else { f % 2 }).collect();
        mesh.materials = labels(&["red", "blue"], of_face);
        Scene::from_mesh("box", mesh)
    }

    #[test]
    fn objects_become_nodes_and_come_back() {
        let scene = boxes();
        let notes = scene.limits_of(Format::Glb);
        assert_eq!(notes.iter().map(Note::to_string).collect::<Vec<_>>(), [""; 0]);
        let back = read(&write_glb(&scene, &[]).unwrap(), &mut |_| None, Weld::Exact).unwrap();
        let names: Vec<&str> = back.meshes.iter().map(|mesh| &*mesh.name).collect();
        assert_eq!(names, ["a", "b", ""]);
        let labels: Vec<&[Option<usize>]> = back.meshes.iter().map(|m| &m.materials[..]).collect();
        assert_eq!(labels, [&[Some(0), Some(1)][..], &[Some(0), Some(1)], &[Some(1)]]);
        let corners = |mesh: &Mesh| -> Vec<_> {
            let mut all: Vec<_> =
                mesh.faces.iter().map(|&f| mesh.triangle(f).map(|p| p.to_array())).collect();
            all.sort_by(|a, b| a.partial_cmp(b).unwrap());
            all
        };
        let (new, old) = (back.flatten(), scene.flatten());
        assert_eq!(corners(&new), corners(&old));
        let objects = new.objects.unwrap();
        assert_eq!(objects.names[..2], ["a", "b"]);
        assert_eq!(objects.of_face, (0..12).map(|f| f / 4).collect::<Vec<_>>());
    }

    #[test]
    fn levels_are_split_like_their_mesh() {
        let scene = boxes();
        let mut coarse = scene.meshes[0].mesh.clone();
        // No face of the first object is left.
        let kept: Vec<u32> = (4..12).collect();
        coarse.faces.drain(..4);
        coarse.objects = coarse.objects.map(|labels| labels.select(&kept));
        coarse.materials = coarse.materials.map(|labels| labels.select(&kept));
        let level = Level { meshes: vec![coarse], screen_coverage: 0.5 };
        let split = split_objects(&scene, std::slice::from_ref(&level)).unwrap();
        let faces: Vec<usize> = split.levels[0].meshes.iter().map(|m| m.faces.len()).collect();
        assert_eq!(faces, [0, 4, 4]);
        write_glb(&scene, &[level]).unwrap();
    }

    #[test]
    fn an_only_object_names_its_node() {
        let mut scene = boxes();
        let one = Labels { names: vec!["it".into()], of_face: vec![0; 12] };
        scene.meshes[0].mesh.objects = Some(one);
        let split = split_objects(&scene, &[]).unwrap().scene;
        assert_eq!((split.meshes.len(), &*split.nodes[0].name), (1, "it"));
        scene.meshes[0].mesh.objects = None;
        assert!(split_objects(&scene, &[]).is_none());
    }
}
