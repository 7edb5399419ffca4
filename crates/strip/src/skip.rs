//! One set of triangle strips for all levels of a mesh.

mod cursor;
mod pointers;
mod record;
mod record_wedges;
mod tree;
mod wedges;

pub(crate) use cursor::LevelCursor;
pub use record::HistoryError;
pub use tree::MergeTree;
pub use wedges::StripWedge;

use meshlod_mesh::VertexId;

use self::pointers::Pointers;
use crate::filter::Filter;
use crate::strips::Strips;

/// Triangle strips of a mesh that serve all its levels, as each vertex is shown by its current
/// representative.
///
/// At a level these are the **display strips**. They draw exactly its triangles; a triangle that
/// has collapsed repeats a vertex and draws nothing. A [`Filter`] removes such vertices.
/// # References
/// [ESAV99], [KY05]. Differs: a vertex is active by its rank among the contractions, so setting a
/// level takes constant time.
#[derive(Clone, Debug)]
pub struct SkipStrip {
    tree: MergeTree,
    strips: Strips,
    contractions: usize,
    pointers: Pointers,
}

impl SkipStrip {
    /// Starts at the full-resolution mesh, with triangle strips of the merge tree's mesh.
    ///
    /// # Panics
    /// If the strips use a vertex that the mesh does not have.
    pub fn new(tree: MergeTree, strips: Strips) -> Self {
        let vertices = tree.vertices();
        assert!(
            strips.vertices().iter().all(|v| v.index() < vertices),
            "strips use vertices of this mesh"
        );
        Self { pointers: Pointers::new(vertices), tree, strips, contractions: 0 }
    }

    /// Returns the merge tree, which holds the mesh and its contractions.
    pub fn tree(&self) -> &MergeTree {
        &self.tree
    }

    /// Returns the triangle strips of the full-resolution mesh.
    pub fn strips(&self) -> &Strips {
        &self.strips
    }

    /// Moves to the level after a given number of contractions, clamped to the maximum.
    pub fn set_level(&mut self, contractions: usize) {
        self.contractions = contractions.min(self.tree.contractions());
    }

    /// Returns the number of contractions between the full-resolution mesh and the current level.
    pub fn level(&self) -> usize {
        self.contractions
    }

    /// Returns the vertex that represents a vertex of the full-resolution mesh at the current
    /// level.
    ///
    /// Cost: the length of the path up the tree the first time, then constant.
    pub fn shown(&mut self, vertex: VertexId) -> VertexId {
        self.tree.shown(vertex, self.contractions, &mut self.pointers)
    }

    /// Returns the triangle strips of the current level, shortened by a filter.
    ///
    /// Cost: linear in the strips of the mesh.
    pub fn display(&mut self, filter: Filter) -> Strips {
        let mut display = Strips::default();
        let mut apart = Vec::new();
        self.each_strip(|tree, _, shown| {
            if !tree.has_wedges() {
                return filter.strip(shown, &mut display);
            }
            close_collapsed(tree, shown, &mut apart);
            filter.strip(&apart, &mut display);
        });
        display
    }

    /// Calls `visit` with the tree, each strip of the mesh, and its vertices as shown at the level.
    pub(crate) fn each_strip(
        &mut self,
        mut visit: impl FnMut(&MergeTree, &[VertexId], &[VertexId]),
    ) {
        let Self { tree, strips, contractions, pointers } = self;
        let mut shown = Vec::new();
        for strip in strips.iter() {
            shown.clear();
            shown.extend(strip.iter().map(|&v| tree.shown(v, *contractions, pointers)));
            visit(tree, strip, &shown);
        }
    }
}

/// Copies the shown vertices of a strip so that every window of a collapsed triangle repeats a
/// vertex.
///
/// A triangle may collapse between two wedges *a*, *b* of one vertex: *ab* becomes *aabb*, and *axb*
/// becomes *axxxb*. Two vertices more, so windings are kept.
fn close_collapsed(tree: &MergeTree, shown: &[VertexId], to: &mut Vec<VertexId>) {
    let is_split = |a: VertexId, b: VertexId| a != b && tree.mesh_vertex(a) == tree.mesh_vertex(b);
    to.clear();
    for &next in shown {
        match to[..] {
            [.., last] if is_split(last, next) => to.extend([last, next]),
            [.., before, last] if is_split(before, next) => to.extend([last, last]),
            _ => {}
        }
        to.push(next);
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

    /// Builds strips of two faces each.
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
