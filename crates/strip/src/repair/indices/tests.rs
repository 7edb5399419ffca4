//! Index buffers that follow strips, against strips written out as a whole.

use meshlod_samples as samples;

use super::*;
use crate::random::Random;
use crate::repair::StripEffort;
use crate::stripify::{StripOptions, stripify};
use crate::strips::Strips;

/// Returns the strips of all sets, sorted.
fn read(sets: &[Vec<u32>]) -> Vec<Vec<u32>> {
    let strips = sets.iter().flat_map(|set| set.split(|&index| index == Strips::RESTART));
    let mut strips: Vec<Vec<u32>> =
        strips.filter(|strip| !strip.is_empty()).map(<[u32]>::to_vec).collect();
    strips.sort();
    strips
}

/// Follows strips as a renderer would, which copies what has changed.
struct Copied {
    indices: StripIndices,
    copies: Vec<Vec<u32>>,
}

impl Copied {
    fn new(live: &mut LiveStrips) -> Self {
        let indices = StripIndices::new(live, 3, third);
        let copies = (0..indices.sets()).map(|set| indices.indices(set).to_vec()).collect();
        Self { indices, copies }
    }

    /// Returns the number of entries copied.
    fn follow(&mut self, live: &LiveStrips) -> usize {
        self.indices.update(live, third);
        let mut count = 0;
        for (set, copy) in self.copies.iter_mut().enumerate() {
            let all = self.indices.indices(set);
            copy.resize(all.len(), 77);
            for range in self.indices.changed(set) {
                count += range.len();
                copy[range.clone()].copy_from_slice(&all[range.clone()]);
            }
        }
        count
    }

    fn check(&self, live: &LiveStrips) {
        let mut expected = vec![Vec::new(); 3];
        for strip in live.strips().iter() {
            let set = &mut expected[third(strip[0])];
            set.extend(strip.iter().map(|v| v.0));
            set.push(Strips::RESTART);
        }
        assert_eq!(read(&self.copies), read(&expected));
        for (set, copy) in self.copies.iter().enumerate() {
            assert_eq!(copy, self.indices.indices(set));
            assert_eq!(read(&expected[set..=set]), read(&self.copies[set..=set]));
        }
        let used: usize = expected.iter().map(Vec::len).sum();
        let all: usize = self.copies.iter().map(Vec::len).sum();
        assert!(all <= used + used / 8 + SPARE, "{all} for {used}");
    }
}

/// Puts every strip into one of three sets: here by where it begins.
fn third(vertex: VertexId) -> usize {
    vertex.index() % 3
}

#[test]
fn whatever_is_written_is_in_the_buffers() {
    for effort in [StripEffort::Quick, StripEffort::Thorough] {
        let mut live = LiveStrips::new([], &Strips::default(), effort);
        let mut copied = Copied::new(&mut live);
        let mut random = Random::new(3, 0);
        for _ in 0..if effort == StripEffort::Quick { 300 } else { 30 } {
            let changes: Vec<_> = (0..30)
                .map(|_| {
                    let corners = [0; 3].map(|_| VertexId::new(random.below(12)));
                    (random.below(200) as u32, (random.below(3) > 0).then_some(corners))
                })
                .collect();
            live.update(changes);
            copied.follow(&live);
            copied.check(&live);
        }
    }
}

#[test]
fn a_small_change_rewrites_little() {
    let faces = samples::sphere(4000).faces;
    let strips = stripify(&faces, &StripOptions::default());
    let places = (0..).zip(faces.iter().copied());
    let mut live = LiveStrips::new(places.clone(), &strips, StripEffort::Quick);
    let mut copied = Copied::new(&mut live);
    live.update((100..110).map(|slot| (slot, None)));
    let taken = copied.follow(&live);
    copied.check(&live);
    assert!(taken > 0 && taken < faces.len() / 2, "{taken}");
    live.update([]);
    assert_eq!(copied.follow(&live), 0);
    live.update(places.map(|(slot, face)| (slot, Some(face))));
    copied.follow(&live);
    copied.check(&live);
}

#[test]
fn updates_that_were_skipped_are_made_up_for() {
    let faces = samples::torus(600).faces;
    let strips = stripify(&faces, &StripOptions::default());
    let places = (0..).zip(faces.iter().copied());
    let mut live = LiveStrips::new(places, &strips, StripEffort::Quick);
    let mut copied = Copied::new(&mut live);
    live.update((0..50).map(|slot| (slot, None)));
    live.update((90..95).map(|slot| (slot, None)));
    copied.follow(&live);
    copied.check(&live);
    assert_eq!(copied.follow(&live), 0);
}
