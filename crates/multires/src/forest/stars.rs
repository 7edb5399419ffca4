//! Faces around every vertex while the contractions of a forest are replayed.

use crate::forest::{Forest, NONE};

impl Forest {
    /// Calls `visit` with the nodes of each triangle that occurs in some cut: the faces of the input
    /// and those that contractions make.
    ///
    /// Cost: linear.
    pub(crate) fn each_triangle(&self, mut visit: impl FnMut([u32; 3])) {
        let mut stars = Stars::new(self);
        self.faces.iter().for_each(|&face| visit(face));
        for (u, update) in self.updates.iter().enumerate() {
            stars.contract(update.children, self.node(u) as u32);
            stars.changed().iter().filter_map(|&face| stars.face(face)).for_each(&mut visit);
        }
    }
}

/// Faces of the current mesh, with the corners at each node.
///
/// The corners at a node form a linked list, so that a contraction joins two lists.
#[derive(Debug)]
pub(crate) struct Stars {
    faces: Vec<LinkedFace>,
    /// First and last corner of each node's list. Corner `k` of face `f` is `3 f + k`.
    ends: Vec<[u32; 2]>,
    /// Fine side of the last contraction.
    fine: Vec<[u32; 3]>,
    /// Numbers of its faces.
    changed: Vec<u32>,
}

/// Face with the links of its corners, which are needed together.
#[derive(Clone, Copy, Debug)]
struct LinkedFace {
    /// Its nodes; the first one of a removed face is [`NONE`].
    nodes: [u32; 3],
    /// By corner: the next one in its list.
    next: [u32; 3],
}

impl Stars {
    pub(crate) fn new(forest: &Forest) -> Self {
        let mut this = Self {
            faces: forest
                .faces
                .iter()
                .map(|&nodes| LinkedFace { nodes, next: [NONE; 3] })
                .collect(),
            ends: vec![[NONE; 2]; forest.positions.len()],
            fine: Vec::new(),
            changed: Vec::new(),
        };
        for (f, face) in forest.faces.iter().enumerate() {
            (0..3).for_each(|k| this.append(face[k], (3 * f + k) as u32));
        }
        this
    }

    /// Replaces two children by their parent node. Returns the faces around the children as they
    /// were before.
    pub(crate) fn contract(&mut self, children: [u32; 2], node: u32) -> &[[u32; 3]] {
        self.fine.clear();
        self.changed.clear();
        for (child, other) in [(children[0], children[1]), (children[1], children[0])] {
            let mut next = self.ends[child as usize][0];
            while next != NONE {
                let corner = next;
                let face = &mut self.faces[corner as usize / 3];
                next = face.next[corner as usize % 3];
                let nodes = &mut face.nodes;
                if nodes[0] == NONE {
                    continue;
                }
                self.fine.push(*nodes);
                self.changed.push(corner / 3);
                if nodes.contains(&other) {
                    *nodes = [NONE; 3];
                } else {
                    nodes[corner as usize % 3] = node;
                    self.append(node, corner);
                }
            }
        }
        &self.fine
    }

    /// Returns the numbers of the faces that the last contraction removed or changed.
    pub(crate) fn changed(&self) -> &[u32] {
        &self.changed
    }

    /// Returns a face by its nodes, or `None` if it was removed.
    pub(crate) fn face(&self, face: u32) -> Option<[u32; 3]> {
        Some(self.faces[face as usize].nodes).filter(|nodes| nodes[0] != NONE)
    }

    fn append(&mut self, node: u32, corner: u32) {
        let [first, last] = &mut self.ends[node as usize];
        if *first == NONE {
            *first = corner;
        } else {
            self.faces[*last as usize / 3].next[*last as usize % 3] = corner;
        }
        *last = corner;
        self.faces[corner as usize / 3].next[corner as usize % 3] = NONE;
    }
}
