//! The surface of a cut: its vertices and triangles, which guarded splits and merges change.

mod merge;
mod split;

pub(super) use self::split::resolve_wings;
use super::triangles::{Spoke, Triangles};
use crate::forest::{MAX_LEVELS, NONE};
use crate::implicit::Implicit;
use crate::level::Level;

/// Corner list of a vertex that does not exist yet.
const ABSENT: u32 = NONE - 1;
/// Corner list of a vertex that has been split.
const SPLIT: u32 = NONE - 2;

/// The active vertices and the triangles between them.
#[derive(Clone, Debug)]
pub(super) struct Front<'m> {
    pub(super) mt: &'m Implicit,
    /// State of each node.
    vertices: Vec<Vertex>,
    pub(super) triangles: Triangles,
    /// Number of active vertices.
    active: usize,
    /// Scratch memory for the star of a vertex.
    star: Vec<Spoke>,
    /// Scratch memory for the faces that a split creates.
    created: Vec<[u32; 3]>,
    /// Scratch memory for the neighbours of a vertex.
    ring: Vec<u32>,
    /// Updates applied and undone since they were last taken, if they are recorded.
    pub(super) steps: Option<Vec<SplitOrMerge>>,
}

/// An update that was applied, or undone.
#[derive(Clone, Copy, Debug)]
pub(super) enum SplitOrMerge {
    Split(u32),
    Merge(u32),
}

/// State of a node: its list of corners, and the levels that splits and merges compare.
#[derive(Clone, Copy, Debug)]
struct Vertex {
    /// Head of its list of corners, or [`ABSENT`] or [`SPLIT`] if it is not active.
    corner: u32,
    /// Level of the update that splits it, 0 for a leaf. The highest bit is set while that update
    /// is on the schedule, which may outlive the vertex.
    level: u16,
    /// Level of the update that created it, the maximum for a root.
    above: u16,
}

const SCHEDULED: u16 = MAX_LEVELS;

/// State of a vertex relative to the cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum VertexState {
    /// Not reached: an ancestor has not been split.
    Absent,
    /// Part of the mesh.
    Active,
    /// Replaced by its children.
    Split,
}

impl<'m> Front<'m> {
    /// Starts at the base mesh.
    pub(super) fn new(mt: &'m Implicit) -> Self {
        let absent = Vertex { corner: ABSENT, level: 0, above: 0 };
        let mut this = Self {
            mt,
            vertices: vec![absent; mt.node_count()],
            triangles: Triangles::new(mt.wedges().is_some()),
            created: Vec::new(),
            active: 0,
            star: Vec::new(),
            ring: Vec::new(),
            steps: None,
        };
        for (root, _) in mt.roots() {
            this.activate(root, u16::MAX);
        }
        let corners = mt.wedges().map_or(&[][..], |wedges| &wedges.base);
        for (i, &face) in mt.base().iter().enumerate() {
            this.add(face, corners.get(i).copied());
        }
        this
    }

    /// Returns the number of vertices.
    pub(super) fn vertex_count(&self) -> usize {
        self.active
    }

    #[inline]
    pub(super) fn state(&self, node: u32) -> VertexState {
        match self.vertices[node as usize].corner {
            ABSENT => VertexState::Absent,
            SPLIT => VertexState::Split,
            _ => VertexState::Active,
        }
    }

    #[inline]
    pub(super) fn is_scheduled(&self, node: u32) -> bool {
        self.vertices[node as usize].level & SCHEDULED != 0
    }

    #[inline]
    pub(super) fn set_scheduled(&mut self, node: u32, is_scheduled: bool) {
        let level = &mut self.vertices[node as usize].level;
        *level = *level & !SCHEDULED | if is_scheduled { SCHEDULED } else { 0 };
    }

    #[inline]
    fn record(&mut self, step: SplitOrMerge) {
        if let Some(steps) = &mut self.steps {
            steps.push(step);
        }
    }

    /// Returns the star gathered by the last split or by the last test for one.
    pub(super) fn last_star(&self) -> &[Spoke] {
        &self.star
    }

    /// Returns true if a vertex is part of the mesh.
    pub(super) fn is_active(&self, node: u32) -> bool {
        self.state(node) == VertexState::Active
    }

    /// Returns true if an active vertex is a root or was created by an update of a higher level.
    #[inline]
    pub(super) fn is_made_above(&self, node: u32, level: u16) -> bool {
        self.vertices[node as usize].above > level
    }

    /// Appends the star of an active vertex to `star`.
    pub(super) fn gather(&self, node: u32, star: &mut Vec<Spoke>) {
        self.triangles.gather(self.vertices[node as usize].corner, star);
    }

    /// Returns the neighbours of a vertex, each once or twice.
    pub(super) fn around(&mut self, node: u32) -> &[u32] {
        let Self { star, ring, triangles, vertices, .. } = self;
        star.clear();
        triangles.gather(vertices[node as usize].corner, star);
        ring.clear();
        ring.extend(star.iter().flat_map(|spoke| [spoke.a, spoke.b]));
        ring
    }

    /// Returns the triangles in the given slots as a level.
    pub(super) fn level_of(&self, slots: &[u32]) -> Level {
        let Self { mt, triangles, .. } = self;
        let faces = slots.iter().map(|&slot| triangles.nodes(slot)).collect();
        let corners = slots.iter().filter_map(|&slot| triangles.wedges(slot)).collect();
        mt.level_from_faces(faces, corners)
    }

    fn activate(&mut self, node: u32, above: u16) {
        let level = self.mt.update_of(node).map_or(0, |update| self.mt.level(update));
        let vertex = &mut self.vertices[node as usize];
        *vertex = Vertex { corner: NONE, level: vertex.level & SCHEDULED | level, above };
        self.active += 1;
    }

    fn add(&mut self, face: [u32; 3], corners: Option<[u32; 3]>) {
        let t = self.triangles.add();
        for (k, wedge) in (0..).zip(corners.into_iter().flatten()) {
            self.triangles.set_wedge(3 * t + k, wedge);
        }
        for (k, &node) in face.iter().enumerate() {
            let Vertex { corner, .. } = &mut self.vertices[node as usize];
            self.triangles.attach(3 * t + k as u32, node, corner);
        }
    }
}
