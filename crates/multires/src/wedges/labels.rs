//! Materials and objects of faces, as labels of their wedges.
//!
//! A wedge is used by faces of one material and one object only, so a wedge tells what its faces
//! are, at every level.

use meshlod_mesh::{Labels, Mesh};
use rustc_hash::FxHashMap;

/// Material and object of each wedge.
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

    /// Returns the materials or the objects, by `which`, of faces with these wedges.
    pub(crate) fn select(&self, which: usize, corners: &[[u32; 3]]) -> Option<Labels> {
        let names = self.names[which].clone()?;
        let of = |&[wedge, ..]: &[u32; 3]| self.pairs[self.of(wedge) as usize][which];
        Some(Labels { names, of_face: corners.iter().map(of).collect() })
    }

    /// Returns labels of the same names for other wedges, given those wedges here.
    pub(crate) fn renumbered(&self, wedges: impl Iterator<Item = u32>) -> Self {
        let of_wedges = match self.of_wedges.is_empty() {
            true => Vec::new(),
            false => wedges.map(|wedge| self.of(wedge)).collect(),
        };
        Self { of_wedges, ..self.clone() }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.of_wedges[..])
    }
}
