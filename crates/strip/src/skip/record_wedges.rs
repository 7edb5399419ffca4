//! Recording of the wedges that half-edge contractions merge.

use meshlod_mesh::{FaceId, Mesh, VertexId, WedgeId};
use meshlod_simplify::{Neighbourhood, Observe, Placed, Surface};

use super::tree::{MergeTree, STAYS};
use super::wedges::{MeshWedges, StripWedge};

/// Observer of half-edge contractions that records where each wedge of a removed vertex goes.
pub(super) struct WedgeRecorder {
    pub(super) tree: MergeTree,
    /// Vertex of the tree that each wedge of the surface is now.
    shown: Vec<VertexId>,
    /// Vertices of the tree at each vertex of the mesh, also those whose faces have all vanished.
    at_vertex: Vec<Vec<VertexId>>,
    /// Wedges of the vertex that is about to be removed, each once, with a face that survives and
    /// the corner of that.
    leaving: Vec<(WedgeId, FaceId, usize)>,
    /// Wedges of the vertex that stays, at the ends of the contracted edge.
    kept: Vec<WedgeId>,
}

impl WedgeRecorder {
    /// Starts with a surface on which nothing has been contracted.
    pub(super) fn new(mesh: &Mesh, wedges: MeshWedges, surface: &Surface) -> Self {
        let mut shown = Vec::new();
        for (face, corners) in wedges.corners.iter().enumerate() {
            for (wedge, &vertex) in surface.wedges(FaceId::new(face)).iter().flatten().zip(corners)
            {
                let count = shown.len().max(wedge.index() + 1);
                shown.resize(count, VertexId(0));
                shown[wedge.index()] = vertex;
            }
        }
        let mut at_vertex = vec![Vec::new(); mesh.positions.len()];
        for (i, wedge) in wedges.wedges.iter().enumerate() {
            at_vertex[wedge.vertex.index()].push(VertexId::new(i));
        }
        let tree = MergeTree::of_wedges(mesh, wedges);
        Self { tree, shown, at_vertex, leaving: Vec::new(), kept: Vec::new() }
    }

    /// Moves a wedge that has no counterpart to the vertex that stays, where it takes its texture
    /// coordinates from the wedge that its chart became.
    fn carry(&mut self, wedge: WedgeId, surface: &Surface) {
        let is_same_chart = |kept: &&WedgeId| surface.is_same_chart(wedge, **kept);
        let other = self.kept.iter().find(is_same_chart).or(self.kept.first());
        let (Some(other), Some(wedges)) = (other, &mut self.tree.wedges) else { return };
        let (own, other) = (self.shown[wedge.index()], self.shown[other.index()]);
        let StripWedge { vertex, texture, .. } = wedges[other.index()];
        let new = VertexId::new(wedges.len());
        wedges.push(StripWedge { vertex, texture, ..wedges[own.index()] });
        self.tree.parents.push(new);
        self.tree.turns.push(STAYS);
        self.at_vertex[vertex.index()].push(new);
        self.merge(own, new);
        self.shown[wedge.index()] = new;
    }

    /// Merges what else is left of a removed vertex. Only faces that have vanished use it, but
    /// their corners must stay together.
    fn merge_rest(&mut self, gone: VertexId, kept: VertexId) {
        let Some(&parent) = self.at_vertex[kept.index()].first() else { return };
        for vertex in std::mem::take(&mut self.at_vertex[gone.index()]) {
            if self.tree.turns[vertex.index()] == STAYS {
                self.merge(vertex, parent);
            }
        }
    }

    fn merge(&mut self, vertex: VertexId, parent: VertexId) {
        self.tree.parents[vertex.index()] = parent;
        self.tree.turns[vertex.index()] = self.tree.contractions() as u32;
    }
}

impl Observe for WedgeRecorder {
    fn before(&mut self, surface: &Surface, neighbourhood: &Neighbourhood, placed: &Placed) {
        let Self { leaving, kept, .. } = self;
        leaving.clear();
        for spoke in neighbourhood.spokes().iter().filter(|spoke| spoke.owner() != placed.kept) {
            let Some(wedges) = surface.wedges(spoke.face) else { continue };
            let wedge = wedges[spoke.corner()];
            if !leaving.iter().any(|(known, ..)| *known == wedge) {
                leaving.push((wedge, spoke.face, spoke.corner()));
            }
        }
        let vertex = neighbourhood.contracted()[placed.kept];
        let at_vertex = neighbourhood.removed_faces().iter().filter_map(|removed| {
            let corner = surface.face(removed.face).iter().position(|&v| v == vertex)?;
            Some(surface.wedges(removed.face)?[corner])
        });
        kept.clear();
        kept.extend(at_vertex);
    }

    fn after(&mut self, surface: &Surface, neighbourhood: &Neighbourhood, placed: &Placed) {
        let leaving = std::mem::take(&mut self.leaving);
        for &(was, face, corner) in &leaving {
            match surface.wedges(face).map(|wedges| wedges[corner]) {
                Some(now) if now != was => {
                    self.merge(self.shown[was.index()], self.shown[now.index()]);
                }
                _ => self.carry(was, surface),
            }
        }
        self.leaving = leaving;
        let kept = neighbourhood.contracted()[placed.kept];
        for &gone in neighbourhood.contracted().iter().filter(|&&v| v != kept) {
            self.merge_rest(gone, kept);
        }
        let left = self.tree.faces_left(self.tree.contractions());
        let left = left.saturating_sub(neighbourhood.removed_faces().len());
        self.tree.faces_left.push(left as u32);
    }
}

#[cfg(test)]
mod tests;
