//! Triangle strips that follow a changing level of detail incrementally.

use meshlod_mesh::VertexId;

use super::{LiveStrips, StripEffort, StripIndices};
use crate::skip::{LevelCursor, MergeTree};
use crate::strips::Strips;

/// Triangle strips of a mesh whose level of detail goes up and down.
///
/// Unlike [`SkipStrip::repaired`](crate::SkipStrip::repaired) it updates only what changes from one
/// level to the next, so the strips depend on the levels before.
#[derive(Clone, Debug)]
pub struct LevelStrips {
    cursor: LevelCursor,
    live: LiveStrips,
}

impl LevelStrips {
    /// Starts at the full-resolution mesh with the given triangle strips of it.
    pub fn new(tree: MergeTree, strips: &Strips, effort: StripEffort) -> Self {
        let triangles = (0..).zip(tree.faces().iter().copied());
        Self { live: LiveStrips::new(triangles, strips, effort), cursor: LevelCursor::new(tree) }
    }

    /// Moves to the level after a given number of contractions, clamped to the maximum, and returns
    /// the number of triangles added, removed or changed.
    ///
    /// Cost: proportional to the faces below the vertices that vanish or return.
    pub fn set_level(&mut self, contractions: usize) -> usize {
        let changes = self.cursor.move_to(contractions);
        self.live.update(changes)
    }

    /// Returns the number of contractions between the full-resolution mesh and the current level.
    pub fn level(&self) -> usize {
        self.cursor.level()
    }

    /// Returns the merge tree, which holds the mesh and its contractions.
    pub fn tree(&self) -> &MergeTree {
        self.cursor.tree()
    }

    /// Writes the current triangle strips into index buffers, as [`StripIndices::new`] does.
    ///
    /// Cost: linear in their length.
    pub fn indices(&mut self, sets: usize, set_of: impl Fn(VertexId) -> usize) -> StripIndices {
        StripIndices::new(&mut self.live, sets, set_of)
    }

    /// Brings index buffers up to date after [`set_level`](Self::set_level).
    ///
    /// Cost: the length of the strips that have changed, amortized.
    pub fn update_indices(&self, indices: &mut StripIndices, set_of: impl Fn(VertexId) -> usize) {
        indices.update(&self.live, set_of);
    }

    /// Returns the triangle strips of the current level.
    ///
    /// Cost: linear in their length.
    pub fn strips(&self) -> Strips {
        self.live.strips()
    }
}

#[cfg(test)]
mod tests {
    use meshlod_fixtures::{fan, grid, hourglass, moebius};
    use meshlod_mesh::Mesh;
    use meshlod_samples as samples;
    use meshlod_simplify::Target;

    use super::*;
    use crate::stripify::{StripOptions, stripify};
    use crate::verify::{Difference, difference};

    fn start(mesh: &Mesh) -> LevelStrips {
        let tree = MergeTree::record(mesh, Target::Faces(0)).unwrap();
        let strips = stripify(tree.faces(), &StripOptions::default());
        LevelStrips::new(tree, &strips, StripEffort::Quick)
    }

    fn holds_everywhere(mesh: &Mesh) {
        let mut strips = start(mesh);
        let all = strips.tree().contractions();
        let mut indices = strips.indices(1, |_| 0);
        for part in [0, 5, 10, 3, 9, 8, 7, 0] {
            strips.set_level(all * part / 10);
            strips.live.check();
            let level = strips.tree().level(strips.level());
            assert_eq!(difference(&strips.strips(), &level), Difference::default());
            strips.update_indices(&mut indices, |_| 0);
            let sent = indices.indices(0).iter().filter(|&&index| index != Strips::RESTART);
            assert_eq!(sent.count(), strips.strips().vertices().len());
        }
    }

    #[test]
    fn every_level_is_drawn_on_the_way_up_and_down() {
        [samples::torus(600), grid(9)].iter().for_each(holds_everywhere);
        [fan(), hourglass(), moebius(20)].iter().for_each(holds_everywhere);
    }

    #[test]
    fn strips_stay_good_all_the_way() {
        let mut strips = start(&samples::torus(2000));
        for percent in (10..=100).rev().chain(10..=100) {
            strips.set_level(strips.tree().contractions_to(2000 * percent / 100));
        }
        let sent = strips.strips().vertices().len();
        assert!(sent < 2000 * 5 / 4, "{sent}");
    }

    #[test]
    fn a_level_that_stays_costs_nothing() {
        let mut strips = start(&samples::sphere(500));
        assert!(strips.set_level(50) > 0);
        let before = strips.strips();
        assert_eq!(strips.set_level(50), 0);
        assert_eq!(strips.strips(), before);
    }
}
