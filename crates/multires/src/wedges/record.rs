//! Records wedges while the simplification runs.

use std::collections::BTreeMap;
use std::ops::Range;

use meshlod_mesh::{FaceId, Layer, VertexId, WedgeId};
use meshlod_simplify::{Neighbourhood, Placed, Simplifier, Spoke, Surface};

use super::{WedgeLabels, WedgeNumbers};
use crate::forest::NONE;
use crate::implicit::Order;

/// Wedges of all nodes of a forest, numbered by node: first those of the leaves. Every node has one,
/// also where no face uses it.
#[derive(Clone, Debug, Default)]
pub(crate) struct ForestWedges {
    /// First wedge of each node, and the end of the last.
    pub(crate) first: Vec<u32>,
    /// Wedge of the node above that each wedge becomes, or [`NONE`] if it is a root's or has lost
    /// all its faces.
    pub(crate) parents: Vec<u32>,
    pub(crate) values: WedgeNumbers,
    pub(crate) labels: WedgeLabels,
    /// Wedges of leaves at the corners of the forest's faces.
    pub(crate) corners: Vec<[u32; 3]>,
    /// Changes of faces by the updates next to seams.
    pub(crate) splits: BTreeMap<u32, WedgeSplit>,
}

/// Faces of an update next to a seam, with the wedges that they have after the split.
#[derive(Clone, Debug, Default)]
pub(crate) struct WedgeSplit {
    /// Faces around the node by their two other nodes in order, with the wedge of the child and those
    /// of the two nodes.
    pub(crate) around: Vec<([u32; 2], [u32; 3])>,
    /// Faces that the split creates, with the wedges at their corners.
    pub(crate) created: Vec<([u32; 3], [u32; 3])>,
}

impl ForestWedges {
    /// Returns the wedges of a node.
    pub(crate) fn of(&self, node: u32) -> Range<u32> {
        self.first[node as usize]..self.first[node as usize + 1]
    }

    /// Returns the number of wedges of a node.
    pub(crate) fn count(&self, node: u32) -> u32 {
        self.of(node).len() as u32
    }

    /// Returns the number of wedges of all nodes.
    pub(crate) fn len(&self) -> usize {
        self.parents.len()
    }

    /// Numbers the leaves of the forest of wedges so that those below each wedge are one range, and
    /// returns these ranges.
    pub(crate) fn leaves_below(&self, vertices: usize, order: &Order) -> Vec<Range<u32>> {
        let packed = || order.nodes.iter().flat_map(|&node| self.of(node)).map(|w| w as usize);
        let leaves = self.first[vertices] as usize;
        let mut sizes: Vec<u32> = (0..self.len()).map(|wedge| u32::from(wedge < leaves)).collect();
        // Parents have higher numbers here, and lower ones in the order of a model.
        for wedge in (0..self.len()).filter(|&wedge| self.parents[wedge] != NONE) {
            sizes[self.parents[wedge] as usize] += sizes[wedge];
        }
        let (mut below, mut ends) = (vec![0..0; self.len()], vec![0; self.len()]);
        let mut all = 0;
        for wedge in packed() {
            let end = match self.parents[wedge] {
                NONE => &mut all,
                parent => &mut ends[parent as usize],
            };
            let start = *end;
            *end += sizes[wedge];
            below[wedge] = start..start + sizes[wedge];
            ends[wedge] = start;
        }
        below
    }

    /// Adds a wedge to the last node, with values of zero unless the surface has it.
    fn push(&mut self, layers: &[Layer], wedge: Option<WedgeId>, label: u32) {
        self.parents.push(NONE);
        self.values.push(layers, wedge);
        if self.labels.pairs.len() > 1 {
            self.labels.of_wedges.push(label);
        }
    }

    /// Ends the wedges of a node, which gets one if it has none.
    fn end_node(&mut self, layers: &[Layer], label: u32) {
        if self.first.last() == Some(&(self.len() as u32)) {
            self.push(layers, None, label);
        }
        self.first.push(self.parents.len() as u32);
    }
}

/// Records the wedges of a simplification.
#[derive(Debug)]
pub(crate) struct WedgeRecorder {
    wedges: ForestWedges,
    /// Forest's wedge of each wedge of the surface.
    live: Vec<u32>,
    /// Wedge of the surface that each surviving face had before the contraction.
    before: Vec<WedgeId>,
    /// Record of the contraction, until it turns out whether it is needed.
    split: WedgeSplit,
}

impl WedgeRecorder {
    /// Creates a recorder if the mesh has attributes, materials or objects, for the listed faces.
    pub(crate) fn new(simplifier: &Simplifier<'_>, faces: &[FaceId]) -> Option<Self> {
        let (mesh, surface) = (simplifier.input(), simplifier.surface());
        if mesh.attributes.is_none() && mesh.materials.is_none() && mesh.objects.is_none() {
            return None;
        }
        let (labels, of_faces) = WedgeLabels::of_faces(mesh);
        let values = WedgeNumbers::exact(surface.layers());
        let mut at_corners: Vec<(VertexId, WedgeId, u32)> = Vec::with_capacity(3 * faces.len());
        for &face in faces {
            let corners = surface.face(face).into_iter().zip(wedges_of(surface, face));
            at_corners.extend(corners.map(|(v, wedge)| (v, wedge, of_faces[face.index()])));
        }
        at_corners.sort_unstable();
        at_corners.dedup_by_key(|corner| corner.1);
        let count = at_corners.iter().map(|corner| corner.1.index() + 1).max().unwrap_or(0);
        let mut this = Self {
            wedges: ForestWedges { first: vec![0], values, labels, ..ForestWedges::default() },
            live: vec![NONE; count],
            before: Vec::new(),
            split: WedgeSplit::default(),
        };
        let mut at_corners = at_corners.into_iter().peekable();
        for v in (0..surface.vertex_count()).map(VertexId::new) {
            while let Some((_, wedge, label)) = at_corners.next_if(|corner| corner.0 == v) {
                this.live[wedge.index()] = this.wedges.len() as u32;
                this.wedges.push(surface.layers(), Some(wedge), label);
            }
            this.wedges.end_node(surface.layers(), 0);
        }
        let corner = |&face: &FaceId| wedges_of(surface, face).map(|w| this.live[w.index()]);
        this.wedges.corners = faces.iter().map(corner).collect();
        Some(this)
    }

    /// Looks at the wedges before a contraction. `node` returns the node of a vertex.
    pub(crate) fn before(
        &mut self,
        surface: &Surface,
        hood: &Neighbourhood,
        node: impl Fn(VertexId) -> u32,
    ) {
        let Self { live, before, split, .. } = self;
        let wedge = |spoke: &Spoke| wedges_of(surface, spoke.face)[spoke.corner()];
        before.clear();
        before.extend(hood.spokes().iter().map(wedge));
        split.around.clear();
        split.around.extend(hood.spokes().iter().map(|spoke| {
            let ends = [spoke.a, spoke.b].map(|at| node(hood.ring()[at as usize].id));
            let wedges = wedges_of(surface, spoke.face);
            let wedge = |ahead: usize| live[wedges[(spoke.corner() + ahead) % 3].index()];
            (ends, [0, 1, 2].map(wedge))
        }));
        split.created.clear();
        split.created.extend(hood.removed_faces().iter().map(|removed| {
            let wedges = wedges_of(surface, removed.face).map(|wedge| live[wedge.index()]);
            (surface.face(removed.face).map(&node), wedges)
        }));
    }

    /// Records the wedges of the node that a contraction has made of `children`. `update` is its
    /// number, and `is_fan` tells whether wings describe it.
    pub(crate) fn after(
        &mut self,
        surface: &Surface,
        hood: &Neighbourhood,
        placed: &Placed,
        (update, children, is_fan): (u32, [u32; 2], bool),
    ) {
        let follows = is_fan && self.follows(surface, hood, children);
        let kept = hood.contracted()[placed.kept];
        let mut wedges: Vec<(WedgeId, u32)> = Vec::new();
        for (spoke, before) in hood.spokes().iter().zip(&self.before) {
            debug_assert_eq!(surface.face(spoke.face)[spoke.corner()], kept);
            let after = wedges_of(surface, spoke.face)[spoke.corner()];
            wedges.push((after, self.live[before.index()]));
        }
        wedges.sort_unstable();
        wedges.dedup();
        let first = self.wedges.len() as u32;
        for same in wedges.chunk_by(|a, b| a.0 == b.0) {
            let number = self.wedges.len() as u32;
            let label = self.wedges.labels.of(same[0].1);
            self.wedges.push(surface.layers(), Some(same[0].0), label);
            for &(_, child) in same {
                self.wedges.parents[child as usize] = number;
            }
        }
        // Only now, as a wedge of the surface may stand for one that vanishes and one that remains.
        for (same, number) in wedges.chunk_by(|a, b| a.0 == b.0).zip(first..) {
            self.live[same[0].0.index()] = number;
        }
        let label = self.wedges.labels.of(self.wedges.first[children[0] as usize]);
        self.wedges.end_node(surface.layers(), label);
        let is_single = self.wedges.len() as u32 == first + 1;
        if !(follows && is_single && children.iter().all(|&child| self.wedges.count(child) == 1)) {
            self.wedges.splits.insert(update, std::mem::take(&mut self.split));
        }
    }

    /// Returns true if the faces that a split creates have at their wings the wedges of the faces
    /// next to them.
    fn follows(&self, surface: &Surface, hood: &Neighbourhood, children: [u32; 2]) -> bool {
        hood.removed_faces().iter().zip(&self.split.created).all(|(removed, (nodes, wedges))| {
            let wing = (0..3).find(|&k| !children.contains(&nodes[k]));
            let next = removed.apex().and_then(|at| continued(surface, hood, at as u32));
            wing.zip(next).is_some_and(|(k, next)| wedges[k] == self.live[next.index()])
        })
    }

    /// Ends the recording.
    pub(crate) fn finish(self) -> ForestWedges {
        self.wedges
    }
}

/// Returns the wedge at a ring vertex of the surviving face before which it lies, or else of the one
/// after which it lies.
fn continued(surface: &Surface, hood: &Neighbourhood, at: u32) -> Option<WedgeId> {
    let before = hood.spokes().iter().find(|spoke| spoke.a == at).map(|spoke| (spoke, 1));
    let after = || hood.spokes().iter().find(|spoke| spoke.b == at).map(|spoke| (spoke, 2));
    let (spoke, ahead) = before.or_else(after)?;
    Some(wedges_of(surface, spoke.face)[(spoke.corner() + ahead) % 3])
}

/// Returns the wedges at the corners of a face: one for each vertex if the surface has none.
fn wedges_of(surface: &Surface, face: FaceId) -> [WedgeId; 3] {
    surface.wedges(face).unwrap_or_else(|| surface.face(face).map(|v| WedgeId(v.0)))
}
