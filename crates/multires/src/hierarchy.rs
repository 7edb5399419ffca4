//! Models of either kind, and cuts that follow queries on them: what a viewer needs to know.

use crate::cut::{Cut, CutChange, Located, UpdateLimits};
use crate::implicit::Implicit;
use crate::level::Level;
use crate::query::{Focus, Query, QueryError};
use crate::rtin::{Rtin, RtinCut};
use crate::slot_mesh::SlotMesh;

/// All levels of a surface in memory, whatever their updates are.
#[derive(Clone, Debug)]
pub enum Hierarchy {
    /// Levels of a mesh, recorded while it was simplified.
    Contractions(Implicit),
    /// Levels of a height field.
    RightTriangles(Rtin),
}

/// A cut of a [`Hierarchy`], which follows a sequence of queries.
///
/// Every method means the same for both kinds, see [`Cut`] and [`RtinCut`].
#[derive(Clone, Debug)]
pub enum HierarchyCut<'m> {
    /// A cut of contractions.
    Contractions(Cut<'m>),
    /// A cut of right triangles.
    RightTriangles(RtinCut<'m>),
}

impl Hierarchy {
    /// Returns a cut that starts as the coarsest level.
    pub fn cut(&self) -> HierarchyCut<'_> {
        match self {
            Self::Contractions(model) => HierarchyCut::Contractions(Cut::new(model)),
            Self::RightTriangles(model) => HierarchyCut::RightTriangles(RtinCut::new(model)),
        }
    }

    /// Returns the number of nodes, the vertices of all levels.
    pub fn node_count(&self) -> usize {
        match self {
            Self::Contractions(model) => model.node_count(),
            Self::RightTriangles(model) => model.size().map(|n| n as usize).iter().product(),
        }
    }

    /// Returns the position of a node in model units.
    ///
    /// # Panics
    /// `node` is not below [`node_count`](Self::node_count).
    pub fn position(&self, node: u32) -> [f64; 3] {
        match self {
            Self::Contractions(model) => model.position(node),
            Self::RightTriangles(model) => model.position(node),
        }
    }

    /// Returns the two nodes that replace a node in finer levels; `None` for one that is in the
    /// finest level, as all vertices of a height field are.
    pub fn children_of(&self, node: u32) -> Option<[u32; 2]> {
        match self {
            Self::Contractions(model) => model.children_of(node),
            Self::RightTriangles(_) => None,
        }
    }

    /// Returns the largest number of faces that a cut can have between its updates.
    pub fn most_faces(&self) -> usize {
        match self {
            Self::Contractions(model) => model.full_faces().max(model.base_faces()),
            Self::RightTriangles(model) => model.full_faces(),
        }
    }
}

impl From<Implicit> for Hierarchy {
    fn from(model: Implicit) -> Self {
        Self::Contractions(model)
    }
}

impl From<Rtin> for Hierarchy {
    fn from(model: Rtin) -> Self {
        Self::RightTriangles(model)
    }
}

impl HierarchyCut<'_> {
    /// Refines and coarsens the cut until it satisfies a query or a limit is reached: see
    /// [`Cut::update`] and [`RtinCut::update`].
    /// # Errors
    /// The query is invalid; the cut is unchanged.
    pub fn update(
        &mut self,
        query: &Query<'_>,
        limits: &UpdateLimits,
    ) -> Result<CutChange, QueryError> {
        match self {
            Self::Contractions(cut) => cut.update(query, limits),
            Self::RightTriangles(cut) => cut.update(query, limits),
        }
    }

    /// Returns the current level as triangles in slots.
    pub fn slot_mesh(&self) -> &dyn SlotMesh {
        match self {
            Self::Contractions(cut) => cut,
            Self::RightTriangles(cut) => cut,
        }
    }

    /// Returns a copy of the current level.
    pub fn level(&self) -> Level {
        match self {
            Self::Contractions(cut) => cut.level(),
            Self::RightTriangles(cut) => cut.level(),
        }
    }

    /// Returns the triangles of the cut that intersect the region `focus`: see
    /// [`Cut::level_within`].
    /// # Errors
    /// The focus is invalid.
    pub fn level_within(&self, focus: &Focus) -> Result<Level, QueryError> {
        match self {
            Self::Contractions(cut) => cut.level_within(focus),
            Self::RightTriangles(cut) => cut.level_within(focus),
        }
    }

    /// Returns the triangle of the cut closest to a point in model units, or `None` if the cut has
    /// no triangles or a coordinate is not finite: see [`Cut::locate`].
    pub fn locate(&self, point: [f64; 3]) -> Option<Located> {
        match self {
            Self::Contractions(cut) => cut.locate(point),
            Self::RightTriangles(cut) => cut.locate(point),
        }
    }
}
