//! The implicit multi-triangulation (MT): packed contractions, with no triangles but the base
//! mesh's.
//!
//! A split is described by two wings, between which the faces of the second child lie; each is
//! stored as a rank among the vertices around. Dependencies are expressed by levels: a vertex may
//! be split once all vertices around it have lower levels, and these are then exactly the recorded
//! ones. That is also why ranks suffice for wings. docs/notes/multires.md has the proof.
//!
//! | bytes per update | |
//! |--:|---|
//! | 24 | positions of its two children |
//! | 8 | the node it splits, and the start of the second child's updates |
//! | 4 | radius and error |
//! | 4 | level and wings |
//!
//! The [compact form](Implicit::compacted) takes 12 bytes for positions and 10 for the rest.
//!
//! | files, in reading order | hold |
//! |---|---|
//! | `order`, `updates`, `splits`, `positions`, `wedges` | what is stored |
//! | `from_forest`, `assemble`, `compact`, `with_normals` | how it is made |
//! | `dependencies`, `saturated` | what an update needs |
//! | `faces`, `extractor`, `budget` | single meshes |

mod assemble;
mod budget;
mod compact;
#[cfg(test)]
mod corrupted;
mod dependencies;
mod extractor;
mod faces;
mod from_forest;
mod order;
mod positions;
mod saturated;
mod splits;
mod updates;
mod wedges;
mod with_normals;

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DVec3, Vec3};
use meshlod_mesh::Frame;

use crate::error_kind::ErrorKind;
use crate::forest::{MAX_LEVELS, NonFanSplit};
use crate::level::Level;
use crate::pack::{ExactPositions, PackedTable};
use crate::wedges::{LevelWedges, Wedges};

pub(crate) use assemble::{BaseMesh, DetachedUpdate, ModelInfo, has_three_corners};
pub(crate) use budget::Weight;
pub(crate) use dependencies::Dependencies;
pub use dependencies::SplitRule;
pub use extractor::Extractor;
pub(crate) use faces::Faces;
pub(crate) use order::Order;
pub(crate) use saturated::SaturatedBalls;

use self::positions::StoredPositions;
use self::splits::Splits;

/// All levels of a mesh as packed contractions, in 40 bytes per vertex or 22 in compact form.
///
/// Nodes are the vertices of all levels: first the roots, then the children of update 0, of update
/// 1…
#[derive(Clone, Debug)]
pub struct Implicit {
    frame: Frame,
    error_kind: ErrorKind,
    roots: u32,
    /// Start of the updates below each root, and the end of the last.
    trees: Vec<u32>,
    positions: StoredPositions,
    /// Exact positions of the input's vertices, if the model is lossless.
    exact: ExactPositions,
    splits: Splits,
    /// Faces of the base mesh, by roots.
    base: Vec<[u32; 3]>,
    /// Splits that wings cannot describe, by update, in nodes of this model.
    non_fan_splits: BTreeMap<u32, NonFanSplit>,
    /// Numbers of the updates' stages; none if the model has no wedges.
    stages: PackedTable,
    /// Wedges, if the mesh has attributes, materials or objects.
    wedges: Option<Arc<Wedges>>,
    full_faces: usize,
}

/// A wing as an update stores it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wing {
    /// No wing: the run of faces starts or ends on the boundary.
    None,
    /// Rank among the surrounding nodes that a face follows counter-clockwise.
    Rank(u8),
    /// The one surrounding node that no face follows.
    Last,
}

const FLAG: u32 = 1 << 31;
const OPEN: u16 = MAX_LEVELS;
const NO_WING: u8 = u8::MAX;
const LAST_WING: u8 = u8::MAX - 1;

impl Implicit {
    /// Returns the number of updates (vertex splits) between the base mesh and the finest mesh.
    pub fn update_count(&self) -> usize {
        self.splits.len()
    }

    /// Returns the number of vertices of the base mesh.
    pub fn root_count(&self) -> usize {
        self.roots as usize
    }

    /// Returns the number of faces of the base mesh.
    pub fn base_faces(&self) -> usize {
        self.base.len()
    }

    /// Returns the number of faces of the finest mesh.
    pub fn full_faces(&self) -> usize {
        self.full_faces
    }

    /// Returns whether the errors of the updates are estimates or proven bounds.
    pub fn error_kind(&self) -> ErrorKind {
        self.error_kind
    }

    /// Returns the position of a node in model units, exactly as in the input if the model stores
    /// it.
    ///
    /// Vertices of a [`Patch`](crate::Patch) or a [`Level`](crate::Level) are identified by their
    /// nodes.
    ///
    /// # Panics
    /// `node` is not below [`node_count`](Self::node_count).
    pub fn position(&self, node: u32) -> [f64; 3] {
        self.exact
            .get(node)
            .unwrap_or_else(|| self.frame.model(Vec3::from(self.stored_position(node))))
    }

    /// Returns the two nodes that a node is split into, or `None` for a vertex of the finest mesh.
    ///
    /// They have higher numbers than the node.
    ///
    /// # Panics
    /// As for [`position`](Self::position).
    pub fn children_of(&self, node: u32) -> Option<[u32; 2]> {
        self.update_of(node).map(|update| self.children(update))
    }

    /// Returns the number of nodes, which are the vertices of all levels.
    pub fn node_count(&self) -> usize {
        self.positions.len()
    }

    /// Returns a compact form of the model with 22 bytes per vertex, or `None` if the numbers would
    /// change.
    ///
    /// The positions of two children take 12 of these bytes, and the rest of an update 10.
    ///
    /// The compact model gives the same answers, and extraction reads half the memory. Returns
    /// `None` if anything would change: if radii, errors or positions are more precise than those
    /// of a file, as in a fresh [`Forest`](crate::Forest); if a position is beyond 32,767 cells,
    /// which does not happen in files with a rounding of .0017 % of the diagonal or more, unless a
    /// contraction left the bounding box; or if there are 4,096 levels of one error.
    pub fn compacted(&self) -> Option<Self> {
        let (positions, splits) = (self.positions.compacted()?, self.splits.compacted(self.roots)?);
        let (trees, base, non_fan_splits) =
            (self.trees.clone(), self.base.clone(), self.non_fan_splits.clone());
        let (exact, wedges, stages) =
            (self.exact.clone(), self.wedges.clone(), self.stages.clone());
        Some(Self {
            positions,
            splits,
            trees,
            base,
            non_fan_splits,
            exact,
            wedges,
            stages,
            ..*self
        })
    }

    /// Returns the memory used by the model, in bytes.
    pub fn bytes(&self) -> usize {
        let non_fan = |o: &NonFanSplit| {
            size_of::<NonFanSplit>()
                + size_of_val(&o.second[..])
                + size_of_val(&o.created_faces[..])
        };
        size_of_val(&self.trees[..])
            + self.positions.bytes()
            + self.exact.bytes()
            + self.splits.bytes()
            + size_of_val(&self.base[..])
            + self.non_fan_splits.values().map(non_fan).sum::<usize>()
            + self.stages.bytes()
            + self.wedges.as_ref().map_or(0, |wedges| wedges.bytes())
    }

    pub(crate) fn frame(&self) -> &Frame {
        &self.frame
    }

    /// Returns the stored position of a node.
    #[inline]
    pub(crate) fn stored_position(&self, node: u32) -> [f32; 3] {
        self.positions.at(node)
    }

    /// Returns the position of a node in stored units, exact if it is known.
    pub(crate) fn exact_stored(&self, node: u32) -> DVec3 {
        let rounded = || Vec3::from(self.stored_position(node)).as_dvec3();
        self.exact.get(node).map_or_else(rounded, |exact| self.frame.local(exact))
    }

    /// Builds a level from faces over the model's nodes, with the wedges at their corners.
    pub(crate) fn level_from_faces(&self, faces: Vec<[u32; 3]>, corners: Vec<[u32; 3]>) -> Level {
        let place = |node: u32| self.stored_position(node);
        let mut level = Level::from_nodes(self.frame, self.node_count(), place, faces);
        level.exact = self.exact.clone();
        level.wedges = self.wedges.clone().map(|all| LevelWedges { corners, all });
        level
    }

    /// Returns the wedges, if the mesh has attributes, materials or objects.
    #[inline]
    pub(crate) fn wedges(&self) -> Option<&Arc<Wedges>> {
        self.wedges.as_ref()
    }

    /// Returns the exact positions by node.
    pub(crate) fn exact(&self) -> &ExactPositions {
        &self.exact
    }

    pub(crate) fn base(&self) -> &[[u32; 3]] {
        &self.base
    }

    /// Returns each root with the range of updates below it.
    pub(crate) fn roots(&self) -> impl Iterator<Item = (u32, [u32; 2])> + '_ {
        (0..self.roots)
            .map(|root| (root, [self.trees[root as usize], self.trees[root as usize + 1]]))
    }

    /// Returns the subtrees of both children of a split node, the second one first.
    #[inline]
    fn below(&self, Subtree { start, end, leaf, .. }: Subtree) -> [Subtree; 2] {
        let [first, second] = self.children(start);
        let middle = self.splits.second(start) & !FLAG;
        // A subtree has one leaf more than updates.
        let next = leaf + middle - start;
        [
            Subtree { node: second, start: middle, end, leaf: next },
            Subtree { node: first, start: start + 1, end: middle, leaf },
        ]
    }
}

/// A node with the updates below it.
#[derive(Clone, Copy, Debug, Default)]
struct Subtree {
    node: u32,
    /// Start of the range of updates below it; the first one splits it.
    start: u32,
    end: u32,
    /// Its first leaf.
    leaf: u32,
}
