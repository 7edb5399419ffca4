//! Wedges of an extracted level, and the attributes of its mesh.

use std::sync::Arc;

use meshlod_mesh::{Attributes, Mesh, WedgeId};

use super::Wedges;
use crate::level::renumber;

/// Wedges at the corners of a level's faces, in the model's numbers, with the values of all.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LevelWedges {
    pub(crate) corners: Vec<[u32; 3]>,
    pub(crate) all: Arc<Wedges>,
}

impl LevelWedges {
    /// Gives a mesh of the level's faces their attributes, materials and objects.
    pub(crate) fn add_to(&self, mesh: &mut Mesh) {
        let Self { corners, all } = self;
        mesh.materials = all.labels.select(0, corners);
        mesh.objects = all.labels.select(1, corners);
        if all.values.is_empty() {
            return;
        }
        let mut corners = corners.clone();
        let used = renumber(&mut corners, all.wedge_count());
        mesh.attributes = Some(Attributes {
            corners: corners.into_iter().map(|face| face.map(WedgeId)).collect(),
            wedge_count: used.len(),
            layers: all.values.layers(used.iter().copied()),
        });
    }
}
