//! The depth-first order in which the packed model numbers nodes and updates.

use crate::forest::{Forest, NONE};

/// Nodes are numbered roots first, then the children of each update side by side; updates in
/// preorder, first children first. So the updates below a node are one range, and so are the nodes.
#[derive(Debug)]
pub(crate) struct Order {
    /// Forest node of each model node.
    pub(crate) nodes: Vec<u32>,
    /// Model node of each forest node; [`NONE`] for a vertex without faces.
    pub(crate) index_of_node: Vec<u32>,
    /// Forest leaves below the roots, in preorder.
    pub(crate) leaves: Vec<u32>,
    /// Forest update of each model update.
    pub(crate) updates: Vec<u32>,
    /// Model update of each forest update.
    pub(crate) index_of_update: Vec<u32>,
    /// Number of updates below all roots before each one, and the total at the end.
    pub(crate) trees: Vec<u32>,
    /// End of the range of updates below each update.
    pub(crate) ends: Vec<u32>,
}

impl Order {
    pub(crate) fn new(forest: &Forest) -> Self {
        let children =
            |node: u32| forest.update_of(node).map(|u| (u as u32, forest.updates[u].children));
        Self::of(roots(forest), forest.positions.len(), forest.updates.len(), children)
    }

    /// Orders the trees below the given roots. `children` returns the update that splits a node,
    /// with its two children.
    pub(crate) fn of(
        roots: Vec<u32>,
        nodes: usize,
        updates: usize,
        children: impl Fn(u32) -> Option<(u32, [u32; 2])>,
    ) -> Self {
        let mut this = Self {
            nodes: Vec::with_capacity(nodes),
            index_of_node: vec![NONE; nodes],
            leaves: Vec::with_capacity(nodes - updates),
            updates: Vec::with_capacity(updates),
            index_of_update: vec![NONE; updates],
            trees: Vec::with_capacity(roots.len() + 1),
            ends: Vec::new(),
        };
        this.trees.push(0);
        this.nodes.extend(&roots);
        let mut pairs = Vec::with_capacity(updates);
        for &root in &roots {
            this.walk(root, &children, &mut pairs);
            this.trees.push(this.updates.len() as u32);
        }
        this.find_ends(&pairs, &children);
        this.nodes.extend(pairs.into_iter().flatten());
        this.nodes.iter().enumerate().for_each(|(i, &n)| this.index_of_node[n as usize] = i as u32);
        this
    }

    /// Returns the model update that creates a node of the forest, or `None` for a root.
    pub(super) fn creator(&self, node: u32) -> Option<u32> {
        let roots = self.trees.len() as u32 - 1;
        self.index_of_node[node as usize].checked_sub(roots).map(|child| child / 2)
    }

    /// Numbers the updates and leaves below a node.
    fn walk(
        &mut self,
        root: u32,
        children: &impl Fn(u32) -> Option<(u32, [u32; 2])>,
        pairs: &mut Vec<[u32; 2]>,
    ) {
        let mut stack = vec![root];
        while let Some(node) = stack.pop() {
            let Some((update, [first, second])) = children(node) else {
                self.leaves.push(node);
                continue;
            };
            self.index_of_update[update as usize] = self.updates.len() as u32;
            self.updates.push(update);
            pairs.push([first, second]);
            stack.extend([second, first]);
        }
    }

    fn find_ends(
        &mut self,
        pairs: &[[u32; 2]],
        children: &impl Fn(u32) -> Option<(u32, [u32; 2])>,
    ) {
        self.ends = vec![0; pairs.len()];
        for (at, &[first, second]) in pairs.iter().enumerate().rev() {
            let place = |child| children(child).map(|(u, _)| self.index_of_update[u as usize]);
            let last = place(second).or(place(first));
            self.ends[at] = last.map_or(at as u32 + 1, |last| self.ends[last as usize]);
        }
    }

    /// Returns the start of the updates below the second child, flagged if there are any, given the
    /// updates of both children.
    pub(super) fn second(&self, at: usize, [first, second]: [Option<u32>; 2]) -> u32 {
        let start = first.map_or(at as u32 + 1, |first| self.ends[first as usize]);
        start | if second.is_some() { super::FLAG } else { 0 }
    }
}

/// Returns the nodes that have faces and are never contracted, in the forest's order.
fn roots(forest: &Forest) -> Vec<u32> {
    let mut is_root = vec![false; forest.positions.len()];
    forest.faces.iter().flatten().for_each(|&leaf| is_root[leaf as usize] = true);
    is_root[forest.vertices..].fill(true);
    for &child in forest.updates.iter().flat_map(|u| &u.children) {
        is_root[child as usize] = false;
    }
    (0..is_root.len() as u32).filter(|&node| is_root[node as usize]).collect()
}
