//! The contraction forest recorded from a simplification, from which all models are built.

mod by_level;
mod monotone_errors;
mod recorder;
mod smooth_errors;
mod stage;
mod stars;

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DVec3, Vec3};
use meshlod_mesh::{Frame, Mesh};
use meshlod_simplify::{Options, Simplifier, SimplifyError, Topology};
use thiserror::Error;

use crate::error_kind::ErrorKind;
use crate::length16::Length16;
use crate::measured::Posing;
use crate::pack::ExactPositions;
use crate::pack::MIN_ERROR;
use crate::query::{Ball, PackedBall};
use crate::wedges::ForestWedges;

pub(crate) use by_level::by_level;
pub(crate) use monotone_errors::MonotoneErrors;
pub use recorder::Recorder;
pub(crate) use recorder::{MAX_RANKED, used_leaves};
pub(crate) use stage::Stage;
pub(crate) use stars::Stars;

/// Upper bound of levels, exclusive.
pub(crate) const MAX_LEVELS: u16 = 1 << 15;

/// Marks a missing node or update.
pub(crate) const NONE: u32 = u32::MAX;

/// The recorded contractions of a simplification, first to last.
///
/// Nodes are the vertices of all levels. The input's vertices are the leaves and keep their
/// numbers; update `u` contracts its two children into node `vertices + u`. Refinement undoes
/// updates, last to first.
#[derive(Clone, Debug)]
pub struct Forest {
    pub(crate) frame: Frame,
    /// Meaning of the updates' errors.
    pub(crate) error_kind: ErrorKind,
    /// Number of leaves, including those that no face uses.
    pub(crate) vertices: usize,
    /// Position of every node, in stored units.
    pub(crate) positions: Vec<[f32; 3]>,
    /// Exact positions of the leaves, and of nodes that are where a leaf is, if the forest is
    /// lossless.
    pub(crate) exact: ExactPositions,
    pub(crate) updates: Vec<Update>,
    /// Rings of all updates, concatenated: the nodes around an update's node just after its
    /// contraction. If the fan is open, the node that no face follows comes last.
    pub(crate) rings: Vec<u32>,
    /// Faces of the input, by leaves.
    pub(crate) faces: Vec<[u32; 3]>,
    /// Update whose refinement creates each face; [`NONE`] for faces of the base mesh.
    pub(crate) created_by: Vec<u32>,
    /// Wedges of all nodes, if the mesh has attributes, materials or objects.
    pub(crate) wedges: Option<ForestWedges>,
    /// Splits that wings cannot describe, by update.
    pub(crate) non_fan_splits: BTreeMap<u32, NonFanSplit>,
    /// Poses in which errors are measured too.
    pub(crate) posing: Option<Arc<dyn Posing>>,
}

/// Explicit faces of a split whose star is not divided at two wings, because the surface is
/// non-manifold or not consistently oriented there.
#[derive(Clone, Debug, Default)]
pub(crate) struct NonFanSplit {
    /// Faces that go to the second child, each by its two other nodes in order.
    pub(crate) second: Vec<[u32; 2]>,
    /// Faces that the split creates.
    pub(crate) created_faces: Vec<[u32; 3]>,
}

/// An edge contraction. docs/notes/multires.md states the invariants of its fields.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Update {
    /// Nodes that are contracted. The faces of the second form one run of the fan around the new
    /// node.
    pub(crate) children: [u32; 2],
    /// Nodes where that run starts and ends, counter-clockwise; [`NONE`] for an end on the
    /// boundary. Both are `NONE` if a [`NonFanSplit`] describes the faces instead.
    pub(crate) wings: [u32; 2],
    /// Start of its ring in [`Forest::rings`].
    pub(crate) ring: u32,
    /// Greater than the levels of its children and of its ring, and below 2¹⁵.
    pub(crate) level: u16,
    /// Error of its coarse side, at least the error of every update that depends on it.
    pub(crate) error: Length16,
    /// Radius of a ball about its node that holds both sides and its children's balls.
    pub(crate) radius: Length16,
    /// When the run made it, if the mesh has wedges; equal otherwise.
    pub(crate) stage: Stage,
    /// True if its fan is open, so that no face follows the last node of its ring.
    pub(crate) is_open: bool,
    /// True if the first child's faces form one run as well, so that the children could be swapped.
    pub(crate) children_swappable: bool,
    /// True if it forms one face contraction together with its first child's update.
    pub(crate) fused_with_child: bool,
}

/// Reason why no multiresolution model can be built from a mesh.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum BuildError {
    /// The mesh cannot be simplified.
    #[error(transparent)]
    Simplify(#[from] SimplifyError),
    /// The updates depend on each other in too long a chain.
    #[error("the updates depend on each other in a chain of more than {MAX_LEVELS}")]
    TooDeep,
    /// The mesh has more vertices than can be numbered.
    #[error("the mesh has too many vertices: about 2^29 are supported")]
    TooLarge,
    /// A vertex has too many wedges.
    #[error("a vertex has too many sets of attributes: 65,534 are supported")]
    TooManyWedges,
    /// Connected components vanished during simplification, which no update could undo.
    #[error("components vanished, which no update can undo: simplify with `Topology::Keep`")]
    Vanished,
    /// The recorder was attached to the simplifier after the first contraction.
    #[error("the recorder missed the start of the simplification")]
    NotFromStart,
}

impl Forest {
    /// Simplifies a mesh as far as possible and records every contraction.
    ///
    /// Attributes, materials and objects are recorded with the positions. The topology is kept
    /// ([`Topology::Keep`]) whatever the options say, since an update must be undone exactly. What
    /// a lock forbids is in no update, so every level has the locked vertices in place. Tied
    /// vertices are locked, since two updates may be undone apart.
    /// # Errors
    /// The mesh cannot be simplified.
    pub fn new(mesh: &Mesh, options: &Options) -> Result<Self, BuildError> {
        Self::by(mesh, options, Recorder::new)
    }

    /// Simplifies a mesh as far as possible, recording every contraction and the exact positions of
    /// all vertices.
    ///
    /// Levels show a vertex exactly where the input has it as long as it has not moved, and rounded
    /// positions elsewhere. No error is zero, so a tolerance of zero returns the input mesh. Costs 24 bytes
    /// per vertex and two bits per node more.
    /// # Errors
    /// As for [`Forest::new`].
    pub fn lossless(mesh: &Mesh, options: &Options) -> Result<Self, BuildError> {
        Self::by(mesh, options, Recorder::lossless)
    }

    fn by(
        mesh: &Mesh,
        options: &Options,
        recorder: impl FnOnce(&Simplifier<'_>) -> Recorder,
    ) -> Result<Self, BuildError> {
        let simplifier = Simplifier::new(mesh, &Self::options(mesh, options))?;
        let mut recorder = recorder(&simplifier);
        simplifier.run_out(&mut recorder);
        recorder.into_forest()
    }

    /// Returns options by which [`Forest::new`] simplifies a mesh: those given, with the topology
    /// kept and tied vertices locked.
    pub fn options(mesh: &Mesh, options: &Options) -> Options {
        let locks = options.locks.with_ties_locked(mesh.positions.len());
        Options { topology: Topology::Keep, vanish_below: None, locks, ..options.clone() }
    }

    /// Returns the number of faces of the finest mesh.
    pub fn full_faces(&self) -> usize {
        self.faces.len()
    }

    /// Returns the number of recorded edge contractions; a face contraction counts as two.
    pub fn update_count(&self) -> usize {
        self.updates.len()
    }

    /// Returns whether the errors of the updates are estimates or proven bounds.
    pub fn error_kind(&self) -> ErrorKind {
        self.error_kind
    }

    /// Returns the node that an update contracts its children into.
    #[inline]
    pub(crate) fn node(&self, update: usize) -> usize {
        self.vertices + update
    }

    /// Returns the update whose contraction made a node, or `None` for a leaf.
    #[inline]
    pub(crate) fn update_of(&self, node: u32) -> Option<usize> {
        (node as usize).checked_sub(self.vertices)
    }

    /// Returns the nodes around an update's node just after its contraction.
    pub(crate) fn ring(&self, update: usize) -> &[u32] {
        let end = self.updates.get(update + 1).map_or(self.rings.len(), |next| next.ring as usize);
        &self.rings[self.updates[update].ring as usize..end]
    }

    /// Returns the ball and error by which queries judge an update.
    pub(crate) fn ball(&self, update: usize) -> Ball {
        let (radius, error) = (self.updates[update].radius, self.error(update));
        PackedBall { center: self.positions[self.node(update)], radius, error }.unpack()
    }

    /// Returns the error of an update's coarse side. A contraction that leaves the surface
    /// unchanged still removes a vertex, so errors of a lossless forest are at least [`MIN_ERROR`]
    /// and a tolerance of zero asks for every vertex.
    #[inline]
    pub(crate) fn error(&self, update: usize) -> Length16 {
        let error = self.updates[update].error;
        if self.exact.is_lossless() { error.max(MIN_ERROR) } else { error }
    }

    /// Returns the position of a node in stored units, exact if it is known.
    pub(crate) fn exact_stored(&self, node: u32) -> DVec3 {
        let rounded = || Vec3::from(self.positions[node as usize]).as_dvec3();
        self.exact.get(node).map_or_else(rounded, |exact| self.frame.local(exact))
    }

    /// Returns the update that contracts each node, or [`NONE`] for roots.
    pub(crate) fn parents(&self) -> Vec<u32> {
        let mut parents = vec![NONE; self.positions.len()];
        for (u, update) in self.updates.iter().enumerate() {
            update.children.iter().for_each(|&child| parents[child as usize] = u as u32);
        }
        parents
    }
}
