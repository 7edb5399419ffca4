//! Distance to the remaining faces of a mesh, excluding one label.

use meshlod_mesh::{FaceId, Mesh};

use crate::Bvh;
use crate::bvh::{BvhError, INNER};
use crate::closest::Selection;

/// Label of a child whose faces have different labels.
const MIXED: u32 = u32::MAX;

/// Bounding volume hierarchy over faces with labels, such as their connected components. Faces can
/// be removed, and distances exclude one label.
///
/// What has that label, or nothing left, is passed over as a whole, however many faces it has.
#[derive(Clone, Debug)]
pub struct LabelledBvh {
    bvh: Bvh,
    of_face: Vec<u32>,
    is_left: Vec<bool>,
    nodes: Vec<[Child; 4]>,
    /// Child that each node is, as an index into all children.
    parents: Vec<u32>,
    /// Child that each face is in, as an index into all children.
    leaves: Vec<u32>,
}

/// Faces below a child of a node.
#[derive(Clone, Copy, Debug)]
struct Child {
    /// Label of all its faces, or [`MIXED`].
    label: u32,
    /// Number of faces left.
    left: u32,
}

impl LabelledBvh {
    /// Builds the hierarchy over the faces of `mesh`, each with a label below [`u32::MAX`].
    ///
    /// Cost: O(n log n), n = faces; in parallel.
    /// # Errors
    /// No faces; a position that is not finite; an index out of range.
    ///
    /// # Panics
    /// If there are fewer labels than faces.
    pub fn new(mesh: &Mesh, of_face: Vec<u32>) -> Result<Self, BvhError> {
        let bvh = Bvh::new(mesh)?;
        let mut nodes = vec![[Child { label: MIXED, left: 0 }; 4]; bvh.nodes.len()];
        let mut parents = vec![u32::MAX; nodes.len()];
        let mut leaves = vec![0; of_face.len()];
        // Children follow their parents.
        for (index, node) in bvh.nodes.iter().enumerate().rev() {
            for child in 0..4 {
                let (first, count) = (node.first[child] as usize, node.count[child]);
                let own = (4 * index + child) as u32;
                nodes[index][child] = if count == INNER {
                    parents[first] = own;
                    let used = nodes[first].iter().filter(|child| child.left > 0);
                    let left = used.clone().map(|child| child.left).sum();
                    Child { label: common(used.map(|child| child.label)), left }
                } else {
                    let faces = &bvh.faces[first..first + usize::from(count)];
                    faces.iter().for_each(|face| leaves[face.index()] = own);
                    let label = common(faces.iter().map(|face| of_face[face.index()]));
                    Child { label, left: count.into() }
                };
            }
        }
        let is_left = vec![true; of_face.len()];
        Ok(Self { bvh, of_face, is_left, nodes, parents, leaves })
    }

    /// Removes a face, if it is left.
    ///
    /// Cost: O(log n), n = faces.
    pub fn remove(&mut self, face: FaceId) {
        if !std::mem::replace(&mut self.is_left[face.index()], false) {
            return;
        }
        let mut at = self.leaves[face.index()];
        while at != u32::MAX {
            let (node, child) = (at as usize / 4, at as usize % 4);
            self.nodes[node][child].left -= 1;
            at = self.parents[node];
        }
    }

    /// Returns the squared distance, in square model units, of a finite point from the remaining
    /// faces with a label other than `label`; infinite without such faces.
    ///
    /// Cost: O(log n) for points near these faces, n = faces.
    pub fn squared_distance(&self, point: [f64; 3], label: u32) -> f64 {
        self.bvh.closest_selected(point, &Without { bvh: self, label })
    }
}

/// Faces that are left and do not have one label.
struct Without<'b> {
    bvh: &'b LabelledBvh,
    label: u32,
}

impl Selection for Without<'_> {
    fn has_child(&self, node: usize, child: usize) -> bool {
        let Child { label, left } = self.bvh.nodes[node][child];
        left > 0 && label != self.label
    }

    fn has_face(&self, face: FaceId) -> bool {
        self.bvh.is_left[face.index()] && self.bvh.of_face[face.index()] != self.label
    }
}

/// Returns the label that all have in common, or [`MIXED`].
fn common(mut labels: impl Iterator<Item = u32>) -> u32 {
    let Some(first) = labels.next() else { return MIXED };
    if labels.all(|label| label == first) { first } else { MIXED }
}
