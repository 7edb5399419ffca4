//! The faces around every vertex while the forest's contractions are done again.

use crate::forest::{Forest, NONE};

/// The faces there are, by the nodes that show their corners.
///
/// The corners at a node are a chain, so that a contraction joins two.
#[derive(Debug)]
pub(super) struct Stars {
    /// Those that are gone have [`NONE`] for a first node.
    faces: Vec<[u32; 3]>,
    /// By node: the first and the last corner of its chain. Corner `k` of face `f` is `3 f + k`.
    ends: Vec<[u32; 2]>,
    /// By corner: the next in its chain.
    next: Vec<u32>,
    /// What was contracted last, as it was before.
    fine: Vec<[u32; 3]>,
}

impl Stars {
    pub(super) fn new(forest: &Forest) -> Self {
        let mut this = Self {
            faces: forest.faces.clone(),
            ends: vec![[NONE; 2]; forest.positions.len()],
            next: vec![NONE; 3 * forest.faces.len()],
            fine: Vec::new(),
        };
        for (f, face) in forest.faces.iter().enumerate() {
            (0..3).for_each(|k| this.append(face[k], (3 * f + k) as u32));
        }
        this
    }

    /// Makes a node of its two children; the faces around them as they were before.
    pub(super) fn contract(&mut self, children: [u32; 2], node: u32) -> &[[u32; 3]] {
        self.fine.clear();
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
