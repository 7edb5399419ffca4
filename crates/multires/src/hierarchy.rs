//! Models of either kind, and cuts that follow queries on them: what a viewer needs to know.

use crate::cut::{Cut, CutChange, Located, Patch, UpdateLimits};
use crate::implicit::Implicit;
use crate::level::Level;
use crate::query::{Focus, Query, QueryError};
use crate::rtin::{Rtin, RtinCut};

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

    /// Returns the number of faces of the current level.
    pub fn face_count(&self) -> usize {
        match self {
            Self::Contractions(cut) => cut.face_count(),
            Self::RightTriangles(cut) => cut.face_count(),
        }
    }

    /// Returns the number of vertices of the current level.
    pub fn vertex_count(&self) -> usize {
        match self {
            Self::Contractions(cut) => cut.vertex_count(),
            Self::RightTriangles(cut) => cut.vertex_count(),
        }
    }

    /// Returns the number of triangle slots, which is the length of a list indexed by
    /// [`Patch::slot`].
    pub fn slots(&self) -> usize {
        match self {
            Self::Contractions(cut) => cut.slots(),
            Self::RightTriangles(cut) => cut.slots(),
        }
    }

    /// Returns the three nodes of the triangle in a slot, or `None` if the slot is empty.
    pub fn triangle(&self, slot: u32) -> Option<[u32; 3]> {
        match self {
            Self::Contractions(cut) => cut.triangle(slot),
            Self::RightTriangles(cut) => cut.triangle(slot),
        }
    }

    /// Iterates over the triangles of the current level, each by its slot and its three nodes.
    pub fn triangles(&self) -> impl Iterator<Item = (u32, [u32; 3])> + '_ {
        (0..self.slots() as u32).filter_map(|slot| Some((slot, self.triangle(slot)?)))
    }

    /// Iterates over the triangle slots that the last update changed, in no particular order.
    pub fn patches(&self) -> impl Iterator<Item = Patch> + '_ {
        let (contractions, triangles) = match self {
            Self::Contractions(cut) => (Some(cut.patches()), None),
            Self::RightTriangles(cut) => (None, Some(cut.patches())),
        };
        contractions.into_iter().flatten().chain(triangles.into_iter().flatten())
    }

    /// Iterates over the triangle slots that the last update wrote, see [`Cut::touched_slots`].
    pub fn touched_slots(&self) -> impl Iterator<Item = u32> + '_ {
        let (contractions, triangles) = match self {
            Self::Contractions(cut) => (Some(cut.touched_slots()), None),
            Self::RightTriangles(cut) => (None, Some(cut.patches().map(|patch| patch.slot))),
        };
        contractions.into_iter().flatten().chain(triangles.into_iter().flatten())
    }

    /// Returns the wedges at the corners of the triangle in a slot; `None` if the slot is empty or
    /// the model has no wedges, as height fields have none. See [`Cut::wedges`].
    pub fn wedges(&self, slot: u32) -> Option<[u32; 3]> {
        match self {
            Self::Contractions(cut) => cut.wedges(slot),
            Self::RightTriangles(_) => None,
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
