//! The depth-first order in which the packed model numbers nodes and updates.

use crate::forest::{Forest, NONE};

/// Roots first, then the children of each update side by side; updates as a walk meets them that
/// goes down first children first. So the updates below a node are one run, and the nodes too.
#[derive(Debug)]
pub(crate) struct Order {
    /// The forest's node of each.
    pub(crate) nodes: Vec<u32>,
    /// The place of each of the forest's nodes; [`NONE`] for a vertex without faces.
    pub(crate) index_of_node: Vec<u32>,
    /// The forest's leaves that are below roots, as a walk meets them.
    pub(crate) leaves: Vec<u32>,
    /// The forest's update of each.
    pub(crate) updates: Vec<u32>,
    /// The place of each of the forest's updates.
    pub(crate) index_of_update: Vec<u32>,
    /// How many updates are below each root and those before it; one more than roots.
    pub(crate) trees: Vec<u32>,
    /// Behind the last update below each update.
    pub(crate) ends: Vec<u32>,
}

impl Order {
    pub(crate) fn new(forest: &Forest) -> Self {
        let children =
            |node: u32| forest.update_of(node).map(|u| (u as u32, forest.updates[u].children));
        Self::of(roots(forest), forest.positions.len(), forest.updates.len(), children)
    }

    /// That of the trees below some roots, by the update that splits a node and its children.
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

    /// The model's update that makes a node of the forest; `None` for roots.
    pub(super) fn maker(&self, node: u32) -> Option<u32> {
        let roots = self.trees.len() as u32 - 1;
        self.index_of_node[node as usize].checked_sub(roots).map(|child| child / 2)
    }

    /// Numbers the updates below a node, and the leaves.
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

    /// Where the updates below the second child of an update start, and whether there are any, by
    /// the updates of its children.
    pub(super) fn second(&self, at: usize, [first, second]: [Option<u32>; 2]) -> u32 {
        let start = first.map_or(at as u32 + 1, |first| self.ends[first as usize]);
        start | if second.is_some() { super::FLAG } else { 0 }
    }
}

/// The nodes that nothing contracts and that have faces, in the forest's order.
fn roots(forest: &Forest) -> Vec<u32> {
    let mut is_root = vec![false; forest.positions.len()];
    forest.faces.iter().flatten().for_each(|&leaf| is_root[leaf as usize] = true);
    is_root[forest.vertices..].fill(true);
    for &child in forest.updates.iter().flat_map(|u| &u.children) {
        is_root[child as usize] = false;
    }
    (0..is_root.len() as u32).filter(|&node| is_root[node as usize]).collect()
}
