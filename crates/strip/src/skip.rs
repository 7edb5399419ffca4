//! One set of strips for all levels.

mod descent;
mod pointers;
mod tree;

pub(crate) use descent::Descent;
pub use tree::{HistoryError, MergeTree};

use meshlod_mesh::VertexId;

use self::pointers::Pointers;
use crate::filter::Filter;
use crate::strips::Strips;

/// The strips of a mesh, with each vertex shown by the one it has become.
///
/// At a level these are the **display strips**. They draw exactly its triangles; what has lost an edge
/// repeats a vertex and draws nothing. A [`Filter`] takes such vertices out.
/// # References
/// [ESAV99], [KY05]. Differs: a vertex is active by its turn among the contractions, so a level is set
/// in no time.
#[derive(Clone, Debug)]
pub struct SkipStrip {
    tree: MergeTree,
    strips: Strips,
    contractions: usize,
    pointers: Pointers,
}

impl SkipStrip {
    /// Strips of the tree's mesh, at the mesh itself.
    ///
    /// # Panics
    /// Strips of more vertices than the mesh has.
    pub fn new(tree: MergeTree, strips: Strips) -> Self {
        let vertices = tree.vertices();
        assert!(strips.vertices().iter().all(|v| v.index() < vertices), "they are of this mesh");
        Self { pointers: Pointers::new(vertices), tree, strips, contractions: 0 }
    }

    /// The contractions it follows.
    pub fn tree(&self) -> &MergeTree {
        &self.tree
    }

    /// The strips of the mesh.
    pub fn strips(&self) -> &Strips {
        &self.strips
    }

    /// Goes to the level after so many contractions, at most all, up or down.
    pub fn set_level(&mut self, contractions: usize) {
        self.contractions = contractions.min(self.tree.contractions());
    }

    /// How many contractions the level is after.
    pub fn level(&self) -> usize {
        self.contractions
    }

    /// The vertex that stands for one of the mesh's.
    ///
    /// Cost: of the way up where it was not followed before, else constant.
    pub fn shown(&mut self, vertex: VertexId) -> VertexId {
        self.tree.shown(vertex, self.contractions, &mut self.pointers)
    }

    /// The display strips of the level, filtered: in one pass.
    ///
    /// Cost: linear in the strips of the mesh.
    pub fn display(&mut self, filter: Filter) -> Strips {
        let mut display = Strips::default();
        self.each_strip(|_, shown| filter.strip(shown, &mut display));
        display
    }

    /// Calls `visit` with each strip of the mesh, and with what shows its vertices at the level.
    pub(crate) fn each_strip(&mut self, mut visit: impl FnMut(&[VertexId], &[VertexId])) {
        let Self { tree, strips, contractions, pointers } = self;
        let mut shown = Vec::new();
        for strip in strips.iter() {
            shown.clear();
            shown.extend(strip.iter().map(|&v| tree.shown(v, *contractions, pointers)));
            visit(strip, &shown);
        }
    }
}

#[cfg(test)]
mod tests {
    use meshlod_fixtures::{fan, grid, hourglass, moebius};
    use meshlod_mesh::Mesh;
    use meshlod_samples as samples;
    use meshlod_simplify::Target;

    use super::*;
    use crate::verify::{Difference, difference};

    const FILTERS: [Filter; 3] = [Filter::None, Filter::Stss, Filter::Dtff];

    /// Strips of two faces each.
    fn pairs(tree: &MergeTree) -> Strips {
        let mut strips = Strips::default();
        for pair in tree.faces().chunks(2) {
            match *pair {
                [[a, b, c], [d, e, f]] => strips.push([a, b, c, c, d, d, d, e, f]),
                _ => strips.push(pair[0]),
            }
        }
        strips
    }

    fn holds_everywhere(mesh: &Mesh) {
        let tree = MergeTree::record(mesh, Target::Faces(0)).unwrap();
        let mut skip = SkipStrip::new(tree.clone(), pairs(&tree));
        let all = tree.contractions();
        for part in [0, 5, 10, 3, 9, 0, 7, 1, 10, 6] {
            skip.set_level(all * part / 10);
            let level = tree.level(skip.level());
            let sent = FILTERS.map(|filter| {
                let display = skip.display(filter);
                assert_eq!(difference(&display, &level), Difference::default(), "{filter:?}");
                display.vertices().len()
            });
            assert!(sent.is_sorted_by(|more, less| more >= less), "{sent:?}");
        }
    }

    #[test]
    fn every_filter_draws_every_level_on_the_way_up_and_down() {
        holds_everywhere(&samples::torus(600));
        holds_everywhere(&grid(9));
    }

    #[test]
    fn so_it_does_where_the_surface_is_not_manifold_or_oriented() {
        [fan(), hourglass(), moebius(20)].iter().for_each(holds_everywhere);
    }
}
