//! Relations between the wedges of an update's children and those of the node that it splits.

use std::ops::Range;

/// A wedge of a child, and those from which its values are predicted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lineage {
    pub(super) wedge: u32,
    /// Number of the parent among the wedges of the split node; `None` if all faces of the wedge
    /// vanish when the children are merged.
    local: Option<u16>,
    /// Parent; the first wedge of the split node if it has lost all its faces there, and `None` if
    /// it is out of range.
    pub(super) parent: Option<u32>,
    /// True for a wedge of the second child.
    pub(super) is_second: bool,
    /// First wedge of the first child that has the same parent, for one of the second child.
    pub(super) sibling: Option<u32>,
    /// The other of two wedges, one of each child, that their parent's values are coded with: the
    /// first of either child that have this parent.
    pub(super) partner: Option<u32>,
}

/// Role of a wedge in the values of an update's children.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// First of a pair: its parent is off the place between both by so many steps.
    Parent,
    /// Second of a pair: the difference of both is off the predicted one.
    Difference,
    /// Any other wedge: it is off its prediction.
    Single,
}

impl Lineage {
    /// Returns true if all faces of the wedge vanish when the children are merged.
    pub(super) fn is_lost(&self) -> bool {
        self.local.is_none()
    }

    pub(super) fn role(&self) -> Role {
        match (self.partner.is_some(), self.is_second) {
            (false, _) => Role::Single,
            (true, false) => Role::Parent,
            (true, true) => Role::Difference,
        }
    }
}

/// Number of wedges that are looked through without a list of their own.
const MAX_SEARCHED: usize = 4;

/// Appends the wedges of an update's children, given those of the split node, or `None` for a node
/// that is not loaded, and the number of each one's parent there, counted from the first child's.
pub(super) fn relate(
    above: Option<Range<u32>>,
    [first, second]: [Range<u32>; 2],
    parent_of: impl Fn(usize) -> Option<u16>,
    all: &mut Vec<Lineage>,
) {
    let from = all.len();
    let local_of = |wedge: u32| parent_of((wedge - first.start) as usize);
    // The first wedge of the first child below each of the split node's. A hub has thousands.
    let below = |wedge| local_of(wedge).map(|local| (local, wedge));
    let mut siblings: Vec<(u16, u32)> = match first.len() {
        ..=MAX_SEARCHED => Vec::new(),
        _ => first.clone().filter_map(below).collect(),
    };
    siblings.sort_unstable();
    siblings.dedup_by_key(|&mut (local, _)| local);
    let sibling_of = |local: u16| {
        if first.len() <= MAX_SEARCHED {
            return first.clone().find(|&wedge| local_of(wedge) == Some(local));
        }
        let found = siblings.binary_search_by_key(&local, |&(local, _)| local);
        found.ok().map(|at| siblings[at].1)
    };
    for wedge in first.start..second.end {
        let local = local_of(wedge);
        let parent = match &above {
            Some(above) => Some(above.start + u32::from(local.unwrap_or(0)))
                .filter(|wedge| above.contains(wedge)),
            // Wedges of a node that is not loaded are never shown.
            None => Some(0),
        };
        let is_second = wedge >= first.end;
        let sibling = local.filter(|_| is_second).and_then(sibling_of);
        all.push(Lineage { wedge, local, parent, is_second, sibling, partner: None });
    }
    mark_pairs(&mut all[from..]);
}

/// Marks for each parent of an update the first wedge of either child that it has.
fn mark_pairs(all: &mut [Lineage]) {
    for at in 0..all.len() {
        let Some(sibling) = all[at].sibling else { continue };
        // Wedges of an update are numbered one after the other.
        let first = (sibling - all[0].wedge) as usize;
        if all[first].partner.is_none() {
            all[first].partner = Some(all[at].wedge);
            all[at].partner = Some(sibling);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_of_either_child_are_a_pair() {
        let mut all = Vec::new();
        let parents = [Some(0), Some(1), Some(1), Some(1), None];
        relate(Some(5..7), [10..12, 12..15], |wedge| parents[wedge], &mut all);
        let parents: Vec<_> = all.iter().map(|of| of.parent).collect();
        assert_eq!(parents, [5, 6, 6, 6, 5].map(Some));
        let partners: Vec<_> = all.iter().map(|of| of.partner).collect();
        assert_eq!(partners, [None, Some(12), Some(11), None, None]);
        assert_eq!(all[3].sibling, Some(11));
        assert!(all[4].is_lost() && all[4].sibling.is_none());
    }

    #[test]
    fn parents_out_of_range_are_none() {
        let mut all = Vec::new();
        relate(Some(5..6), [10..11, 11..12], |wedge| Some(1 - wedge as u16), &mut all);
        assert_eq!((all[0].parent, all[1].parent), (None, Some(5)));
    }
}
