//! Strips that follow the level, each from the last.

use super::{Effort, LiveStrips};
use crate::skip::{Descent, MergeTree};
use crate::strips::Strips;

/// The strips of a level that goes up and down.
///
/// Unlike [`SkipStrip::repaired`](crate::SkipStrip::repaired) this looks at nothing but what the way from level to
/// level changes; so the strips depend on the way.
#[derive(Clone, Debug)]
pub struct LevelStrips {
    descent: Descent,
    live: LiveStrips,
}

impl LevelStrips {
    /// The strips of a tree's mesh, at the mesh itself.
    pub fn new(tree: MergeTree, strips: &Strips, effort: Effort) -> Self {
        let triangles = (0..).zip(tree.faces().iter().copied());
        Self { live: LiveStrips::new(triangles, strips, effort), descent: Descent::new(tree) }
    }

    /// Goes to the level after so many contractions, at most all. How many triangles came, went or have another
    /// corner.
    ///
    /// Cost: of what lies below the vertices that come or go.
    pub fn set_level(&mut self, contractions: usize) -> usize {
        let changes = self.descent.go(contractions);
        self.live.update(changes)
    }

    /// How many contractions the level is after.
    pub fn level(&self) -> usize {
        self.descent.level()
    }

    /// The contractions it follows.
    pub fn tree(&self) -> &MergeTree {
        self.descent.tree()
    }

    /// The strips of the level.
    ///
    /// Cost: linear in them.
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
    use crate::stripify::{Options, stripify};
    use crate::verify::{Difference, difference};

    fn start(mesh: &Mesh) -> LevelStrips {
        let tree = MergeTree::record(mesh, Target::Faces(0)).unwrap();
        let strips = stripify(tree.faces(), &Options::default());
        LevelStrips::new(tree, &strips, Effort::Quick)
    }

    fn holds_everywhere(mesh: &Mesh) {
        let mut strips = start(mesh);
        let all = strips.tree().contractions();
        for part in [0, 5, 10, 3, 9, 8, 7, 0] {
            strips.set_level(all * part / 10);
            strips.live.check();
            let level = strips.tree().level(strips.level());
            assert_eq!(difference(&strips.strips(), &level), Difference::default());
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
