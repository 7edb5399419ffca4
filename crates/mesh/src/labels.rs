//! One name per face, stored once: materials and objects.

/// A name for every face, by index into a table of names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Labels {
    /// The names; an index of `of_face` points here.
    pub names: Vec<String>,
    /// One index into `names` per face.
    pub of_face: Vec<u32>,
}

impl Labels {
    /// The label of the face at `face`, as an index into `names`.
    #[inline]
    pub fn of(&self, face: usize) -> u32 {
        self.of_face[face]
    }

    /// The same names over the faces at `kept`, in that order.
    pub fn select(&self, kept: &[u32]) -> Self {
        let of_face = kept.iter().map(|&f| self.of_face[f as usize]).collect();
        Self { names: self.names.clone(), of_face }
    }
}
