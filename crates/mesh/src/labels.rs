//! Labels of faces, such as their material or object, with each name stored once.

/// Named label of every face, such as its material or object.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Labels {
    /// Distinct names, which `of_face` refers to by index.
    pub names: Vec<String>,
    /// Label of each face, as an index into `names`.
    pub of_face: Vec<u32>,
}

impl Labels {
    /// Returns the label of a face, as an index into `names`.
    #[inline]
    pub fn of(&self, face: usize) -> u32 {
        self.of_face[face]
    }

    /// Returns the labels of the faces with the indices `kept`, in that order; the names stay as
    /// they are.
    pub fn select(&self, kept: &[u32]) -> Self {
        let of_face = kept.iter().map(|&f| self.of_face[f as usize]).collect();
        Self { names: self.names.clone(), of_face }
    }
}
