//! Moves between levels of a merge tree, visiting only what changes.

use meshlod_mesh::VertexId;

use super::pointers::Pointers;
use super::tree::MergeTree;

/// A current level of a merge tree that can list the faces changed by a move to another level.
#[derive(Clone, Debug)]
pub(crate) struct LevelCursor {
    tree: MergeTree,
    pointers: Pointers,
    contractions: usize,
    /// Vertices that vanish, in order.
    order: Vec<VertexId>,
    below: SubtreeFaces,
    /// Number of the move that last visited each face.
    seen: Vec<u32>,
    times: u32,
}

/// Faces by vertex, stored so that the faces of a vertex and of all its descendants are
/// consecutive.
#[derive(Clone, Debug)]
struct SubtreeFaces {
    /// Start and end of each vertex's range in `faces`.
    runs: Vec<[u32; 2]>,
    faces: Vec<u32>,
}

/// A slot in a list of triangles, and its new content.
pub(crate) type Change = (u32, Option<[VertexId; 3]>);

impl LevelCursor {
    /// Starts at the full mesh.
    pub(crate) fn new(tree: MergeTree) -> Self {
        let order = tree.order();
        Self {
            below: SubtreeFaces::new(&tree, &order),
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

    /// Moves to another level and lists the faces on the way, some of which may be unchanged.
    pub(crate) fn move_to(&mut self, contractions: usize) -> Vec<Change> {
        let to = contractions.min(self.tree.contractions());
        let from = std::mem::replace(&mut self.contractions, to);
        let Self { tree, pointers, order, below, seen, times, .. } = self;
        *times += 1;
        let mut changes = Vec::new();
        let until = |contractions| order.partition_point(|&v| tree.is_gone(v, contractions));
        for vertex in &order[until(from.min(to))..until(from.max(to))] {
            for &face in below.of(*vertex) {
                if std::mem::replace(&mut seen[face as usize], *times) == *times {
                    continue;
                }
                let corners = tree.faces()[face as usize].map(|v| tree.shown(v, to, pointers));
                changes.push((face, Some(corners).filter(|corners| tree.is_drawn(corners))));
            }
        }
        changes
    }
}

impl SubtreeFaces {
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

/// Lays out a range for each vertex: its own corners, then the ranges of its descendants.
fn runs(tree: &MergeTree, order: &[VertexId], own: &[u32]) -> Vec<[u32; 2]> {
    let parent = |v: VertexId| tree.parent(v).index();
    // Descendants vanish before their ancestor.
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
    // Start of the next child range in each. The last to vanish comes first.
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
        let mut cursor = LevelCursor::new(tree);
        let all = cursor.tree().contractions();
        for part in [1, 5, 4, 10, 0, 9, 3] {
            for (face, triangle) in cursor.move_to(all * part / 10) {
                faces[face as usize] = triangle;
            }
            let mut there: Vec<_> = faces.iter().copied().flatten().collect();
            let mut level = cursor.tree().level(cursor.level());
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
        let mut cursor = LevelCursor::new(tree);
        let half = cursor.tree().contractions_to(2000);
        cursor.move_to(half);
        assert!(cursor.move_to(half + 1).len() < 100);
    }
}
