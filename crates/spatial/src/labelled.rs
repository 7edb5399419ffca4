//! Distances from the faces of a mesh that have certain labels.

use meshlod_mesh::{FaceId, Mesh};

use crate::Bvh;
use crate::bvh::{BvhError, INNER};
use crate::closest::Selection;

/// Label of a child whose faces have different labels.
const MIXED: u32 = u32::MAX;

/// Bounding volume hierarchy over faces with labels, such as their connected components, for
/// distances from the faces with some of the labels.
///
/// What has one label is passed over as a whole, however many faces it has.
#[derive(Clone, Debug)]
pub struct LabelledBvh {
    bvh: Bvh,
    of_face: Vec<u32>,
    /// Label of all faces in a node's child, or [`MIXED`].
    of_children: Vec<[u32; 4]>,
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
        let mut of_children = vec![[MIXED; 4]; bvh.nodes.len()];
        // Children follow their parents.
        for (index, node) in bvh.nodes.iter().enumerate().rev() {
            for child in 0..4 {
                let (first, count) = (node.first[child] as usize, node.count[child]);
                of_children[index][child] = if count == INNER {
                    let all = bvh.nodes[first].count.iter().zip(of_children[first]);
                    common(all.filter(|(count, _)| **count > 0).map(|(_, label)| label))
                } else {
                    let faces = &bvh.faces[first..first + usize::from(count)];
                    common(faces.iter().map(|face| of_face[face.index()]))
                };
            }
        }
        Ok(Self { bvh, of_face, of_children })
    }

    /// Returns the squared distance, in square model units, of a finite point from the faces whose
    /// labels `is_wanted` accepts; infinite if there are none.
    ///
    /// Cost: O(log n) for points near the surface, n = faces.
    pub fn squared_distance(&self, point: [f64; 3], is_wanted: impl Fn(u32) -> bool) -> f64 {
        self.bvh.closest_selected(point, &Labels { bvh: self, is_wanted })
    }
}

/// Faces whose labels `is_wanted` accepts.
struct Labels<'b, W> {
    bvh: &'b LabelledBvh,
    is_wanted: W,
}

impl<W: Fn(u32) -> bool> Selection for Labels<'_, W> {
    fn has_child(&self, node: usize, child: usize) -> bool {
        let label = self.bvh.of_children[node][child];
        label == MIXED || (self.is_wanted)(label)
    }

    fn has_face(&self, face: FaceId) -> bool {
        (self.is_wanted)(self.bvh.of_face[face.index()])
    }
}

/// Returns the label that all have in common, or [`MIXED`].
fn common(mut labels: impl Iterator<Item = u32>) -> u32 {
    let Some(first) = labels.next() else { return MIXED };
    if labels.all(|label| label == first) { first } else { MIXED }
}
