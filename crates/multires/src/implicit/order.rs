//! The depth-first order in which the packed model numbers nodes and updates.

use meshlod_spatial::curve_order;

use crate::forest::{Forest, NONE};

/// Roots from which on a file has them along a curve. A base mesh of fewer takes about a kilobyte.
const MANY_ROOTS: usize = 64;

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
    /// True if roots are along a curve, and faces of the base mesh are to follow them.
    is_along_curve: bool,
}

impl Order {
    pub(crate) fn new(forest: &Forest) -> Self {
        let children =
            |node: u32| forest.update_of(node).map(|u| (u as u32, forest.updates[u].children));
        Self::of(roots(forest), forest.positions.len(), forest.updates.len(), children)
    }

    /// Returns the order of a file: of many roots, those near each other follow one another, and so do
    /// the faces of the base mesh, so that differences are small. The base of a gyroid with 5,268
    /// roots takes half of the bytes.
    pub(crate) fn for_file(forest: &Forest) -> Self {
        let roots = roots(forest);
        if roots.len() < MANY_ROOTS {
            return Self::new(forest);
        }
        let points: Vec<_> = roots.iter().map(|&root| forest.positions[root as usize]).collect();
        let roots = curve_order(&points).into_iter().map(|at| roots[at as usize]).collect();
        let children =
            |node: u32| forest.update_of(node).map(|u| (u as u32, forest.updates[u].children));
        let order = Self::of(roots, forest.positions.len(), forest.updates.len(), children);
        Self { is_along_curve: true, ..order }
    }

    /// Returns the faces that no update creates, in the order of the forest; along a curve sorted,
    /// each from its lowest node on.
    pub(crate) fn base_faces(&self, forest: &Forest) -> Vec<BaseFace> {
        // Bottom up, so that an update comes after those of its children.
        let mut root: Vec<u32> = (0..forest.positions.len() as u32).collect();
        for (u, update) in forest.updates.iter().enumerate().rev() {
            let above = root[forest.node(u)];
            update.children.iter().for_each(|&child| root[child as usize] = above);
        }
        let faces = (0u32..).zip(&forest.faces).zip(&forest.created_by);
        let mut base: Vec<_> = faces
            .filter(|(_, by)| **by == NONE)
            .map(|((of, face), _)| {
                let nodes = face.map(|leaf| self.index_of_node[root[leaf as usize] as usize]);
                BaseFace { nodes, of, start: 0 }
            })
            .collect();
        if self.is_along_curve {
            base.iter_mut().for_each(BaseFace::start_lowest);
            base.sort_unstable();
        }
        base
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
            is_along_curve: false,
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

/// A face of the base mesh, sorted by its nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct BaseFace {
    pub(crate) nodes: [u32; 3],
    /// The forest's face, and the corner of it that is the first here.
    of: u32,
    start: usize,
}

impl BaseFace {
    fn start_lowest(&mut self) {
        self.start = (0..3).min_by_key(|&k| self.nodes[k]).unwrap_or(0);
        self.nodes.rotate_left(self.start);
    }

    /// Returns what the forest has at the corners of its faces, from the first corner here on.
    pub(crate) fn corners(&self, all: &[[u32; 3]]) -> [u32; 3] {
        let mut corners = all[self.of as usize];
        corners.rotate_left(self.start);
        corners
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
