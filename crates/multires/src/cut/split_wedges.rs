//! Wedges of the faces around a vertex that is split or merged.

use super::triangles::{Spoke, Triangles};
use crate::implicit::Implicit;
use crate::wedges::{SplitRecord, Wedges};

/// An update, by what it does to wedges.
pub(super) struct SplitWedges<'m> {
    all: &'m Wedges,
    node: u32,
    children: [u32; 2],
    /// `None` if each child has one wedge.
    record: Option<SplitRecord<'m>>,
}

impl<'m> SplitWedges<'m> {
    #[inline]
    pub(super) fn new(all: &'m Wedges, mt: &Implicit, update: u32) -> Self {
        let children = mt.children(update);
        let record = all.split(update, children, || mt.created_count(update));
        Self { all, node: mt.parent(update), children, record }
    }

    /// Returns the wedge that the `at`-th face of a star gets at a child, given the one before.
    #[inline]
    pub(super) fn around(&self, child: u32, star: &[Spoke], at: usize, before: u32) -> u32 {
        match &self.record {
            None => self.all.first(child),
            Some(record) if record.is_continued() => self.below(child, before),
            Some(record) => {
                let rank = star.iter().filter(|s| [s.a, s.b] < [star[at].a, star[at].b]).count();
                self.all.at(child, record.around(rank).unwrap_or(0))
            }
        }
    }

    /// Returns the first wedge of a child that has the given one for a parent, or else its first.
    fn below(&self, child: u32, parent: u32) -> u32 {
        let (first, skipped) = (self.all.first(child), self.before(child));
        let Some(record) = &self.record else { return first };
        let local = parent.wrapping_sub(self.all.first(self.node));
        let is_below =
            |&at: &u32| record.parent(skipped + at as usize).map(u32::from) == Some(local);
        first + (0..self.all.count(child)).find(is_below).unwrap_or(0)
    }

    /// Returns the number of wedges before those of a child in the record.
    fn before(&self, child: u32) -> usize {
        if child == self.children[1] { self.all.count(self.children[0]) as usize } else { 0 }
    }

    /// Returns the wedges at the corners of the `at`-th face that the split creates.
    pub(super) fn created(
        &self,
        face: [u32; 3],
        at: usize,
        star: &[Spoke],
        triangles: &Triangles,
    ) -> [u32; 3] {
        match &self.record {
            Some(record) if record.is_continued() => {
                return self.continuing(face, record.follows(at), star, triangles);
            }
            Some(record) => {
                let local = record.created(at).unwrap_or_default();
                return std::array::from_fn(|k| self.all.at(face[k], local[k]));
            }
            None => {}
        }
        face.map(|node| match self.children.contains(&node) {
            true => self.all.first(node),
            false => continued(node, star, triangles).unwrap_or_else(|| self.all.first(node)),
        })
    }

    /// Returns the wedges of a created face that continues the one that its wing precedes, or the one
    /// that it follows.
    fn continuing(
        &self,
        face: [u32; 3],
        is_followed: bool,
        star: &[Spoke],
        triangles: &Triangles,
    ) -> [u32; 3] {
        let is_wing = |node: u32| face.contains(&node) && !self.children.contains(&node);
        let next = star.iter().find(|spoke| is_wing(if is_followed { spoke.b } else { spoke.a }));
        let Some(Spoke { corner, .. }) = next else { return face.map(|node| self.all.first(node)) };
        let (t, k) = (corner / 3, *corner as usize % 3);
        let parent = self.merged(triangles.nodes(t)[k], triangles.wedge(*corner));
        let ahead = if is_followed { 2 } else { 1 };
        face.map(|node| match self.children.contains(&node) {
            true => self.below(node, parent),
            false => triangles.wedge(3 * t + ((k + ahead) % 3) as u32),
        })
    }

    /// Returns the wedge of the split node that a child's becomes when they are merged.
    #[inline]
    pub(super) fn merged(&self, child: u32, wedge: u32) -> u32 {
        self.continued(child, wedge).unwrap_or_else(|| self.all.first(self.node))
    }

    /// Returns the wedge of the split node that a child's becomes when they are merged; `None` if
    /// all its faces vanish.
    #[inline]
    pub(super) fn continued(&self, child: u32, wedge: u32) -> Option<u32> {
        let Some(record) = &self.record else { return Some(self.all.first(self.node)) };
        let at = wedge.wrapping_sub(self.all.first(child)) as usize;
        record
            .parent(self.before(child).wrapping_add(at))
            .map(|parent| self.all.at(self.node, parent))
    }
}

impl SplitWedges<'_> {
    /// Returns true if a record, if there is one, is of this many faces around and created.
    pub(super) fn is_complete(&self, around: usize, created: usize) -> bool {
        let count = |child: u32| self.all.count(child) as usize;
        self.record.is_none_or(|record| {
            let parents: usize = self.children.map(count).iter().sum();
            match record.is_continued() {
                true => record.lengths() == [parents, 0, created],
                false => record.lengths() == [parents, around, created],
            }
        })
    }
}

/// Returns the wedge at a neighbour of the split node in the face that it precedes there, or else
/// in the one that it follows.
fn continued(node: u32, star: &[Spoke], triangles: &Triangles) -> Option<u32> {
    let before = star.iter().find(|spoke| spoke.a == node).map(|spoke| (spoke, 1));
    let after = || star.iter().find(|spoke| spoke.b == node).map(|spoke| (spoke, 2));
    let (Spoke { corner, .. }, ahead) = before.or_else(after)?;
    Some(triangles.wedge(corner / 3 * 3 + (corner % 3 + ahead) % 3))
}
