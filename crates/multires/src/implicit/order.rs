//! The depth-first order in which the packed model numbers nodes and updates.

use crate::forest::{Forest, NONE};

/// Roots first, then the children of each update side by side; updates as a walk meets them that
/// goes down first children first. So the updates below a node are one run, and the nodes too.
#[derive(Debug)]
pub(crate) struct Order {
    /// The forest's node of each.
    pub(crate) nodes: Vec<u32>,
    /// The place of each of the forest's nodes; [`NONE`] for a vertex without faces.
    pub(crate) place: Vec<u32>,
    /// The forest's leaves that are below roots, as a walk meets them.
    pub(crate) leaves: Vec<u32>,
    /// The forest's update of each.
    pub(crate) updates: Vec<u32>,
    /// The place of each of the forest's updates.
    pub(crate) place_of_update: Vec<u32>,
    /// How many updates are below each root and those before it; one more than roots.
    pub(crate) trees: Vec<u32>,
    /// Behind the last update below each update.
    pub(crate) ends: Vec<u32>,
}

impl Order {
    pub(crate) fn new(forest: &Forest) -> Self {
        let roots = roots(forest);
        let mut this = Self {
            nodes: roots.clone(),
            place: vec![NONE; forest.positions.len()],
            leaves: Vec::with_capacity(forest.vertices),
            updates: Vec::with_capacity(forest.updates.len()),
            place_of_update: vec![NONE; forest.updates.len()],
            trees: Vec::with_capacity(roots.len() + 1),
            ends: Vec::new(),
        };
        this.trees.push(0);
        for &root in &roots {
            this.walk(forest, root);
            this.trees.push(this.updates.len() as u32);
        }
        this.nodes.extend(this.updates.iter().flat_map(|&u| forest.updates[u as usize].children));
        this.nodes.iter().enumerate().for_each(|(i, &n)| this.place[n as usize] = i as u32);
        let updates = this.updates.iter().enumerate();
        updates.for_each(|(i, &u)| this.place_of_update[u as usize] = i as u32);
        this.find_ends(forest);
        this
    }

    /// Numbers the updates below a node, and the leaves.
    fn walk(&mut self, forest: &Forest, root: u32) {
        let mut stack = vec![root];
        while let Some(node) = stack.pop() {
            let Some(update) = forest.update_of(node) else {
                self.leaves.push(node);
                continue;
            };
            self.updates.push(update as u32);
            let [first, second] = forest.updates[update].children;
            stack.extend([second, first]);
        }
    }

    fn find_ends(&mut self, forest: &Forest) {
        self.ends = vec![0; self.updates.len()];
        for at in (0..self.updates.len()).rev() {
            let [first, second] = forest.updates[self.updates[at] as usize].children;
            let end = |child| forest.update_of(child).map(|u| self.place_of_update[u] as usize);
            let last = end(second).or(end(first));
            self.ends[at] = last.map_or(at as u32 + 1, |last| self.ends[last]);
        }
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
