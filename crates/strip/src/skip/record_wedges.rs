//! Recording of the wedges that half-edge contractions merge.

use meshlod_mesh::{FaceId, Mesh, VertexId, WedgeId};
use meshlod_simplify::{Neighbourhood, Observe, Placed, Surface};

use super::tree::{MergeTree, STAYS};
use super::wedges::{MeshWedges, StripWedge};

/// Observer of half-edge contractions that records where each wedge of a removed vertex goes.
pub(super) struct WedgeRecorder {
    pub(super) tree: MergeTree,
    /// Vertex of the tree that is now each wedge of the surface.
    shown: Vec<VertexId>,
    /// Vertices of the tree at each vertex of the mesh, also those whose faces have all vanished.
    there: Vec<Vec<VertexId>>,
    leaving: Leaving,
}

/// Wedges of a vertex that is about to be removed.
#[derive(Default)]
struct Leaving {
    /// Each wedge in a face that stays, with such a face and the wedge's corner of it.
    staying: Vec<(WedgeId, FaceId, usize)>,
    /// Each wedge in a face that goes, with the wedge at the other end of the contracted edge.
    pairs: Vec<[WedgeId; 2]>,
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
        let mut there = vec![Vec::new(); mesh.positions.len()];
        for (i, wedge) in wedges.wedges.iter().enumerate() {
            there[wedge.vertex.index()].push(VertexId::new(i));
        }
        let tree = MergeTree::of_wedges(mesh, wedges);
        Self { tree, shown, there, leaving: Leaving::default() }
    }

    /// Merges a wedge into another at the vertex that stays.
    fn merge(&mut self, wedge: WedgeId, into: WedgeId, turn: usize) {
        self.give(self.shown[wedge.index()], self.shown[into.index()], turn);
    }

    /// Moves a wedge that has no counterpart to the vertex that stays, where it takes its texture
    /// coordinates from the wedge that its chart became.
    fn carry(&mut self, wedge: WedgeId, surface: &Surface, turn: usize) {
        let mut kept = self.leaving.pairs.iter().map(|pair| pair[1]);
        let Some(other) = kept.find(|&kept| surface.is_same_chart(wedge, kept)) else { return };
        let new = VertexId::new(self.tree.vertices());
        let (own, other) = (self.shown[wedge.index()], self.shown[other.index()]);
        let Some(wedges) = &mut self.tree.wedges else { return };
        let StripWedge { vertex, texture, .. } = wedges[other.index()];
        wedges.push(StripWedge { vertex, texture, ..wedges[own.index()] });
        self.there[vertex.index()].push(new);
        self.tree.parents.push(new);
        self.tree.turns.push(STAYS);
        self.give(own, new, turn);
        self.shown[wedge.index()] = new;
    }

    /// Lets what is left of a removed vertex follow it: corners of faces that have vanished, which
    /// must not come apart.
    fn merge_rest(&mut self, gone: VertexId, kept: VertexId, turn: usize) {
        let Some(&parent) = self.there[kept.index()].first() else { return };
        for vertex in std::mem::take(&mut self.there[gone.index()]) {
            if self.tree.turns[vertex.index()] == STAYS {
                self.give(vertex, parent, turn);
            }
        }
    }

    fn give(&mut self, vertex: VertexId, parent: VertexId, turn: usize) {
        self.tree.parents[vertex.index()] = parent;
        self.tree.turns[vertex.index()] = turn as u32;
    }
}

impl Observe for WedgeRecorder {
    fn before(&mut self, surface: &Surface, neighbourhood: &Neighbourhood, placed: &Placed) {
        let Leaving { staying, pairs } = &mut self.leaving;
        staying.clear();
        for spoke in neighbourhood.spokes().iter().filter(|spoke| spoke.owner() != placed.kept) {
            let Some(wedges) = surface.wedges(spoke.face) else { continue };
            let wedge = wedges[spoke.corner()];
            if !staying.iter().any(|(known, ..)| *known == wedge) {
                staying.push((wedge, spoke.face, spoke.corner()));
            }
        }
        pairs.clear();
        let kept = neighbourhood.contracted()[placed.kept];
        for removed in neighbourhood.removed_faces() {
            let (vertices, Some(wedges)) =
                (surface.face(removed.face), surface.wedges(removed.face))
            else {
                continue;
            };
            let at = |v: VertexId| vertices.iter().position(|&corner| corner == v);
            let gone = neighbourhood.contracted().iter().find(|&&v| v != kept);
            if let (Some(gone), Some(kept)) = (gone.and_then(|&v| at(v)), at(kept)) {
                pairs.push([wedges[gone], wedges[kept]]);
            }
        }
    }

    fn after(&mut self, surface: &Surface, neighbourhood: &Neighbourhood, placed: &Placed) {
        let turn = self.tree.contractions();
        let staying = std::mem::take(&mut self.leaving.staying);
        for &(was, face, corner) in &staying {
            match surface.wedges(face) {
                Some(now) if now[corner] != was => self.merge(was, now[corner], turn),
                _ => self.carry(was, surface, turn),
            }
        }
        let pairs = std::mem::take(&mut self.leaving.pairs);
        for &[gone, kept] in pairs.iter().filter(|pair| !staying.iter().any(|s| s.0 == pair[0])) {
            self.merge(gone, kept, turn);
        }
        let kept = neighbourhood.contracted()[placed.kept];
        for &gone in neighbourhood.contracted().iter().filter(|&&v| v != kept) {
            self.merge_rest(gone, kept, turn);
        }
        let left = self.tree.faces_left(turn) - neighbourhood.removed_faces().len();
        self.tree.faces_left.push(left as u32);
        self.leaving = Leaving { staying, pairs };
    }
}

#[cfg(test)]
mod tests;
