//! Flattening of a scene: all its meshes merged into one, in world space.

use std::borrow::Cow;

use glam::{DMat3, DMat4, DVec3};
use meshlod_mesh::{Attributes, FaceLayer, Labels, Layer, LayerKind, Mesh, VertexId, WedgeId};

use super::{IDENTITY, Scene, normals};
use crate::vertex_attributes::pad;

/// One appearance of a mesh in a scene, with its transform to world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshInstance {
    /// Index of the node that shows the mesh, in [`Scene::nodes`].
    pub node: usize,
    /// Index of the mesh in [`Scene::meshes`].
    pub mesh: usize,
    /// Column-major 4×4 matrix from the mesh's own space to world space.
    pub transform: [[f64; 4]; 4],
}

impl MeshInstance {
    /// Linear part of the transform. The last row, which only a perspective transform uses, is
    /// ignored.
    fn linear(&self) -> DMat3 {
        DMat3::from_mat4(DMat4::from_cols_array_2d(&self.transform))
    }

    /// Reports whether the transform reverses orientation.
    pub fn mirrors(&self) -> bool {
        self.linear().determinant() < 0.0
    }
}

impl Scene {
    /// Lists the mesh instances of the scene, depth first from the roots; a mesh shown by several
    /// nodes, or several times by one, is listed once for each.
    pub fn instances(&self) -> Vec<MeshInstance> {
        let mut instances = Vec::new();
        let mut seen = vec![false; self.nodes.len()];
        let mut stack: Vec<(usize, DMat4)> =
            self.roots.iter().rev().map(|&root| (root, DMat4::IDENTITY)).collect();
        while let Some((node, parent)) = stack.pop() {
            // A scene built in code may contain a cycle, so each node is visited at most once.
            if std::mem::replace(&mut seen[node], true) {
                continue;
            }
            let at = &self.nodes[node];
            let world = parent * DMat4::from_cols_array_2d(&at.transform);
            if let Some(mesh) = at.mesh {
                let copies = if at.instances.is_empty() { &[IDENTITY] } else { &at.instances[..] };
                instances.extend(copies.iter().map(|copy| {
                    let transform = world * DMat4::from_cols_array_2d(copy);
                    MeshInstance { node, mesh, transform: transform.to_cols_array_2d() }
                }));
            }
            stack.extend(at.children.iter().rev().map(|&child| (child, world)));
        }
        instances
    }

    /// Merges all meshes that the scene shows into a single mesh in world space.
    ///
    /// Normals are transformed by the inverse transpose and stay unit vectors; a mirroring node
    /// flips winding and tangents. The layers are the union over all meshes: where a mesh lacks
    /// one, colours are white, normals come from the adjacent faces, tangents are unit vectors, and
    /// other values 0. Material label `i` is `Scene::materials[i]`; faces without a material share
    /// one more label, named "". Objects are taken from the mesh, or else each node becomes one; a
    /// single node without a name gives no objects.
    ///
    /// Cost: linear in the size of the result.
    pub fn flatten(&self) -> Mesh {
        let instances = self.instances();
        let mut flat = Mesh::default();
        for instance in &instances {
            self.append(&mut flat, instance);
        }
        let shown = || instances.iter().map(|instance| &self.meshes[instance.mesh].mesh);
        flat.attributes = self.flat_attributes(&instances, flat.positions.len());
        if shown().any(|mesh| !has_normals(mesh)) {
            normals::compute_missing(&mut flat, |_| true);
        }
        flat.materials = self.flat_materials(&instances);
        if instances.len() > 1
            || shown().any(|mesh| mesh.objects.is_some())
            || instances.iter().any(|instance| !self.nodes[instance.node].name.is_empty())
        {
            flat.objects = Some(self.flat_objects(&instances));
        }
        flat.face_layers = self.flat_face_layers(&instances);
        flat
    }

    /// Flattens the scene like [`Scene::flatten`], without copying a single untransformed mesh.
    pub fn into_mesh(mut self) -> Mesh {
        let Some(only) = self.only_mesh() else { return self.flatten() };
        let instances = self.instances();
        let (materials, objects) = (self.flat_materials(&instances), self.flat_objects(&instances));
        let mut mesh = std::mem::take(&mut self.meshes[only].mesh);
        mesh.materials = materials;
        if mesh.objects.is_none() && !self.nodes[instances[0].node].name.is_empty() {
            mesh.objects = Some(objects);
        }
        mesh
    }

    /// Returns the flattened mesh for formats without materials and objects, borrowed if the scene
    /// shows a single untransformed mesh.
    pub(crate) fn shown_mesh(&self) -> Cow<'_, Mesh> {
        match self.only_mesh() {
            Some(only) => Cow::Borrowed(&self.meshes[only].mesh),
            None => Cow::Owned(self.flatten()),
        }
    }

    /// Returns the material labels that [`Scene::flatten`] gives the faces of
    /// [`Scene::shown_mesh`].
    pub(crate) fn shown_materials(&self) -> Option<Labels> {
        self.flat_materials(&self.instances())
    }

    /// Returns the index of the only mesh shown, if its instance has the identity transform.
    fn only_mesh(&self) -> Option<usize> {
        match self.instances()[..] {
            [only] if only.transform == IDENTITY => Some(only.mesh),
            _ => None,
        }
    }

    /// Returns the names of the objects that [`Scene::flatten`] makes of an instance, where the scene
    /// shows several: those of its mesh, or else one for the node.
    pub fn names_of_instance(&self, instance: &MeshInstance) -> Cow<'_, [String]> {
        let mesh = &self.meshes[instance.mesh];
        if let Some(objects) = &mesh.mesh.objects {
            return Cow::Borrowed(&objects.names);
        }
        let node = instance.node;
        let named = [&self.nodes[node].name, &mesh.name].into_iter().find(|n| !n.is_empty());
        Cow::Owned(vec![named.cloned().unwrap_or_else(|| format!("node {node}"))])
    }

    fn append(&self, flat: &mut Mesh, instance: &MeshInstance) {
        let mesh = &self.meshes[instance.mesh].mesh;
        let base = flat.positions.len();
        let world = DMat4::from_cols_array_2d(&instance.transform);
        if instance.transform == IDENTITY {
            flat.positions.extend_from_slice(&mesh.positions);
        } else {
            let moved = mesh.positions.iter().map(|&p| world.transform_point3(p.into()).to_array());
            flat.positions.extend(moved);
        }
        let mirrored = instance.mirrors();
        flat.faces.extend(mesh.faces.iter().map(|face| {
            let [a, b, c] = face.map(|v| VertexId::new(base + v.index()));
            if mirrored { [a, c, b] } else { [a, b, c] }
        }));
    }

    fn flat_attributes(&self, instances: &[MeshInstance], vertices: usize) -> Option<Attributes> {
        let shown = || instances.iter().map(|instance| &self.meshes[instance.mesh].mesh);
        shown().find(|mesh| mesh.attributes.is_some())?;
        let mut flat = Attributes { layers: union_of_layers(shown()), ..Attributes::default() };
        flat.corners.reserve(shown().map(|mesh| mesh.faces.len()).sum());
        for layer in &mut flat.layers {
            layer.values.reserve(vertices * layer.width);
        }
        for instance in instances {
            append_attributes(&mut flat, &self.meshes[instance.mesh].mesh, instance);
        }
        Some(flat)
    }

    fn flat_materials(&self, instances: &[MeshInstance]) -> Option<Labels> {
        if self.materials.is_empty() {
            return None;
        }
        let none = self.materials.len();
        let mut flat = Labels {
            names: self.materials.iter().map(|material| material.name.clone()).collect(),
            of_face: Vec::new(),
        };
        for instance in instances {
            let mesh = &self.meshes[instance.mesh];
            let material =
                |label: usize| mesh.materials.get(label).copied().flatten().unwrap_or(none) as u32;
            match &mesh.mesh.materials {
                Some(labels) => {
                    let of_label: Vec<u32> = (0..labels.names.len()).map(material).collect();
                    flat.of_face.extend(labels.of_face.iter().map(|&l| of_label[l as usize]));
                }
                None => flat.of_face.extend(mesh.mesh.faces.iter().map(|_| material(0))),
            }
        }
        if flat.of_face.contains(&(none as u32)) {
            flat.names.push(String::new());
        }
        Some(flat)
    }

    /// Joins the layers of faces of all instances, with zeros where a mesh lacks one.
    fn flat_face_layers(&self, instances: &[MeshInstance]) -> Vec<FaceLayer> {
        let mut flat: Vec<FaceLayer> = Vec::new();
        let mut faces = 0;
        for instance in instances {
            let mesh = &self.meshes[instance.mesh].mesh;
            for own in &mesh.face_layers {
                let at = flat.iter().position(|known| known.is_like(own)).unwrap_or_else(|| {
                    flat.push(FaceLayer { values: Vec::new(), ..own.clone() });
                    flat.len() - 1
                });
                flat[at].values.resize(faces, 0.0);
                flat[at].values.extend_from_slice(&own.values);
            }
            faces += mesh.faces.len();
        }
        flat.iter_mut().for_each(|layer| layer.values.resize(faces, 0.0));
        flat
    }

    fn flat_objects(&self, instances: &[MeshInstance]) -> Labels {
        let mut flat = Labels::default();
        for instance in instances {
            let base = flat.names.len() as u32;
            flat.names.extend_from_slice(&self.names_of_instance(instance));
            let mesh = &self.meshes[instance.mesh].mesh;
            match &mesh.objects {
                Some(own) => flat.of_face.extend(own.of_face.iter().map(|label| base + label)),
                None => flat.of_face.extend(mesh.faces.iter().map(|_| base)),
            }
        }
        flat
    }
}

/// Transforms a mesh by a column-major 4×4 matrix, with its normals and tangents; a mirroring
/// matrix flips the winding.
///
/// Cost: linear.
pub fn transform(mesh: &mut Mesh, transform: &[[f64; 4]; 4]) {
    if *transform == IDENTITY {
        return;
    }
    let moved = MeshInstance { node: 0, mesh: 0, transform: *transform };
    let world = DMat4::from_cols_array_2d(transform);
    for position in &mut mesh.positions {
        *position = world.transform_point3((*position).into()).to_array();
    }
    if moved.mirrors() {
        mesh.faces.iter_mut().for_each(|face| face.swap(1, 2));
    }
    let Some(attributes) = &mut mesh.attributes else { return };
    if moved.mirrors() {
        attributes.corners.iter_mut().for_each(|corners| corners.swap(1, 2));
    }
    let directions = Directions::new(moved.linear());
    for layer in &mut attributes.layers {
        directions.turn(layer.kind, layer.width, &mut layer.values);
    }
}

/// Collects every distinct layer of the meshes, without values; colours get the largest width
/// found.
pub(crate) fn union_of_layers<'a>(meshes: impl Iterator<Item = &'a Mesh>) -> Vec<Layer> {
    let mut union: Vec<Layer> = Vec::new();
    for layer in meshes.filter_map(|mesh| mesh.attributes.as_ref()).flat_map(|a| &a.layers) {
        match union.iter_mut().find(|known| same_meaning(known, layer)) {
            Some(known) => known.width = known.width.max(layer.width),
            None => union.push(Layer { name: layer.name.clone(), values: Vec::new(), ..*layer }),
        }
    }
    union
}

fn has_normals(mesh: &Mesh) -> bool {
    mesh.attributes.as_ref().is_some_and(|own| own.layer(LayerKind::Normal).is_some())
}

fn same_meaning(a: &Layer, b: &Layer) -> bool {
    a.kind == b.kind && (!a.kind.is_named() || (a.name == b.name && a.width == b.width))
}

fn append_attributes(flat: &mut Attributes, mesh: &Mesh, instance: &MeshInstance) {
    let base = flat.wedge_count;
    let mirrored = instance.mirrors();
    let mut push = |[a, b, c]: [usize; 3]| {
        let corners = if mirrored { [a, c, b] } else { [a, b, c] };
        flat.corners.push(corners.map(|w| WedgeId::new(base + w)));
    };
    let wedges = match &mesh.attributes {
        Some(own) => {
            own.corners.iter().for_each(|corners| push(corners.map(WedgeId::index)));
            own.wedge_count
        }
        // Values that the mesh lacks need wedges too, and no two vertices share a wedge.
        None => {
            mesh.faces.iter().for_each(|face| push(face.map(VertexId::index)));
            mesh.positions.len()
        }
    };
    flat.wedge_count += wedges;
    let own = mesh.attributes.as_ref().map_or(&[][..], |attributes| &attributes.layers);
    let moved = (instance.transform != IDENTITY).then(|| Directions::new(instance.linear()));
    for layer in &mut flat.layers {
        let from = layer.values.len();
        if let Some(own) = own.iter().find(|own| same_meaning(own, layer)) {
            append_values(layer, own);
            if let Some(moved) = &moved {
                moved.turn(layer.kind, layer.width, &mut layer.values[from..]);
            }
        }
        pad(layer, flat.wedge_count);
    }
}

/// Appends the values of `own`; missing components (alpha) are filled with ones.
fn append_values(layer: &mut Layer, own: &Layer) {
    if layer.width == own.width {
        return layer.values.extend_from_slice(&own.values);
    }
    for values in own.values.chunks_exact(own.width) {
        layer.values.extend_from_slice(values);
        layer.values.extend((own.width..layer.width).map(|_| 1.0));
    }
}

/// Move of points and directions from the space of a mesh to world space.
#[derive(Debug)]
pub(crate) struct Placement {
    /// Nothing for the identity, which changes no bit.
    moved: Option<(DMat4, Directions)>,
    /// True if faces change their winding.
    pub mirrors: bool,
}

impl Placement {
    pub fn of(instance: &MeshInstance) -> Self {
        let world = DMat4::from_cols_array_2d(&instance.transform);
        let is_moved = instance.transform != IDENTITY;
        let moved = is_moved.then(|| (world, Directions::new(instance.linear())));
        Self { moved, mirrors: instance.mirrors() }
    }

    /// Moves a point.
    pub fn point(&self, point: [f64; 3]) -> [f64; 3] {
        match &self.moved {
            Some((world, _)) => world.transform_point3(point.into()).to_array(),
            None => point,
        }
    }

    /// Turns values of a layer if they are directions.
    pub fn turn(&self, kind: LayerKind, width: usize, values: &mut [f32]) {
        if let Some((_, directions)) = &self.moved {
            directions.turn(kind, width, values);
        }
    }
}

/// Matrices that rotate the normals and tangents of a mesh with its node.
#[derive(Debug)]
struct Directions {
    tangents: DMat3,
    normals: DMat3,
    handedness: f32,
}

impl Directions {
    fn new(linear: DMat3) -> Self {
        let DMat3 { x_axis: x, y_axis: y, z_axis: z } = linear;
        let mirrored = linear.determinant() < 0.0;
        let sign = if mirrored { -1.0 } else { 1.0 };
        // The cofactor matrix is the inverse transpose times the determinant: the same directions,
        // and defined for singular matrices too.
        let normals = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * sign;
        Self { tangents: linear, normals, handedness: sign as f32 }
    }

    fn turn(&self, kind: LayerKind, width: usize, values: &mut [f32]) {
        let matrix = match kind {
            LayerKind::Normal => self.normals,
            LayerKind::Tangent => self.tangents,
            _ => return,
        };
        for value in values.chunks_exact_mut(width) {
            let [x, y, z] = [value[0], value[1], value[2]].map(f64::from);
            let turned = (matrix * DVec3::new(x, y, z)).normalize_or_zero().as_vec3();
            value[..3].copy_from_slice(&turned.to_array());
            if kind == LayerKind::Tangent {
                value[3] *= self.handedness;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Material, Node, SceneMesh};

    fn triangle(normal: [f32; 3]) -> Mesh {
        let face = [0, 1, 2].map(VertexId);
        let mut mesh =
            Mesh::new(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![face]);
        let layer = |kind, width, values: &[f32]| Layer {
            kind,
            name: String::new(),
            width,
            values: values.repeat(3),
        };
        mesh.attributes = Some(Attributes {
            corners: vec![[0, 1, 2].map(WedgeId)],
            wedge_count: 3,
            layers: vec![
                layer(LayerKind::Normal, 3, &normal),
                layer(LayerKind::Tangent, 4, &[1.0, 0.0, 0.0, 1.0]),
            ],
        });
        mesh
    }

    fn scaled(x: f64, y: f64, z: f64) -> [[f64; 4]; 4] {
        DMat4::from_scale(DVec3::new(x, y, z)).to_cols_array_2d()
    }

    #[test]
    fn a_mirroring_node_flips_winding_and_handedness_but_not_the_outside() {
        let mut scene = Scene::from_mesh("t", triangle([0.0, 0.0, 1.0]));
        scene.nodes[0].transform = scaled(-2.0, 1.0, 1.0);
        let flat = scene.flatten();
        let [a, b, c] = flat.triangle(flat.faces[0]);
        assert!((b - a).cross(c - a).z > 0.0, "still seen from above");
        let attributes = flat.attributes.unwrap();
        let of = |kind| attributes.layer(kind).unwrap().of(attributes.corners[0][0]).to_vec();
        assert_eq!(of(LayerKind::Normal), [0.0, 0.0, 1.0]);
        assert_eq!(of(LayerKind::Tangent), [-1.0, 0.0, 0.0, -1.0]);
    }

    /// Found by the fuzzer: a matrix that only its last row turns over flipped faces, but not
    /// wedges.
    #[test]
    fn a_perspective_row_does_not_mirror() {
        let mut scene = Scene::from_mesh("t", triangle([0.0, 0.0, 1.0]));
        scene.nodes[0].transform[1][3] = 1.0;
        scene.nodes[0].transform[3][1] = 10.0;
        let flat = scene.flatten();
        flat.validate().unwrap();
        assert_eq!(flat.faces, [[0, 1, 2].map(VertexId)]);
        assert_eq!(flat.attributes.unwrap().corners, [[0, 1, 2].map(WedgeId)]);
    }

    #[test]
    fn normals_go_by_the_inverse_transpose() {
        let half = 0.5f32.sqrt();
        let mut scene = Scene::from_mesh("t", triangle([half, half, 0.0]));
        scene.nodes[0].transform = scaled(1.0, 2.0, 1.0);
        let attributes = scene.flatten().attributes.unwrap();
        let normal = attributes.layer(LayerKind::Normal).unwrap().of(WedgeId(0));
        let expected = DVec3::new(1.0, 0.5, 0.0).normalize().as_vec3();
        assert!((glam::Vec3::from_slice(normal) - expected).length() < 1e-6, "{normal:?}");
    }

    #[test]
    fn a_collapsing_node_gives_no_nan() {
        let mut scene = Scene::from_mesh("t", triangle([0.0, 0.0, 1.0]));
        scene.nodes[0].transform = scaled(0.0, 0.0, 0.0);
        let layers = scene.flatten().attributes.unwrap().layers;
        assert!(layers.iter().all(|layer| layer.values.iter().all(|x| x.is_finite())));
    }

    #[test]
    fn meshes_without_a_layer_get_neutral_values_and_every_face_its_material_and_object() {
        let bare = Mesh { attributes: None, ..triangle([0.0; 3]) };
        let child = |name: &str, mesh| Node { name: name.into(), mesh, ..Node::default() };
        let scene = Scene {
            meshes: vec![
                SceneMesh { mesh: bare, materials: vec![Some(1)], ..SceneMesh::default() },
                SceneMesh { mesh: triangle([0.0, 1.0, 0.0]), ..SceneMesh::default() },
            ],
            nodes: vec![
                Node { children: vec![1, 2, 3], ..Node::default() },
                child("bare", Some(0)),
                child("full", Some(1)),
                child("again", Some(0)),
            ],
            roots: vec![0],
            materials: ["red", "blue"]
                .map(|name| Material { name: name.into(), ..Material::default() })
                .into(),
            ..Scene::default()
        };
        let flat = scene.flatten();
        flat.validate().unwrap();
        let objects = flat.objects.as_ref().unwrap();
        assert_eq!(
            (&objects.names[..], &objects.of_face[..]),
            (&["bare", "full", "again"].map(String::from)[..], &[0, 1, 2][..])
        );
        let materials = flat.materials.as_ref().unwrap();
        assert_eq!(materials.of_face, [1, 2, 1]);
        assert_eq!(materials.names, ["red", "blue", ""]);
        let attributes = flat.attributes.as_ref().unwrap();
        let normals = attributes.layer(LayerKind::Normal).unwrap();
        assert_eq!(normals.of(attributes.corners[0][0]), [0.0, 0.0, 1.0], "that of the face");
        assert_eq!(normals.of(attributes.corners[1][0]), [0.0, 1.0, 0.0], "that of the mesh");
        let tangents = attributes.layer(LayerKind::Tangent).unwrap();
        assert_eq!(tangents.of(attributes.corners[0][0]), [1.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn taking_the_only_mesh_is_the_same_as_flattening() {
        let mut scene = Scene::from_mesh("t", triangle([0.0, 0.0, 1.0]));
        assert_eq!(scene.clone().into_mesh(), scene.flatten());
        scene.nodes[0].name = "node".into();
        scene.materials = vec![Material::default(), Material::default()];
        scene.meshes[0].materials = vec![Some(1)];
        let flat = scene.flatten();
        assert_eq!(flat.materials.as_ref().unwrap().of_face, [1]);
        assert_eq!(scene.into_mesh(), flat);
    }

    #[test]
    fn a_cycle_of_nodes_ends() {
        let mut scene = Scene::from_mesh("t", triangle([0.0, 0.0, 1.0]));
        scene.nodes[0].children = vec![0];
        assert_eq!(scene.flatten().faces.len(), 1);
    }
}
