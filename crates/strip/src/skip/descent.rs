//! From level to level, by what changes.

use meshlod_mesh::VertexId;

use super::pointers::Pointers;
use super::tree::MergeTree;
use crate::verify::has_three_corners;

/// A level of a merge tree, which knows the faces that the way to another one changes.
#[derive(Clone, Debug)]
pub(crate) struct Descent {
    tree: MergeTree,
    pointers: Pointers,
    contractions: usize,
    /// The vertices that go, first to last.
    order: Vec<VertexId>,
    below: Below,
    /// By face: the last time it was looked at.
    seen: Vec<u32>,
    times: u32,
}

/// The faces of the mesh by their corners, those of each vertex with all that became it in one run.
#[derive(Clone, Debug)]
struct Below {
    /// By vertex: where its run starts, and where it ends.
    runs: Vec<[u32; 2]>,
    faces: Vec<u32>,
}

/// A place in a list of triangles, and what is there now.
pub(crate) type Change = (u32, Option<[VertexId; 3]>);

impl Descent {
    /// At the mesh itself.
    pub(crate) fn new(tree: MergeTree) -> Self {
        let order = tree.order();
        Self {
            below: Below::new(&tree, &order),
            pointers: Pointers::new(tree.vertices()),
            seen: vec![0; tree.faces().len()],
            tree,
            contractions: 0,
            order,
            times: 0,
        }
    }

    pub(crate) fn tree(&self) -> &MergeTree {
        &self.tree
    }

    pub(crate) fn level(&self) -> usize {
        self.contractions
    }

    /// Goes to the level after so many contractions: the faces on the way, some of which may be as they were.
    pub(crate) fn go(&mut self, contractions: usize) -> Vec<Change> {
        let to = contractions.min(self.tree.contractions());
        let from = std::mem::replace(&mut self.contractions, to);
        let Self { tree, pointers, order, below, seen, times, .. } = self;
        *times += 1;
        let mut changes = Vec::new();
        for vertex in &order[from.min(to)..from.max(to)] {
            for &face in below.of(*vertex) {
                if std::mem::replace(&mut seen[face as usize], *times) == *times {
                    continue;
                }
                let corners = tree.faces()[face as usize].map(|v| tree.shown(v, to, pointers));
                changes.push((face, Some(corners).filter(has_three_corners)));
            }
        }
        changes
    }
}

impl Below {
    fn new(tree: &MergeTree, order: &[VertexId]) -> Self {
        let mut own = vec![0; tree.vertices()];
        tree.faces().iter().flatten().for_each(|v| own[v.index()] += 1);
        let runs = runs(tree, order, &own);
        let mut faces = vec![0; own.iter().sum::<u32>() as usize];
        let mut next: Vec<u32> = runs.iter().map(|run| run[0]).collect();
        for (face, corners) in (0..).zip(tree.faces()) {
            for v in corners {
                faces[next[v.index()] as usize] = face;
                next[v.index()] += 1;
            }
        }
        Self { runs, faces }
    }

    fn of(&self, vertex: VertexId) -> &[u32] {
        let [start, end] = self.runs[vertex.index()];
        &self.faces[start as usize..end as usize]
    }
}

/// By vertex: a run with a place for each of its own corners, and behind them the runs of those that become it.
fn runs(tree: &MergeTree, order: &[VertexId], own: &[u32]) -> Vec<[u32; 2]> {
    let parent = |v: VertexId| tree.parent(v).index();
    // What becomes a vertex has done so before it goes.
    let mut counts = own.to_vec();
    order.iter().for_each(|&v| counts[parent(v)] += counts[v.index()]);
    let mut stays = vec![true; tree.vertices()];
    order.iter().for_each(|v| stays[v.index()] = false);
    let mut runs = vec![[0; 2]; tree.vertices()];
    let mut end = 0;
    for v in (0..tree.vertices()).filter(|&v| stays[v]) {
        runs[v] = [end, end + counts[v]];
        end += counts[v];
    }
    // Where the next run within each begins. The last to go has its place before those below it.
    let mut next: Vec<u32> = runs.iter().zip(own).map(|(run, own)| run[0] + own).collect();
    for &v in order.iter().rev() {
        let start = next[parent(v)];
        next[parent(v)] += counts[v.index()];
        runs[v.index()] = [start, start + counts[v.index()]];
        next[v.index()] = start + own[v.index()];
    }
    runs
}

#[cfg(test)]
mod tests {
    use meshlod_fixtures::{fan, hourglass};
    use meshlod_mesh::Mesh;
    use meshlod_samples as samples;
    use meshlod_simplify::Target;

    use super::*;

    fn changes_lead_to_every_level(mesh: &Mesh) {
        let tree = MergeTree::record(mesh, Target::Faces(0)).unwrap();
        let mut faces: Vec<_> = tree.faces().iter().copied().map(Some).collect();
        let mut descent = Descent::new(tree);
        let all = descent.tree().contractions();
        for part in [1, 5, 4, 10, 0, 9, 3] {
            for (face, triangle) in descent.go(all * part / 10) {
                faces[face as usize] = triangle;
            }
            let mut there: Vec<_> = faces.iter().copied().flatten().collect();
            let mut level = descent.tree().level(descent.level());
            there.sort_unstable();
            level.sort_unstable();
            assert_eq!(there, level, "{part}");
        }
    }

    #[test]
    fn what_changes_is_all_that_changes() {
        changes_lead_to_every_level(&samples::knot(800));
        changes_lead_to_every_level(&fan());
        changes_lead_to_every_level(&hourglass());
    }

    #[test]
    fn little_is_looked_at_for_a_small_step() {
        let tree = MergeTree::record(&samples::sphere(4000), Target::Faces(0)).unwrap();
        let mut descent = Descent::new(tree);
        let half = descent.tree().contractions_to(2000);
        descent.go(half);
        assert!(descent.go(half + 1).len() < 100);
    }
}
