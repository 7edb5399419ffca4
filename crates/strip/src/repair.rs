//! Strips that are made good again where the level changed.

mod levels;
mod live;
mod mender;

pub use levels::LevelStrips;
pub use live::LiveStrips;

use meshlod_mesh::VertexId;

use self::mender::Mender;
use crate::cover::Cover;
use crate::filter::Filter;
use crate::skip::SkipStrip;
use crate::strips::Strips;
use crate::verify::has_three_corners;

/// How much is tried.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Effort {
    /// As fast as a level may change.
    Quick,
    /// For levels that are made once.
    #[default]
    Thorough,
}

impl SkipStrip {
    /// The strips of the level: those that [`Filter::Dtff`](crate::Filter::Dtff) leaves, made better by local
    /// changes that start where the level is not as the mesh is.
    ///
    /// They never send more vertices than the filter leaves. The same for the same level, however it was come to.
    /// Cost: linear.
    pub fn repaired(&mut self, effort: Effort) -> Strips {
        let mut seed = Seed::default();
        self.each_strip(|strip, shown| seed.add(strip, shown));
        let Seed { faces, ends, is_changed } = seed;
        let mut cover = Cover::new(&faces);
        let mut start = 0;
        for end in ends {
            cover.follow(start..end);
            start = end;
        }
        let starts = starts(&cover, &is_changed);
        Mender::new(effort).mend(&mut cover, &starts);
        let repaired = cover.strips(&faces);
        // Where little is to be gained, it may be lost by luck.
        let filtered = self.display(Filter::Dtff);
        let is_better = repaired.vertices().len() <= filtered.vertices().len();
        if is_better { repaired } else { filtered }
    }
}

/// The triangles that display strips draw, one strip after the other.
#[derive(Default)]
struct Seed {
    faces: Vec<[VertexId; 3]>,
    /// Where each strip ends in `faces`.
    ends: Vec<usize>,
    /// Whether the level shows it otherwise than the mesh, or one beside it in the strip is gone.
    is_changed: Vec<bool>,
}

impl Seed {
    fn add(&mut self, strip: &[VertexId], shown: &[VertexId]) {
        let start = self.faces.len();
        let mut is_one_gone = false;
        for (place, (was, is)) in strip.array_windows().zip(shown.array_windows()).enumerate() {
            // What never drew anything cannot be gone.
            if !has_three_corners(was) {
                continue;
            }
            if !has_three_corners(is) {
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

/// What changed, and what lies beside it.
fn starts(cover: &Cover, is_changed: &[bool]) -> Vec<u32> {
    let near = |cell: &u32| {
        let mut beside = cover.cells[*cell as usize].across.iter().filter(|port| !port.is_none());
        is_changed[*cell as usize] || beside.any(|port| is_changed[port.cell()])
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
    use crate::skip::MergeTree;
    use crate::stripify::{Options, stripify};
    use crate::verify::{Difference, difference};

    fn skip_strip(mesh: &Mesh) -> SkipStrip {
        let tree = MergeTree::record(mesh, Target::Faces(0)).unwrap();
        let strips = stripify(tree.faces(), &Options::default());
        SkipStrip::new(tree, strips)
    }

    fn holds_everywhere(mesh: &Mesh) {
        let mut skip = skip_strip(mesh);
        for part in [0, 5, 10, 3, 9] {
            skip.set_level(skip.tree().contractions() * part / 10);
            let level = skip.tree().level(skip.level());
            for effort in [Effort::Quick, Effort::Thorough] {
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
        assert_eq!(sent(&skip.repaired(Effort::Thorough)), sent(skip.strips()));
    }

    #[test]
    fn coarse_levels_send_half_of_what_the_filter_leaves() {
        let mut skip = skip_strip(&samples::sphere(4000));
        skip.set_level(skip.tree().contractions_to(400));
        let [dtff, quick, thorough] = [
            skip.display(Filter::Dtff),
            skip.repaired(Effort::Quick),
            skip.repaired(Effort::Thorough),
        ]
        .map(|strips| strips.vertices().len());
        assert!(2 * quick < 2 * dtff * 2 / 3 && thorough < quick, "{dtff}, {quick}, {thorough}");
    }

    #[test]
    fn a_level_is_the_same_however_it_is_come_to() {
        let mut skip = skip_strip(&samples::torus(500));
        skip.set_level(100);
        let straight = skip.repaired(Effort::Quick);
        skip.set_level(200);
        skip.display(Filter::None);
        skip.set_level(100);
        assert_eq!(skip.repaired(Effort::Quick), straight);
    }
}
