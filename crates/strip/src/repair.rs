//! Repairs triangle strips where the level of detail has changed.

mod index_buffer;
mod indices;
mod levels;
mod live;
mod local_search;

pub use indices::StripIndices;
pub use levels::LevelStrips;
pub use live::LiveStrips;
pub use local_search::StripEffort;

use meshlod_mesh::VertexId;

use self::local_search::LocalSearch;
use crate::filter::Filter;
use crate::path_cover::PathCover;
use crate::skip::{MergeTree, SkipStrip};
use crate::strips::Strips;
use crate::verify::has_three_corners;

impl SkipStrip {
    /// Returns triangle strips of the current level, filtered and then improved by local changes.
    ///
    /// The filter is [`Filter::Dtff`](crate::Filter::Dtff); the changes start where the level
    /// differs from the mesh.
    ///
    /// They never send more vertices than the filter alone, and do not depend on the levels shown
    /// before. Cost: linear.
    pub fn repaired(&mut self, effort: StripEffort) -> Strips {
        let mut seed = Seed::default();
        self.each_strip(|tree, strip, shown| seed.add(tree, strip, shown));
        let Seed { faces, ends, is_changed } = seed;
        let mut cover = PathCover::new(&faces);
        let mut start = 0;
        for end in ends {
            cover.link_sequence(start..end);
            start = end;
        }
        let starts = starts(&cover, &is_changed);
        LocalSearch::new(effort).improve(&mut cover, &starts);
        let repaired = cover.strips(&faces);
        // With little to gain, annealing may lose by luck.
        let filtered = self.display(Filter::Dtff);
        let is_better = repaired.vertices().len() <= filtered.vertices().len();
        if is_better { repaired } else { filtered }
    }
}

/// Triangles drawn by display strips, one strip after the other.
#[derive(Default)]
struct Seed {
    faces: Vec<[VertexId; 3]>,
    /// End of each strip in `faces`.
    ends: Vec<usize>,
    /// True for triangles that differ from the mesh, or whose neighbour in the strip has vanished.
    is_changed: Vec<bool>,
}

impl Seed {
    fn add(&mut self, tree: &MergeTree, strip: &[VertexId], shown: &[VertexId]) {
        let start = self.faces.len();
        let mut is_one_gone = false;
        for (place, (was, is)) in strip.array_windows().zip(shown.array_windows()).enumerate() {
            // A window that draws nothing in the mesh cannot vanish.
            if !has_three_corners(was) {
                continue;
            }
            if !tree.is_drawn(is) {
                if let Some(before) = self.is_changed[start..].last_mut() {
                    *before = true;
                }
                is_one_gone = true;
                continue;
            }
            let &[a, b, c] = is;
            self.faces.push(if place % 2 == 0 { [a, b, c] } else { [b, a, c] });
            self.is_changed.push(was != is || is_one_gone);
            is_one_gone = false;
        }
        self.ends.push(self.faces.len());
    }
}

/// Lists the changed nodes and their neighbours.
fn starts(cover: &PathCover, is_changed: &[bool]) -> Vec<u32> {
    let near = |node: &u32| {
        let mut beside = cover.nodes[*node as usize].across.iter().filter(|edge| !edge.is_none());
        is_changed[*node as usize] || beside.any(|edge| is_changed[edge.node()])
    };
    (0..is_changed.len() as u32).filter(near).collect()
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

    fn skip_strip(mesh: &Mesh) -> SkipStrip {
        let tree = MergeTree::record(mesh, Target::Faces(0)).unwrap();
        let strips = stripify(tree.faces(), &StripOptions::default());
        SkipStrip::new(tree, strips)
    }

    fn holds_everywhere(mesh: &Mesh) {
        let mut skip = skip_strip(mesh);
        for part in [0, 5, 10, 3, 9] {
            skip.set_level(skip.tree().contractions() * part / 10);
            let level = skip.tree().level(skip.level());
            for effort in [StripEffort::Quick, StripEffort::Thorough] {
                let repaired = skip.repaired(effort);
                assert_eq!(difference(&repaired, &level), Difference::default(), "{effort:?}");
                let filtered = skip.display(Filter::Dtff);
                assert!(repaired.vertices().len() <= filtered.vertices().len());
            }
        }
    }

    #[test]
    fn repaired_strips_draw_every_level() {
        [samples::torus(600), grid(9)].iter().for_each(holds_everywhere);
        [fan(), hourglass(), moebius(20)].iter().for_each(holds_everywhere);
    }

    #[test]
    fn the_mesh_itself_keeps_its_strips() {
        let mut skip = skip_strip(&samples::sphere(500));
        let sent = |strips: &Strips| (strips.len(), strips.vertices().len());
        assert_eq!(sent(&skip.repaired(StripEffort::Thorough)), sent(skip.strips()));
    }

    #[test]
    fn coarse_levels_send_half_of_what_the_filter_leaves() {
        let mut skip = skip_strip(&samples::sphere(4000));
        skip.set_level(skip.tree().contractions_to(400));
        let [dtff, quick, thorough] = [
            skip.display(Filter::Dtff),
            skip.repaired(StripEffort::Quick),
            skip.repaired(StripEffort::Thorough),
        ]
        .map(|strips| strips.vertices().len());
        assert!(2 * quick < 2 * dtff * 2 / 3 && thorough < quick, "{dtff}, {quick}, {thorough}");
    }

    #[test]
    fn a_level_is_the_same_however_it_is_come_to() {
        let mut skip = skip_strip(&samples::torus(500));
        skip.set_level(100);
        let straight = skip.repaired(StripEffort::Quick);
        skip.set_level(200);
        skip.display(Filter::None);
        skip.set_level(100);
        assert_eq!(skip.repaired(StripEffort::Quick), straight);
    }
}
