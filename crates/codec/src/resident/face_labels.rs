//! Materials and objects of faces, patch by patch.

use meshlod_mesh::{Labels, Mesh};

use super::faces::Faces;
use super::nodes::Nodes;
use crate::attributes::PackedRows;
use crate::bytes::{Malformed, Reader};
use crate::labels::{names_bytes, restore_names, store_names};
use crate::patch::{Patches, Rows};

/// Labels of the faces of a compressed mesh.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FaceLabels {
    names: Vec<String>,
    /// Label of each face; a row is a patch.
    of_face: PackedRows,
}

impl FaceLabels {
    /// Packs the materials and the objects of a mesh, given its faces patch by patch.
    pub(super) fn of_mesh(
        mesh: &Mesh,
        nodes: &Nodes,
        patches: &Patches,
        order: &[u32],
    ) -> [Option<Self>; 2] {
        let rows = Rows::new(patches.face_counts());
        let face_of = |&at: &u32| nodes.face_of[at as usize] as usize;
        [&mesh.materials, &mesh.objects].map(|labels| {
            let labels = labels.as_ref()?;
            let numbers: Vec<_> = order.iter().map(|at| labels.of(face_of(at))).collect();
            Some(Self::new(labels.names.clone(), rows.clone(), &numbers))
        })
    }

    /// Packs the labels of faces; a row is a patch.
    pub(super) fn new(names: Vec<String>, rows: Rows, of_face: &[u32]) -> Self {
        Self { names, of_face: PackedRows::new(rows, 1, of_face) }
    }

    /// Decodes the labels of all faces.
    pub(super) fn all(&self) -> Labels {
        Labels { names: self.names.clone(), of_face: self.of_face.all() }
    }

    /// Decodes the labels of the faces of one patch.
    pub(super) fn of_patch(&self, patch: usize) -> Labels {
        Labels { names: self.names.clone(), of_face: self.of_face.row(patch) }
    }

    /// Returns the size in bytes of labels or their absence.
    pub(super) fn bytes(labels: Option<&Self>) -> usize {
        let rows = labels.map_or(0, |labels| labels.of_face.bytes());
        names_bytes(labels.map(|labels| &labels.names[..])) + rows
    }

    /// Appends optional labels.
    pub(super) fn store(labels: Option<&Self>, out: &mut Vec<u8>) {
        store_names(labels.map(|labels| &labels.names[..]), out);
        labels.iter().for_each(|labels| labels.of_face.store(out));
    }

    /// Reads what [`FaceLabels::store`] wrote.
    pub(super) fn restore(faces: &Faces, reader: &mut Reader) -> Result<Option<Self>, Malformed> {
        let Some(names) = restore_names(reader)? else { return Ok(None) };
        if u32::try_from(faces.face_count()).is_err() {
            return Err(reader.wrong("there are more faces than 32 bits can number"));
        }
        let of_face = PackedRows::restore(faces.face_rows(), 1, reader)?;
        if of_face.all().iter().any(|&label| label as usize >= names.len()) {
            return Err(reader.wrong("a face has a material or an object that does not exist"));
        }
        Ok(Some(Self { names, of_face }))
    }
}
