//! Attributes that a format cannot hold, and seams that split vertices.

use std::collections::BTreeSet;

use meshlod_mesh::{Layer, LayerKind, Mesh};

use crate::format::facts::{HeldLayers, SeamSplits, Stores};
use crate::notes::Note;
use crate::obj::color_splits;
use crate::scene::flatten::MeshInstance;
use crate::scene::{Scene, SceneMesh};

impl Scene {
    pub(super) fn layer_limits(&self, stores: &Stores) -> Vec<Note> {
        let shown = || self.instances().into_iter().map(|MeshInstance { mesh, .. }| mesh);
        let shown: BTreeSet<usize> = shown().collect();
        let meshes: Vec<&Mesh> = shown.iter().map(|&mesh| &self.meshes[mesh].mesh).collect();
        let layers =
            meshes.iter().filter_map(|mesh| mesh.attributes.as_ref()).flat_map(|a| &a.layers);
        let sets = match stores.layers {
            HeldLayers::BasicByMaterial => self.shown_texture_sets(),
            _ => BTreeSet::new(),
        };
        let lost: BTreeSet<String> =
            layers.filter(|layer| !holds(stores.layers, layer, &sets)).map(title).collect();
        let split = |splits: fn(&Mesh) -> usize| {
            let is_new = !self.had_split_seams();
            if is_new { meshes.iter().map(|mesh| splits(mesh)).sum() } else { 0 }
        };
        let (all, of_colors) = match stores.seams {
            SeamSplits::None => (0, 0),
            SeamSplits::Colors => (0, split(color_splits)),
            SeamSplits::All => (split(seams), 0),
        };
        let translucent = meshes.iter().map(|mesh| translucent_vertices(mesh));
        let translucent = if stores.has_opacity { 0 } else { translucent.sum() };
        vec![
            Note::left_out(lost.len(), "vertex attribute", "vertex attributes").named(lost),
            Note::left_out(translucent, "opacity of a vertex", "opacities of vertices"),
            Note::changed(
                all,
                "vertex split at seams of its attributes",
                "vertices split at seams of their attributes",
            ),
            Note::changed(
                of_colors,
                "vertex split at seams of its colours",
                "vertices split at seams of their colours",
            ),
        ]
    }

    /// Returns the set of texture coordinates that the base colour of each material uses.
    pub(crate) fn texture_sets(&self) -> Vec<u8> {
        self.source.as_ref().map_or_else(Vec::new, |source| source.texture_sets())
    }

    /// Returns the sets of texture coordinates in an OBJ file: the sets that shown materials use,
    /// and the first one for other faces.
    fn shown_texture_sets(&self) -> BTreeSet<u8> {
        let sets = self.texture_sets();
        let shown: BTreeSet<usize> = self.instances().iter().map(|i| i.mesh).collect();
        let meshes = shown.iter().map(|&mesh| &self.meshes[mesh]);
        let of_mesh = |mesh: &SceneMesh| -> Vec<u8> {
            let has = |set: u8| {
                let attributes = mesh.mesh.attributes.as_ref();
                attributes.is_some_and(|own| own.layer(LayerKind::Uv(set)).is_some())
            };
            let set = |material: &Option<usize>| sets.get((*material)?).copied();
            let of_materials = mesh.materials.iter().map(|material| set(material).unwrap_or(0));
            of_materials.map(|set| if has(set) { set } else { 0 }).collect()
        };
        match sets.iter().all(|&set| set == 0) {
            true => BTreeSet::from([0]),
            false => meshes.flat_map(of_mesh).collect(),
        }
    }

    /// Reports whether the source file had its vertices split at seams, so that splitting them
    /// again changes nothing.
    pub(crate) fn had_split_seams(&self) -> bool {
        self.source.is_some() || self.has_split_seams
    }
}

/// Reports whether a format stores a layer; `sets` are the sets of texture coordinates in an OBJ
/// file.
fn holds(held: HeldLayers, layer: &Layer, sets: &BTreeSet<u8>) -> bool {
    match (held, layer.kind) {
        (HeldLayers::All, _) => true,
        (HeldLayers::None, _) => false,
        (HeldLayers::BasicByMaterial, LayerKind::Uv(set)) => sets.contains(&set),
        (_, kind) => matches!(kind, LayerKind::Normal | LayerKind::Uv(0) | LayerKind::Color(0)),
    }
}

/// Returns the name of a layer for messages.
fn title(layer: &Layer) -> String {
    match layer.kind {
        LayerKind::Normal => "normals".to_owned(),
        LayerKind::Tangent => "tangents".to_owned(),
        LayerKind::Uv(0) => "texture coordinates".to_owned(),
        LayerKind::Color(0) => "colours".to_owned(),
        LayerKind::Uv(set) => format!("texture coordinates {set}"),
        LayerKind::Color(set) => format!("colours {set}"),
        LayerKind::Joints(_) => "joints".to_owned(),
        LayerKind::Weights(_) => "joint weights".to_owned(),
        LayerKind::Other | LayerKind::Label => layer.name.clone(),
    }
}

/// Counts the vertices whose colour is not opaque for every face.
fn translucent_vertices(mesh: &Mesh) -> usize {
    let Some(attributes) = &mesh.attributes else { return 0 };
    let Some(colors) = attributes.layer(LayerKind::Color(0)) else { return 0 };
    let mut found = vec![false; mesh.positions.len()];
    for (v, &wedge) in mesh.faces.as_flattened().iter().zip(attributes.corners.as_flattened()) {
        found[v.index()] |= colors.of(wedge).get(3).is_some_and(|&opacity| opacity != 1.0);
    }
    found.into_iter().filter(|&found| found).count()
}

/// Counts the wedges in use beyond one for each vertex in use.
fn seams(mesh: &Mesh) -> usize {
    let Some(attributes) = &mesh.attributes else { return 0 };
    if attributes.layers.is_empty() {
        return 0;
    }
    let used = |count: usize, ids: &mut dyn Iterator<Item = usize>| {
        let mut used = vec![false; count];
        ids.for_each(|id| used[id] = true);
        used.into_iter().filter(|&used| used).count()
    };
    let wedges = &mut attributes.corners.as_flattened().iter().map(|w| w.index());
    let vertices = &mut mesh.faces.as_flattened().iter().map(|v| v.index());
    used(attributes.wedge_count, wedges).saturating_sub(used(mesh.positions.len(), vertices))
}
