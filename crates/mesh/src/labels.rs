//! Names of faces, each stored once: materials and objects.

/// A name for every face, as an index into a table of names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Labels {
    /// Table of names, indexed by `of_face`.
    pub names: Vec<String>,
    /// Index into `names` of each face.
    pub of_face: Vec<u32>,
}

impl Labels {
    /// Returns the label of the face at index `face`, as an index into `names`.
    #[inline]
    pub fn of(&self, face: usize) -> u32 {
        self.of_face[face]
    }

    /// Returns the labels of the faces at the indices `kept`, in that order, with the same names.
    pub fn select(&self, kept: &[u32]) -> Self {
        let of_face = kept.iter().map(|&f| self.of_face[f as usize]).collect();
        Self { names: self.names.clone(), of_face }
    }
}
