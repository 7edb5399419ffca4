//! Counts and measurements of all that a scene shows, from each of its meshes once.

use meshlod::io::MeshInstance;
use meshlod::mesh::{Bounds, Connectivity, Labels, face_components};
use meshlod::scene::{ShownSizes, shown_sizes, world_bounds};
use meshlod::{Mesh, Scene};
use serde::Serialize;

use crate::text::numbers::{coordinate, count, value};
use crate::text::table::aligned;

/// Counts and measurements of all that a scene shows, under the keys of JSON.
#[derive(Serialize)]
pub struct Facts {
    #[serde(flatten)]
    counts: MeshCounts,
    objects: usize,
    closed: bool,
    bounds: Bounds,
    diagonal: f64,
    area: f64,
    volume: f64,
    wedges: Option<usize>,
    attributes: Vec<String>,
    materials: Vec<String>,
    /// Number of faces of the meshes, each once.
    #[serde(skip)]
    pub faces_once: usize,
}

/// Counts of a mesh, or of all instances of meshes.
#[derive(Clone, Copy, Default, Serialize)]
struct MeshCounts {
    vertices: usize,
    unreferenced: usize,
    faces: usize,
    degenerate_faces: usize,
    edges: usize,
    boundary_edges: usize,
    non_manifold_edges: usize,
    inconsistent_edges: usize,
    pinched_vertices: usize,
    components: usize,
    #[serde(skip)]
    objects: usize,
    #[serde(skip)]
    wedges: usize,
}

impl Facts {
    pub fn of(scene: &Scene) -> Self {
        let instances = scene.instances();
        let mut times = vec![0; scene.meshes.len()];
        instances.iter().for_each(|shown| times[shown.mesh] += 1);
        let shown = || scene.meshes.iter().zip(&times).filter(|(_, times)| **times > 0);
        let (mut counts, mut faces_once) = (MeshCounts::default(), 0);
        for (mesh, times) in shown() {
            counts.add(&MeshCounts::of(&mesh.mesh), *times);
            faces_once += mesh.mesh.faces.len();
        }
        let bounds = world_bounds(scene);
        let ShownSizes { area, volume } = shown_sizes(scene);
        let has_attributes = shown().any(|(mesh, _)| mesh.mesh.attributes.is_some());
        Self {
            // Objects are the named ones of the file, else connected components.
            objects: match are_named(scene, &instances) {
                true => counts.objects,
                false => counts.components,
            },
            closed: counts.are_closed(),
            bounds,
            diagonal: bounds.diagonal(),
            area,
            volume,
            wedges: has_attributes.then_some(counts.wedges),
            attributes: attributes(shown().map(|(mesh, _)| &mesh.mesh)),
            materials: materials(scene, &times),
            counts,
            faces_once,
        }
    }

    /// Returns the number of faces of all instances.
    pub fn faces(&self) -> usize {
        self.counts.faces
    }

    pub fn text(&self) -> String {
        let number = |name: &str, number: usize| [format!("  {name}"), count(number)];
        let mut rows = vec![number("vertices", self.counts.vertices)];
        // Defects are listed only if there are any.
        let odd = |rows: &mut Vec<_>, name: &str, amount: usize| {
            if amount > 0 {
                rows.push(number(name, amount));
            }
        };
        odd(&mut rows, "  unused", self.counts.unreferenced);
        rows.push(number("faces", self.counts.faces));
        odd(&mut rows, "  degenerate", self.counts.degenerate_faces);
        rows.push(number("edges", self.counts.edges));
        rows.push(number("  boundary", self.counts.boundary_edges));
        rows.push(number("  non-manifold", self.counts.non_manifold_edges));
        odd(&mut rows, "  inconsistent", self.counts.inconsistent_edges);
        odd(&mut rows, "pinched vertices", self.counts.pinched_vertices);
        rows.push(number("components", self.counts.components));
        rows.push(number("objects", self.objects));
        let closed = if self.closed { "yes" } else { "no" };
        rows.push(["  closed".into(), closed.into()]);
        for (name, amount) in
            [("diagonal", self.diagonal), ("area", self.area), ("volume", self.volume)]
        {
            rows.push([format!("  {name}"), value(amount)]);
        }
        aligned(&rows) + &self.lines()
    }

    /// Formats bounds, attributes and materials, which do not fit into columns.
    fn lines(&self) -> String {
        let bounds = &self.bounds;
        let corner = |corner: [f64; 3]| {
            [0, 1, 2].map(|i| coordinate(corner[i], bounds.max[i] - bounds.min[i])).join(" ")
        };
        let mut text = String::new();
        if !bounds.is_empty() {
            text += &format!("  from  {}\n  to    {}\n", corner(bounds.min), corner(bounds.max));
        }
        if let Some(wedges) = self.wedges {
            let names = self.attributes.join(", ");
            text += &format!("  attributes  {names} at {} wedges\n", count(wedges));
        }
        if !self.materials.is_empty() {
            text += &format!("  materials   {}\n", self.materials.join(", "));
        }
        text
    }
}

impl MeshCounts {
    fn of(mesh: &Mesh) -> Self {
        let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
        let wedges = mesh.attributes.as_ref().map(|attributes| attributes.wedge_count);
        Self {
            vertices: mesh.positions.len(),
            unreferenced: mesh.used_vertices().iter().filter(|used| !**used).count(),
            faces: mesh.faces.len(),
            degenerate_faces: connectivity.degenerate_faces(),
            edges: connectivity.edge_count(),
            boundary_edges: connectivity.boundary_edges(),
            non_manifold_edges: connectivity.non_manifold_edges(),
            inconsistent_edges: connectivity.inconsistent_edges(),
            pinched_vertices: connectivity.pinched_vertices(),
            components: face_components(&mesh.faces, mesh.positions.len()).1,
            // Without names, an instance is an object.
            objects: mesh
                .objects
                .as_ref()
                .map_or(usize::from(!mesh.faces.is_empty()), labels_in_use),
            wedges: wedges.unwrap_or(mesh.positions.len()),
        }
    }

    /// Returns true if there are edges, each of two faces, as [`Connectivity::is_closed`] does.
    fn are_closed(&self) -> bool {
        self.edges > 0 && self.boundary_edges == 0 && self.non_manifold_edges == 0
    }

    /// Adds a mesh that is shown a number of times.
    fn add(&mut self, own: &Self, times: usize) {
        self.vertices += times * own.vertices;
        self.unreferenced += times * own.unreferenced;
        self.faces += times * own.faces;
        self.degenerate_faces += times * own.degenerate_faces;
        self.edges += times * own.edges;
        self.boundary_edges += times * own.boundary_edges;
        self.non_manifold_edges += times * own.non_manifold_edges;
        self.inconsistent_edges += times * own.inconsistent_edges;
        self.pinched_vertices += times * own.pinched_vertices;
        self.components += times * own.components;
        self.objects += times * own.objects;
        self.wedges += times * own.wedges;
    }
}

/// Returns true if a scene has objects: names, or several instances.
fn are_named(scene: &Scene, instances: &[MeshInstance]) -> bool {
    let has_name = |shown: &MeshInstance| {
        scene.meshes[shown.mesh].mesh.objects.is_some() || !scene.nodes[shown.node].name.is_empty()
    };
    instances.len() > 1 || instances.iter().any(has_name)
}

/// Names the attributes of meshes, each once: by their type, or by their own names where the type
/// has none.
fn attributes<'m>(meshes: impl Iterator<Item = &'m Mesh>) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for layer in meshes.flat_map(|mesh| &mesh.attributes).flat_map(|own| &own.layers) {
        let name = match layer.kind {
            kind if kind.is_named() => layer.name.clone(),
            kind => kind.to_string(),
        };
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// Returns the names of the materials of a scene; the last is empty if some faces have none.
fn materials(scene: &Scene, times: &[usize]) -> Vec<String> {
    let mut names: Vec<String> = scene.materials.iter().map(|own| own.name.clone()).collect();
    let mut shown = scene.meshes.iter().zip(times).filter(|(_, times)| **times > 0);
    let lacks_one = shown.any(|(mesh, _)| {
        let lacks = |label: usize| mesh.materials.get(label).copied().flatten().is_none();
        match &mesh.mesh.materials {
            Some(labels) => labels.of_face.iter().any(|&label| lacks(label as usize)),
            None => !mesh.mesh.faces.is_empty() && lacks(0),
        }
    });
    if lacks_one && !names.is_empty() {
        names.push(String::new());
    }
    names
}

fn labels_in_use(labels: &Labels) -> usize {
    let mut used = vec![false; labels.names.len()];
    labels.of_face.iter().for_each(|&label| used[label as usize] = true);
    used.iter().filter(|used| **used).count()
}

#[cfg(test)]
mod tests {
    use meshlod::io::Node;
    use meshlod::samples;

    use super::*;

    #[test]
    fn a_mesh_without_faces_opens_none() {
        let mut scene = Scene::from_mesh("ball", samples::sphere(80));
        let points = Mesh::new(vec![[0.0; 3]], Vec::new());
        scene.meshes.push(Scene::from_mesh("points", points).meshes[0].clone());
        scene.nodes.push(Node { mesh: Some(1), ..Node::default() });
        scene.roots = vec![0, 1];
        assert!(Facts::of(&scene).closed);
        scene.roots = vec![1];
        assert!(!Facts::of(&scene).closed);
        scene.roots = Vec::new();
        assert!(!Facts::of(&scene).closed, "nothing is closed if nothing is there");
    }

    #[test]
    fn copies_count_as_the_mesh_that_they_are_merged_into() {
        let mut tube = samples::terrain(200);
        tube.positions.push([99.0; 3]);
        let mut scene = Scene::from_mesh("tube", tube);
        let mirrored = [
            [0.0, 2.0, 0.0, 0.0],
            [2.0, 0.0, 0.0, 0.0],
            [0.0, 0.0, 2.0, 0.0],
            [5.0, 1.0, 3.0, 1.0],
        ];
        scene.nodes.push(Node { transform: mirrored, ..scene.nodes[0].clone() });
        scene.meshes.push(Scene::from_mesh("ball", samples::sphere(80)).meshes[0].clone());
        scene.nodes.push(Node { mesh: Some(1), ..Node::default() });
        scene.roots = vec![0, 1, 2];
        let flat = Scene { roots: vec![0], ..Scene::from_mesh("", scene.flatten()) };
        let [own, all] =
            [&scene, &flat].map(|scene| serde_json::to_value(Facts::of(scene)).unwrap());
        for (key, of_flat) in all.as_object().unwrap() {
            match (of_flat.as_f64(), own[key].as_f64()) {
                (Some(a), Some(b)) => assert!((a - b).abs() <= 1e-12 * a.abs(), "{key}: {a} {b}"),
                _ => assert_eq!(&own[key], of_flat, "{key}"),
            }
        }
    }
}
