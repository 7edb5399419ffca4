//! Triangle strips of a flattened scene, given back to its meshes.

use meshlod_io::gltf::{StripCorner, StripMesh};
use meshlod_io::{MeshInstance, Scene};
use meshlod_mesh::{Attributes, Layer, Mesh, VertexId, WedgeId};
use meshlod_strip::{MergeTree, StripWedge, Strips};

/// Returns the triangle strips of a scene's [instances](Scene::instances), in the space of their
/// meshes, to be written by [`write_strips`](meshlod_io::write_strips).
///
/// `flat` is the scene as [`Scene::flatten`] merges it, `tree` was made of that, and `levels` are
/// strips of it, the finest first. They never run across instances or materials. Every instance has
/// the attributes of its mesh; only what the strips use is copied.
///
/// Cost: linear.
pub(super) fn scene_strips(
    scene: &Scene,
    flat: &Mesh,
    tree: &MergeTree,
    levels: &[&Strips],
) -> Vec<StripMesh> {
    let wedges = tree.wedges(flat);
    let places = places(scene, flat);
    let mut apart = vec![vec![Vec::new(); levels.len()]; places.len()];
    for (level, strips) in levels.iter().enumerate() {
        for strip in strips.iter() {
            let Some(first) = strip.first() else { continue };
            let face = wedges[first.index()].face.index();
            let place = places.partition_point(|place| place.first_face <= face) - 1;
            let label = places[place].label(face);
            let of_labels: &mut Vec<Strips> = &mut apart[place][level];
            of_labels.resize_with(of_labels.len().max(label + 1), Strips::default);
            match places[place].is_mirrored {
                true => of_labels[label].push(reversed(strip)),
                false => of_labels[label].push(strip.iter().copied()),
            }
        }
    }
    places.iter().zip(&apart).map(|(place, levels)| place.strip_mesh(&wedges, levels)).collect()
}

/// An instance of a mesh, and where its elements begin in the flattened scene.
struct Place<'s> {
    mesh: &'s Mesh,
    is_mirrored: bool,
    first_vertex: usize,
    first_wedge: usize,
    first_face: usize,
}

fn places<'s>(scene: &'s Scene, flat: &Mesh) -> Vec<Place<'s>> {
    let (mut first_vertex, mut first_wedge, mut first_face) = (0, 0, 0);
    let place = |instance: MeshInstance| {
        let mesh = &scene.meshes[instance.mesh].mesh;
        let is_mirrored = instance.mirrors();
        let place = Place { mesh, is_mirrored, first_vertex, first_wedge, first_face };
        first_vertex += mesh.positions.len();
        first_wedge += match &mesh.attributes {
            Some(attributes) if flat.attributes.is_some() => attributes.wedge_count,
            _ => mesh.positions.len(),
        };
        first_face += mesh.faces.len();
        place
    };
    scene.instances().into_iter().map(place).collect()
}

/// Turns a strip over: it then begins with an odd triangle, or no longer does.
fn reversed(strip: &[VertexId]) -> Vec<VertexId> {
    match *strip {
        [first, second, ..] if first == second => strip[1..].to_vec(),
        [first, ..] => [&[first], strip].concat(),
        [] => Vec::new(),
    }
}

impl Place<'_> {
    /// Returns the material label of a face of the flattened scene.
    fn label(&self, face: usize) -> usize {
        let labels = self.mesh.materials.as_ref();
        labels.map_or(0, |labels| labels.of(face - self.first_face) as usize)
    }

    /// Builds the mesh of strips; `levels` hold those of each label.
    fn strip_mesh(&self, wedges: &[StripWedge], levels: &[Vec<Strips>]) -> StripMesh {
        let mut used = Vec::new();
        let mut corner = |v: VertexId| -> StripCorner {
            let vertex = wedges[v.index()].vertex.index() - self.first_vertex;
            used.push(v);
            (VertexId::new(vertex), WedgeId(v.0))
        };
        let mut levels: Vec<Vec<Vec<StripCorner>>> = levels
            .iter()
            .map(|labels| {
                let stitched = labels.iter().map(Strips::stitched);
                stitched.map(|strip| strip.into_iter().map(&mut corner).collect()).collect()
            })
            .collect();
        used.sort_unstable();
        used.dedup();
        for (_, wedge) in levels.iter_mut().flatten().flatten() {
            let place = used.binary_search(&VertexId(wedge.0)).unwrap_or_default();
            *wedge = WedgeId::new(place);
        }
        let used: Vec<StripWedge> = used.iter().map(|v| wedges[v.index()]).collect();
        let attributes = self.mesh.attributes.as_ref().map(|own| self.attributes(own, &used));
        let positions = self.mesh.positions.clone();
        StripMesh { mesh: Mesh { positions, attributes, ..Mesh::default() }, levels }
    }

    /// Collects the attributes of some wedges from those of the mesh.
    fn attributes(&self, own: &Attributes, wedges: &[StripWedge]) -> Attributes {
        let layer = |layer: &Layer| {
            let source = |wedge: &StripWedge| {
                WedgeId::new(wedge.source(layer.kind).index() - self.first_wedge)
            };
            let values = wedges.iter().flat_map(|wedge| layer.of(source(wedge))).copied();
            Layer { values: values.collect(), name: layer.name.clone(), ..*layer }
        };
        let layers = own.layers.iter().map(layer).collect();
        Attributes { corners: Vec::new(), wedge_count: wedges.len(), layers }
    }
}

#[cfg(test)]
mod tests;
