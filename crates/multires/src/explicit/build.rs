//! Builds the explicit MT by replaying the contractions.

use std::sync::Arc;

use super::{Explicit, ExplicitTriangle, ExplicitUpdate};
use crate::forest::Forest;
use crate::wedges::{ForestWedges, Wedges};

impl Explicit {
    /// Builds the model from all triangles that occurred during a recorded simplification.
    ///
    /// Cost: linear, apart from scanning the stars of vertices.
    pub fn new(forest: &Forest) -> Self {
        let mut stars = vec![Vec::new(); forest.positions.len()];
        let mut this = Self {
            frame: forest.frame,
            positions: forest.positions.clone(),
            exact: forest.exact.clone(),
            updates: Vec::new(),
            triangles: Vec::new(),
            corners: Vec::new(),
            wedges: forest.wedges.as_ref().map(|all| Arc::new(Wedges::of_forest(all))),
            splits: vec![None; forest.positions.len()],
        };
        let mut corners = forest.wedges.iter().flat_map(|all| &all.corners).copied();
        for &nodes in &forest.faces {
            this.add(nodes, None, &mut stars);
            this.corners.extend(corners.next());
        }
        let is_fused_with_parent =
            |u: usize| forest.updates.get(u + 1).is_some_and(|next| next.fused_with_child);
        for u in (0..forest.updates.len()).filter(|&u| !is_fused_with_parent(u)) {
            let [first, second] = forest.updates[u].children;
            let mut children = vec![first, second];
            if forest.updates[u].fused_with_child {
                children.splice(..1, forest.updates[u - 1].children);
            }
            this.contract(forest, u, &children, &mut stars);
        }
        this.link();
        this
    }

    /// Adds a triangle that is created by a contraction and removed again by the matching
    /// refinement.
    fn add(&mut self, nodes: [u32; 3], refiner: Option<u32>, stars: &mut [Vec<u32>]) -> u32 {
        let id = self.triangles.len() as u32;
        self.triangles.push(ExplicitTriangle { nodes, creator: None, refiner });
        nodes.iter().for_each(|&node| stars[node as usize].push(id));
        id
    }

    /// Replays one contraction on the triangles around its children.
    fn contract(&mut self, forest: &Forest, of: usize, children: &[u32], stars: &mut [Vec<u32>]) {
        let id = self.updates.len() as u32;
        let node = forest.node(of) as u32;
        let mut fine: Vec<u32> =
            children.iter().flat_map(|&c| std::mem::take(&mut stars[c as usize])).collect();
        fine.sort_unstable();
        fine.dedup();
        let mut coarse = Vec::new();
        for &triangle in &fine {
            let nodes = self.triangles[triangle as usize].nodes;
            self.triangles[triangle as usize].creator = Some(id);
            for &other in nodes.iter().filter(|other| !children.contains(other)) {
                stars[other as usize].retain(|&t| t != triangle);
            }
            if nodes.iter().filter(|other| children.contains(other)).count() == 1 {
                let nodes = nodes.map(|other| if children.contains(&other) { node } else { other });
                coarse.push(self.add(nodes, Some(id), stars));
                if let Some(all) = &forest.wedges {
                    let wedges = self.corners[triangle as usize];
                    self.corners.push([0, 1, 2].map(|k| wedge_at(all, nodes[k], wedges[k])));
                }
            }
        }
        self.splits[node as usize] = Some(id);
        let ball = forest.ball(of);
        self.updates.push(ExplicitUpdate { coarse, fine, needs: Vec::new(), ball });
    }

    /// Derives the dependencies of each update from the triangles on its arcs.
    fn link(&mut self) {
        for update in &mut self.updates {
            let creators = update.coarse.iter().filter_map(|&t| self.triangles[t as usize].creator);
            update.needs = creators.collect();
            update.needs.sort_unstable();
            update.needs.dedup();
        }
    }
}

/// Returns the wedge of a node that a wedge of it or of a node below has become.
fn wedge_at(all: &ForestWedges, node: u32, mut wedge: u32) -> u32 {
    // Fused updates pass through a node that no triangle has.
    while !all.of(node).contains(&wedge) {
        wedge = all.parents[wedge as usize];
    }
    wedge
}
