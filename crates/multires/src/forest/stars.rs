//! Faces around every vertex while the contractions of a forest are replayed.

use crate::forest::{Forest, NONE};

/// Faces of the current mesh, with the corners at each node.
///
/// The corners at a node form a linked list, so that a contraction joins two lists.
#[derive(Debug)]
pub(crate) struct Stars {
    /// Faces by their nodes; the first node of a removed face is [`NONE`].
    faces: Vec<[u32; 3]>,
    /// First and last corner of each node's list. Corner `k` of face `f` is `3 f + k`.
    ends: Vec<[u32; 2]>,
    /// By corner: the next one in its list.
    next: Vec<u32>,
    /// Fine side of the last contraction.
    fine: Vec<[u32; 3]>,
    /// Numbers of its faces.
    changed: Vec<u32>,
}

impl Stars {
    pub(crate) fn new(forest: &Forest) -> Self {
        let mut this = Self {
            faces: forest.faces.clone(),
            ends: vec![[NONE; 2]; forest.positions.len()],
            next: vec![NONE; 3 * forest.faces.len()],
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
                next = self.next[corner as usize];
                let face = &mut self.faces[corner as usize / 3];
                if face[0] == NONE {
                    continue;
                }
                self.fine.push(*face);
                self.changed.push(corner / 3);
                if face.contains(&other) {
                    *face = [NONE; 3];
                } else {
                    face[corner as usize % 3] = node;
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
        Some(self.faces[face as usize]).filter(|nodes| nodes[0] != NONE)
    }

    fn append(&mut self, node: u32, corner: u32) {
        let [first, last] = &mut self.ends[node as usize];
        if *first == NONE {
            *first = corner;
        } else {
            self.next[*last as usize] = corner;
        }
        *last = corner;
        self.next[corner as usize] = NONE;
    }
}
