//! The faces around each vertex when it is split, with their wedges: the same in every cut, and in
//! every part of a file that has what the update depends on.

use super::front::Front;
use crate::forest::{MAX_LEVELS, by_level};
use crate::implicit::Implicit;

/// A face around a vertex that is split.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StarFace {
    /// The other two nodes, counter-clockwise.
    nodes: [u32; 2],
    /// Wedge of the vertex.
    pub(crate) own: u32,
    /// Wedges of the other two nodes.
    pub(crate) others: [u32; 2],
}

/// The faces around each vertex when it is split, in the order in which updates are applied.
#[derive(Default)]
pub(crate) struct SplitStars {
    /// Each update, with the end of its faces.
    ends: Vec<(u32, usize)>,
    faces: Vec<StarFace>,
}

impl SplitStars {
    /// Collects the faces around all vertices of a model that are split.
    pub(crate) fn of(mt: &Implicit) -> Self {
        let mut all = Self::default();
        each_split_star(mt, |update, star| {
            all.faces.extend_from_slice(star);
            all.ends.push((update, all.faces.len()));
        });
        all
    }

    /// Iterates over updates with the faces around the vertex that they split.
    pub(crate) fn iter(&self) -> impl DoubleEndedIterator<Item = (u32, &[StarFace])> {
        let star = |at: usize| {
            let (update, end) = self.ends[at];
            let start = if at == 0 { 0 } else { self.ends[at - 1].1 };
            (update, &self.faces[start..end])
        };
        (0..self.ends.len()).map(star)
    }
}

/// Applies all updates, highest levels first, and visits each with the faces around its vertex just
/// before, sorted so that sums over them do not depend on the cut.
///
/// In a part of a file, updates whose dependencies are missing are left out, or have any star;
/// those that depend on nothing missing have their own. Cost: linear, apart from sorting the stars.
pub(crate) fn each_split_star(mt: &Implicit, mut visit: impl FnMut(u32, &[StarFace])) {
    let (mut front, mut faces, mut first) = (Front::new(mt), Vec::new(), Vec::new());
    for update in by_level(mt.update_count(), |update| MAX_LEVELS - mt.level(update)) {
        first.clear();
        if !front.is_active(mt.parent(update)) || !front.may_split(update, &mut first) {
            continue;
        }
        faces.clear();
        faces.extend(front.last_star().iter().map(|spoke| {
            let wedges = front.triangles.wedges(spoke.triangle()).unwrap_or_default();
            let [own, a, b] = [0, 1, 2].map(|ahead| wedges[(spoke.corner as usize + ahead) % 3]);
            StarFace { nodes: [spoke.a, spoke.b], own, others: [a, b] }
        }));
        faces.sort_unstable_by_key(|face: &StarFace| (face.nodes, face.others, face.own));
        front.apply(update);
        visit(update, &faces);
    }
}
