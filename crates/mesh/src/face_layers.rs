//! Layers of faces: one number for each face that stays with it, such as its smoothing group.

use crate::Mesh;

/// Use of a layer of faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaceLayerKind {
    /// Smoothing groups as OBJ has them: whole numbers of 32 bits, 0 for none. They change no
    /// shading here.
    Smoothing,
    /// Numbers of any other meaning, identified by the name of the layer.
    Other,
}

/// Layer of faces: one number for each face of a mesh.
///
/// Numbers are never blended: a face that is left of a mesh has the number it had, and a piece of a
/// face has that of the face.
#[derive(Clone, Debug, PartialEq)]
pub struct FaceLayer {
    /// Use of the numbers.
    pub kind: FaceLayerKind,
    /// Name of the layer in the file.
    pub name: String,
    /// Number of each face.
    pub values: Vec<f64>,
}

impl FaceLayer {
    /// Returns the layer for the faces with the indices `kept`, in that order.
    pub fn select(&self, kept: &[u32]) -> Self {
        let values = kept.iter().map(|&face| self.values[face as usize]).collect();
        Self { name: self.name.clone(), values, ..*self }
    }

    /// Reports whether two layers of different meshes hold numbers of one meaning.
    pub fn is_like(&self, other: &Self) -> bool {
        self.kind == other.kind
            && (self.kind == FaceLayerKind::Smoothing || self.name == other.name)
    }
}

impl Mesh {
    /// Returns the layers of faces for the faces with the indices `kept`, in that order.
    pub fn select_face_layers(&self, kept: &[u32]) -> Vec<FaceLayer> {
        self.face_layers.iter().map(|layer| layer.select(kept)).collect()
    }

    /// Returns the smoothing groups of the faces, if they have any.
    pub fn smoothing(&self) -> Option<&FaceLayer> {
        self.face_layers.iter().find(|layer| layer.kind == FaceLayerKind::Smoothing)
    }
}
