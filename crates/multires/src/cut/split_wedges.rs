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

    /// Returns the wedge that the `at`-th face of a star gets at a child.
    #[inline]
    pub(super) fn around(&self, child: u32, star: &[Spoke], at: usize) -> u32 {
        let local = self.record.as_ref().map_or(0, |record| {
            let rank = star.iter().filter(|s| [s.a, s.b] < [star[at].a, star[at].b]).count();
            record.around(rank).unwrap_or(0)
        });
        self.all.at(child, local)
    }

    /// Returns the wedges at the corners of the `at`-th face that the split creates.
    pub(super) fn created(
        &self,
        face: [u32; 3],
        at: usize,
        star: &[Spoke],
        triangles: &Triangles,
    ) -> [u32; 3] {
        if let Some(record) = &self.record {
            let local = record.created(at).unwrap_or_default();
            return std::array::from_fn(|k| self.all.at(face[k], local[k]));
        }
        face.map(|node| match self.children.contains(&node) {
            true => self.all.first(node),
            false => continued(node, star, triangles).unwrap_or_else(|| self.all.first(node)),
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
        let before = if child == self.children[1] { self.all.count(self.children[0]) } else { 0 };
        let at = before + wedge.wrapping_sub(self.all.first(child));
        record.parent(at as usize).map(|parent| self.all.at(self.node, parent))
    }
}

impl SplitWedges<'_> {
    /// Returns true if a record, if there is one, is of this many faces around and created.
    pub(super) fn is_complete(&self, around: usize, created: usize) -> bool {
        let count = |child: u32| self.all.count(child) as usize;
        self.record.is_none_or(|record| {
            record.lengths() == [self.children.map(count).iter().sum(), around, created]
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
