//! Materials and objects of faces, as labels of their wedges.
//!
//! A wedge is used by faces of one material and one object only, so a wedge tells what its faces
//! are, at every level.

use meshlod_mesh::{Labels, Mesh};
use rustc_hash::FxHashMap;

use crate::pack::PackedTable;

/// Material and object of each wedge, as they are collected.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct WedgeLabels {
    /// Names of the materials and of the objects, if the mesh has any.
    pub(crate) names: [Option<Vec<String>>; 2],
    /// Distinct pairs of material and object.
    pub(crate) pairs: Vec<[u32; 2]>,
    /// Pair of each wedge; empty if there is only one.
    pub(crate) of_wedges: Vec<u32>,
}

impl WedgeLabels {
    /// Lists the pairs of a mesh, without wedges, and returns the pair of each face.
    pub(crate) fn of_faces(mesh: &Mesh) -> (Self, Vec<u32>) {
        let both = [&mesh.materials, &mesh.objects];
        let names = both.map(|labels| labels.as_ref().map(|labels| labels.names.clone()));
        let label = |labels: &Option<Labels>, face| labels.as_ref().map_or(0, |all| all.of(face));
        let (mut pairs, mut numbers) = (Vec::new(), FxHashMap::default());
        let of_faces = (0..mesh.faces.len()).map(|face| {
            let pair = both.map(|labels| label(labels, face));
            *numbers.entry(pair).or_insert_with(|| {
                pairs.push(pair);
                pairs.len() as u32 - 1
            })
        });
        let of_faces = of_faces.collect();
        (Self { names, pairs, of_wedges: Vec::new() }, of_faces)
    }

    /// Returns the pair of a wedge.
    #[inline]
    pub(crate) fn of(&self, wedge: u32) -> u32 {
        self.of_wedges.get(wedge as usize).copied().unwrap_or(0)
    }

    /// Packs the labels of some wedges, in the given order.
    pub(super) fn packed(&self, wedges: impl Iterator<Item = u32>) -> PackedLabels {
        let of_wedges = match self.of_wedges.is_empty() {
            true => Vec::new(),
            false => wedges.map(|wedge| self.of(wedge) as i32).collect(),
        };
        let of_wedges = PackedTable::list(&of_wedges);
        PackedLabels { names: self.names.clone(), pairs: self.pairs.clone(), of_wedges }
    }
}

/// Material and object of each wedge of a model.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct PackedLabels {
    /// Names of the materials and of the objects, if the mesh has any.
    pub(crate) names: [Option<Vec<String>>; 2],
    /// Distinct pairs of material and object.
    pub(crate) pairs: Vec<[u32; 2]>,
    /// Pair of each wedge; empty if there is only one.
    of_wedges: PackedTable,
}

impl PackedLabels {
    /// Returns the pair of a wedge.
    #[inline]
    pub(crate) fn of(&self, wedge: u32) -> u32 {
        self.of_wedges.at(wedge as usize).unwrap_or(0) as u32
    }

    /// Returns the materials or the objects, by `which`, of faces with these wedges.
    pub(super) fn select(&self, which: usize, corners: &[[u32; 3]]) -> Option<Labels> {
        let names = self.names[which].clone()?;
        let of = |&[wedge, ..]: &[u32; 3]| self.pairs[self.of(wedge) as usize][which];
        Some(Labels { names, of_face: corners.iter().map(of).collect() })
    }

    /// Returns the labels of some wedges, in the given order, as they are collected.
    pub(crate) fn unpacked(&self, wedges: impl Iterator<Item = u32>) -> WedgeLabels {
        let of_wedges = match self.of_wedges.rows() {
            0 => Vec::new(),
            _ => wedges.map(|wedge| self.of(wedge)).collect(),
        };
        WedgeLabels { names: self.names.clone(), pairs: self.pairs.clone(), of_wedges }
    }

    pub(super) fn bytes(&self) -> usize {
        self.of_wedges.bytes()
    }
}
