//! What a simplification did, as a forest: the source that both encodings are made of.

mod by_level;
mod recorder;
mod smooth_errors;

use std::collections::BTreeMap;

use glam::{DVec3, Vec3};
use meshlod_mesh::Mesh;
use meshlod_simplify::{Options, Simplifier, SimplifyError, Target};
use thiserror::Error;

use crate::bounds::ErrorKind;
use crate::frame::{Frame, Length16};
use crate::pack::ExactPositions;
use crate::pack::MIN_ERROR;
use crate::query::{Ball, PackedBall};

pub(crate) use by_level::by_level;
pub(crate) use recorder::MAX_RANKED;
pub use recorder::Recorder;

/// Levels stay below this.
pub(crate) const MAX_LEVELS: u16 = 1 << 15;

/// No node, or no update.
pub(crate) const NONE: u32 = u32::MAX;

/// All contractions of a simplification, first to last.
///
/// Nodes are the vertices of all levels: the input's are the leaves, numbered as there; update `u`
/// makes node `vertices + u` of its children. Refining undoes updates, last to first.
#[derive(Clone, Debug)]
pub struct Forest {
    pub(crate) frame: Frame,
    /// What the updates' errors are.
    pub(crate) error_kind: ErrorKind,
    /// How many leaves, also those that no face uses.
    pub(crate) vertices: usize,
    /// Of every node, in stored units.
    pub(crate) positions: Vec<[f32; 3]>,
    /// Of leaves, where the input is kept to the bit.
    pub(crate) exact: ExactPositions,
    pub(crate) updates: Vec<Update>,
    /// The nodes around each update's node just after its contraction, one update after the other;
    /// where the fan is open, its last node is the last.
    pub(crate) rings: Vec<u32>,
    /// The faces that the simplification began with, by leaves.
    pub(crate) faces: Vec<[u32; 3]>,
    /// The update that brings each face back; [`NONE`] for those of the base.
    pub(crate) created_by: Vec<u32>,
    /// What wings cannot tell, by update.
    pub(crate) non_fan_splits: BTreeMap<u32, NonFanSplit>,
}

/// An update whose faces do not part at wings: the surface is not manifold there, or not oriented.
#[derive(Clone, Debug, Default)]
pub(crate) struct NonFanSplit {
    /// The two other nodes of each face that its second child takes, as they follow it.
    pub(crate) second: Vec<[u32; 2]>,
    /// The faces that it brings.
    pub(crate) created_faces: Vec<[u32; 3]>,
}

/// A contraction of an edge; see the notes for what its numbers promise.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Update {
    /// The nodes that become one. The second's faces are one run of the fan around the new node.
    pub(crate) children: [u32; 2],
    /// The nodes where that run starts and where it ends, counter-clockwise; [`NONE`] for an end on
    /// the boundary. Both are `NONE` where an [`Odd`] tells instead.
    pub(crate) wings: [u32; 2],
    /// Where its ring starts.
    pub(crate) ring: u32,
    /// Above those of its children and of all around; below 2¹⁵.
    pub(crate) level: u16,
    /// Of its coarse side, never less than that of an update that needs it.
    pub(crate) error: Length16,
    /// Of a ball about its node, around both its sides and the balls of its children.
    pub(crate) radius: Length16,
    /// Its fan is open: it has a last node with no face behind.
    pub(crate) is_open: bool,
    /// The first child's faces are one run too: the two could change places.
    pub(crate) children_swappable: bool,
    /// It and the update of its first child are one, the contraction of a face.
    pub(crate) fused_with_child: bool,
}

/// Why there is no multiresolution model of a mesh.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum BuildError {
    /// It cannot be simplified.
    #[error(transparent)]
    Simplify(#[from] SimplifyError),
    /// A chain of updates that need each other is too long.
    #[error("some update needs a chain of more than {MAX_LEVELS} others")]
    TooDeep,
    /// More vertices than are numbered.
    #[error("the mesh has too many vertices: about 2^29 can be numbered")]
    TooLarge,
    /// Components vanished: nothing would bring them back.
    #[error("components vanished; build without letting them")]
    Vanished,
    /// Some surface was contracted before the recorder was there.
    #[error("the simplification was not recorded from its start")]
    NotFromStart,
}

impl Forest {
    /// Simplifies a mesh as far as its method goes and records how.
    ///
    /// Positions only: attributes are left behind. Components do not vanish, whatever the options say.
    /// # Errors
    /// A mesh that simplification does not take.
    pub fn new(mesh: &Mesh, options: &Options) -> Result<Self, BuildError> {
        Self::by(mesh, options, Recorder::new)
    }

    /// The same, which keeps the positions of the mesh to the bit: levels have those of its vertices, and
    /// rounded ones where some have become one. No error is 0, so that to ask for none is to ask for the
    /// mesh. 24 bytes a vertex, and two bits a node.
    /// # Errors
    /// As [`Forest::new`].
    pub fn lossless(mesh: &Mesh, options: &Options) -> Result<Self, BuildError> {
        Self::by(mesh, options, Recorder::lossless)
    }

    fn by(
        mesh: &Mesh,
        options: &Options,
        recorder: impl FnOnce(&Simplifier<'_>) -> Recorder,
    ) -> Result<Self, BuildError> {
        let options = Options { vanish_below: None, ..options.clone() };
        let mut simplifier = Simplifier::new(mesh, &options)?;
        let mut recorder = recorder(&simplifier);
        simplifier.run(Target::Faces(0), &mut recorder)?;
        recorder.into_forest()
    }

    /// How many faces the finest level has.
    pub fn full_faces(&self) -> usize {
        self.faces.len()
    }

    /// How many contractions of an edge there were; that of a face counts as two.
    pub fn update_count(&self) -> usize {
        self.updates.len()
    }

    /// What the errors of its updates are.
    pub fn error_kind(&self) -> ErrorKind {
        self.error_kind
    }

    /// The node that an update makes.
    #[inline]
    pub(crate) fn node(&self, update: usize) -> usize {
        self.vertices + update
    }

    /// The update that made a node; none for a leaf.
    #[inline]
    pub(crate) fn update_of(&self, node: u32) -> Option<usize> {
        (node as usize).checked_sub(self.vertices)
    }

    /// The nodes around an update's node just after its contraction.
    pub(crate) fn ring(&self, update: usize) -> &[u32] {
        let end = self.updates.get(update + 1).map_or(self.rings.len(), |next| next.ring as usize);
        &self.rings[self.updates[update].ring as usize..end]
    }

    /// What an update's need is judged by.
    pub(crate) fn ball(&self, update: usize) -> Ball {
        let (radius, error) = (self.updates[update].radius, self.error(update));
        PackedBall { center: self.positions[self.node(update)], radius, error }.unpack()
    }

    /// How far off an update's coarse side is. What changes no surface takes vertices away still: where
    /// the input is kept no error is 0, and to ask for none is to ask for every vertex.
    #[inline]
    pub(crate) fn error(&self, update: usize) -> Length16 {
        let error = self.updates[update].error;
        if self.exact.is_lossless() { error.max(MIN_ERROR) } else { error }
    }

    /// Where a node is in stored units: to the bit if that is kept.
    pub(crate) fn exact_stored(&self, node: u32) -> DVec3 {
        let rounded = || Vec3::from(self.positions[node as usize]).as_dvec3();
        self.exact.get(node).map_or_else(rounded, |exact| self.frame.point(exact.into()))
    }

    /// The update that contracts each node; [`NONE`] for roots.
    pub(crate) fn parents(&self) -> Vec<u32> {
        let mut parents = vec![NONE; self.positions.len()];
        for (u, update) in self.updates.iter().enumerate() {
            update.children.iter().for_each(|&child| parents[child as usize] = u as u32);
        }
        parents
    }
}
