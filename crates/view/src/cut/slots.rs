//! Slots of triangles by group: each group has its own list, in which its triangles have slots.

use super::groups::Groups;

/// Places of the triangles of a cut in the lists of their groups, and their vertices at last.
#[derive(Debug)]
pub(super) struct GroupSlots {
    /// Place of each slot of the cut.
    places: Vec<Place>,
    /// Free slots of each group.
    free: Vec<Vec<u32>>,
    /// Number of slots of each group.
    lengths: Vec<u32>,
}

/// Triangle in the list of a group; `vertices` is `None` in an empty slot.
#[derive(Clone, Copy, Debug)]
struct Place {
    vertices: Option<[u32; 3]>,
    group: u32,
    slot: u32,
}

/// Change of one slot in the list of a group.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct CutPatch {
    /// Number of the group: faces of one mesh and one material.
    pub group: u32,
    /// Slot in the group's list.
    pub slot: u32,
    /// Vertices of the triangle that is there now: wedges of the model, or nodes if it has none;
    /// `None` for a slot that is empty now.
    pub vertices: Option<[u32; 3]>,
}

const EMPTY: Place = Place { vertices: None, group: 0, slot: 0 };

impl GroupSlots {
    pub(super) fn new(groups: &Groups) -> Self {
        let count = groups.all.len();
        Self { places: Vec::new(), free: vec![Vec::new(); count], lengths: vec![0; count] }
    }

    /// Takes the new contents of slots of the cut, and returns the changes of the groups' lists, in
    /// rising order.
    pub(super) fn update(
        &mut self,
        groups: &Groups,
        now: impl Iterator<Item = (u32, Option<[u32; 3]>)>,
    ) -> Vec<CutPatch> {
        let mut patches = Vec::new();
        let mut coming = Vec::new();
        for (at, vertices) in now {
            if at as usize >= self.places.len() {
                self.places.resize(at as usize + 1, EMPTY);
            }
            let place = &mut self.places[at as usize];
            if place.vertices == vertices {
                continue;
            }
            let Place { group, slot, .. } = *place;
            if let Some([vertex, ..]) = vertices {
                let wanted = groups.of(vertex);
                if place.vertices.is_none() || wanted != group {
                    coming.push((at, vertices, wanted));
                } else {
                    patches.push(CutPatch { group, slot, vertices });
                }
            }
            let stays = vertices.is_some_and(|[vertex, ..]| groups.of(vertex) == group);
            if place.vertices.is_some() && !stays {
                self.free[group as usize].push(slot);
                patches.push(CutPatch { group, slot, vertices: None });
            }
            place.vertices = vertices;
        }
        // Slots that were freed are taken again, so that lists stay short.
        for (at, vertices, group) in coming {
            let slot = self.free[group as usize].pop().unwrap_or_else(|| {
                self.lengths[group as usize] += 1;
                self.lengths[group as usize] - 1
            });
            self.places[at as usize] = Place { vertices, group, slot };
            patches.push(CutPatch { group, slot, vertices });
        }
        // Of a slot that is left and taken, the later patch counts.
        patches.sort_by_key(|patch| (patch.group, patch.slot));
        patches.dedup_by(|later, kept| {
            let is_same = (later.group, later.slot) == (kept.group, kept.slot);
            if is_same {
                *kept = *later;
            }
            is_same
        });
        patches
    }
}
