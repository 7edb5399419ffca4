//! Proof that wedges do not depend on the cut: what a split gives to a face, a merge takes back.

use std::ops::Range;

use super::front::Front;
use super::split_wedges::SplitWedges;

/// Wedges of the faces around a vertex before it is split.
#[derive(Default)]
pub(super) struct CoarseWedges(Vec<[u32; 3]>);

impl CoarseWedges {
    /// Keeps the wedges of the given faces.
    pub(super) fn take(&mut self, front: &Front<'_>, around: &[u32]) {
        self.0.clear();
        self.0.extend(around.iter().filter_map(|&t| front.triangles.wedges(t)));
    }

    /// Returns true if the faces have, after an update, wedges of their nodes that its merge turns
    /// into those before, and if the faces that it has created have wedges of their nodes.
    pub(super) fn continue_in(
        &self,
        front: &Front<'_>,
        update: u32,
        around: &[u32],
        created: Range<u32>,
    ) -> bool {
        let Some(all) = front.mt.wedges() else { return true };
        let split = SplitWedges::new(all, front.mt, update);
        let children = front.mt.children(update);
        let goes_back = |(&t, before): (&u32, &[u32; 3])| {
            let (nodes, after) = (front.triangles.nodes(t), front.triangles.wedges(t));
            let after = after.unwrap_or(*before);
            (0..3).all(|k| match children.contains(&nodes[k]) {
                true => split.merged(nodes[k], after[k]) == before[k],
                false => after[k] == before[k],
            })
        };
        split.is_complete(around.len(), created.len())
            && around.iter().zip(&self.0).all(goes_back)
            && are_of_their_nodes(front, around.iter().copied().chain(created))
    }
}

/// Returns true if faces have wedges of their own nodes, all of one material and object.
pub(super) fn are_of_their_nodes(front: &Front<'_>, mut faces: impl Iterator<Item = u32>) -> bool {
    let Some(all) = front.mt.wedges() else { return true };
    faces.all(|t| {
        let wedges = front.triangles.wedges(t);
        wedges.is_some_and(|wedges| all.may_be_at(wedges, front.triangles.nodes(t)))
    })
}
