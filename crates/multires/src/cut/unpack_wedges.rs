//! Conversion of the wedges of a packed model back to those of a forest.

use super::front::Front;
use super::split_wedges::SplitWedges;
use super::triangles::Triangles;
use crate::forest::NONE;
use crate::wedges::{ForestWedges, WedgeSplit, Wedges};

/// Maps between the nodes of a model and those of a forest built from it.
pub(super) struct NodeNumbers<'n> {
    /// Model node of each forest node.
    pub(super) in_model: Vec<u32>,
    /// Forest node of each model node.
    pub(super) in_forest: &'n [u32],
}

impl NodeNumbers<'_> {
    /// Returns the wedges of all nodes of a forest, still without links and faces.
    pub(super) fn unpacked(&self, all: &Wedges) -> ForestWedges {
        let wedges = self.in_model.iter().flat_map(|&node| all.of(node));
        let mut first = vec![0];
        first.extend(self.in_model.iter().scan(0, |end, &node| {
            *end += all.count(node);
            Some(*end)
        }));
        ForestWedges {
            parents: vec![NONE; all.first(self.in_model.len() as u32) as usize],
            first,
            values: all.values.unpacked(wedges.clone()),
            labels: all.labels.unpacked(wedges),
            ..ForestWedges::default()
        }
    }

    /// Returns the forest's wedges at the corners of a triangle.
    pub(super) fn corners(
        &self,
        (forest, all): (&ForestWedges, &Wedges),
        triangles: &Triangles,
        t: u32,
    ) -> [u32; 3] {
        let (nodes, wedges) = (triangles.nodes(t), triangles.wedges(t).unwrap_or_default());
        std::array::from_fn(|k| {
            forest.first[self.in_forest[nodes[k] as usize] as usize] + wedges[k]
                - all.first(nodes[k])
        })
    }

    /// Links the wedges of an update that `front` has just applied, and records it as update `u` if
    /// the model does. Triangles from slot `created` on are new.
    pub(super) fn unpack(
        &self,
        (forest, all): (&mut ForestWedges, &Wedges),
        front: &Front<'_>,
        (update, u): (u32, u32),
        created: u32,
    ) {
        let mt = front.mt;
        let split = SplitWedges::new(all, mt, update);
        let place = |node: u32| self.in_forest[node as usize];
        let above = forest.first[place(mt.parent(update)) as usize];
        for child in mt.children(update) {
            for (wedge, to) in all.of(child).zip(forest.of(place(child))) {
                let parent = split.merged(child, wedge) - all.first(mt.parent(update));
                forest.parents[to as usize] = above + parent;
            }
        }
        if !all.is_recorded(update) {
            return;
        }
        let around = front.last_star().iter().map(|spoke| {
            let corners = self.corners((forest, all), &front.triangles, spoke.triangle());
            let wedge = |ahead: usize| corners[(spoke.corner as usize + ahead) % 3];
            ([spoke.a, spoke.b].map(place), [0, 1, 2].map(wedge))
        });
        let created = (created..front.triangles.slots() as u32).map(|t| {
            let nodes = front.triangles.nodes(t).map(place);
            (nodes, self.corners((forest, all), &front.triangles, t))
        });
        let split = WedgeSplit { around: around.collect(), created: created.collect() };
        forest.splits.insert(u, split);
    }
}
