//! Faces of a compressed mesh: grown in patches, or as strips of parts.

use meshlod_mesh::Labels;

use super::face_labels::FaceLabels;
use super::strips::{PartStrips, StripsError};
use super::{Compressed, Positions};
use crate::bytes::Malformed;
use crate::patch::{Patches, Rows};

/// Stored faces, patch by patch; with parts, a patch is a part.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Faces {
    Patches(Patches),
    Strips(PartStrips),
}

impl Faces {
    /// Returns the rows of the nodes.
    pub(super) fn rows(&self) -> &Rows {
        match self {
            Self::Patches(patches) => patches.rows(),
            Self::Strips(strips) => strips.rows(),
        }
    }

    /// Returns the number of patches.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Patches(patches) => patches.len(),
            Self::Strips(strips) => strips.rows().len(),
        }
    }

    /// Returns rows of faces: a row is a patch.
    pub(super) fn face_rows(&self) -> Rows {
        match self {
            Self::Patches(patches) => Rows::new(patches.face_counts()),
            Self::Strips(strips) => Rows::new(strips.face_counts()),
        }
    }

    pub(super) fn face_count(&self) -> usize {
        match self {
            Self::Patches(patches) => patches.face_count(),
            Self::Strips(strips) => strips.face_counts().sum(),
        }
    }

    /// Decodes the faces of one patch as nodes.
    pub(super) fn of_patch(&self, patch: usize) -> Result<Vec<[u32; 3]>, Malformed> {
        match self {
            Self::Patches(patches) => patches.faces(patch),
            Self::Strips(strips) => Ok(strips.faces(patch)),
        }
    }

    pub(super) fn strips(&self) -> Option<&PartStrips> {
        if let Self::Strips(strips) = self { Some(strips) } else { None }
    }

    pub(super) fn bytes(&self) -> usize {
        match self {
            Self::Patches(patches) => patches.bytes(),
            Self::Strips(strips) => strips.bytes(),
        }
    }

    pub(super) fn store(&self, out: &mut Vec<u8>) {
        match self {
            Self::Patches(patches) => patches.store(out),
            Self::Strips(strips) => strips.store(out),
        }
    }
}

impl Compressed {
    /// Stores the faces of each part as triangle strips, which a GPU draws as they are, in place of
    /// the fewer bits that must be decoded to indices.
    ///
    /// Strips are sequences of nodes, numbered as in [`StoredMesh::faces`](super::StoredMesh::faces),
    /// and draw exactly those faces, with their winding. Those of a part keep their order, which is
    /// that of the faces from now on; materials and objects follow them.
    ///
    /// Cost: O(n log n).
    /// # Errors
    /// Positions that are not in parts, strips that cross from one part to another, or draw other
    /// faces.
    pub fn with_strips<S: IntoIterator<Item = u32>>(
        mut self,
        strips: impl IntoIterator<Item = S>,
    ) -> Result<Self, StripsError> {
        let Positions::Parts(parts) = &self.positions else { return Err(StripsError::NoParts) };
        let strips = PartStrips::new(parts.rows().clone(), strips)?;
        let mut order = Vec::with_capacity(self.faces());
        for part in 0..self.faces.len() {
            let first = order.len();
            let places = places(&self.faces.of_patch(part)?, &strips.faces(part));
            let places = places.ok_or(StripsError::OtherFaces(part))?;
            order.extend(places.into_iter().map(|place| first + place));
        }
        self.faces = Faces::Strips(strips);
        let reordered = |labels: FaceLabels| {
            let Labels { names, of_face } = labels.all();
            let of_face: Vec<u32> = order.iter().map(|&face| of_face[face]).collect();
            FaceLabels::new(names, self.faces.face_rows(), &of_face)
        };
        self.labels = self.labels.map(|labels| labels.map(reordered));
        Ok(self)
    }
}

/// Returns the place in `faces` of each face that is drawn; `None` if these are not the same faces.
fn places(faces: &[[u32; 3]], drawn: &[[u32; 3]]) -> Option<Vec<usize>> {
    let sorted = |faces: &[[u32; 3]]| {
        let turned = |mut face: [u32; 3]| {
            let least = (0..3).min_by_key(|&k| face[k]).unwrap_or(0);
            face.rotate_left(least);
            face
        };
        let mut sorted: Vec<_> = faces.iter().map(|&face| turned(face)).zip(0..).collect();
        sorted.sort_unstable();
        sorted
    };
    let (faces, drawn) = (sorted(faces), sorted(drawn));
    if !faces.iter().map(|(face, _)| face).eq(drawn.iter().map(|(face, _)| face)) {
        return None;
    }
    let mut places = vec![0; drawn.len()];
    drawn.iter().zip(&faces).for_each(|(&(_, at), &(_, place))| places[at] = place);
    Some(places)
}

#[cfg(test)]
mod tests {
    use meshlod_mesh::AttributeBounds;
    use meshlod_samples as samples;

    use super::*;
    use crate::{Partitioner, Reconstruction};

    fn in_parts(count: usize) -> Compressed {
        let mesh = samples::gyroid(600);
        let parts = Partitioner::new(&mesh).unwrap().with_count(count, Reconstruction::Centred);
        Compressed::in_parts(&mesh, &parts, &AttributeBounds::default()).unwrap().compressed
    }

    #[test]
    fn strips_that_draw_other_faces_are_refused() {
        let compressed = in_parts(3);
        let stored = compressed.stored().unwrap();
        let (mut faces, patches) = (stored.faces.clone(), stored.patches.clone());
        let with = |faces: &[[u32; 3]]| compressed.clone().with_strips(faces.iter().copied());
        assert_eq!(with(&faces).unwrap().decode(), compressed.decode());
        let at = patches[1].start as usize;
        faces[at].reverse();
        assert_eq!(with(&faces), Err(StripsError::OtherFaces(1)), "turned over");
        faces[at].reverse();
        faces.push(faces[at]);
        assert_eq!(with(&faces), Err(StripsError::OtherFaces(1)), "drawn twice");
        faces.pop();
        let last = faces.pop();
        assert_eq!(with(&faces), Err(StripsError::OtherFaces(2)), "left out");
        faces.extend(last);
        faces[at][0] = faces[0][0];
        assert!(matches!(with(&faces), Err(StripsError::Foreign(_))));
    }
}
