use std::collections::BTreeSet;

use super::*;

/// Hashes the arguments to a number from 0 to 1.
fn hashed(a: u32, b: u32) -> f64 {
    let mut z = (u64::from(a) << 32 | u64::from(b)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ z >> 31) >> 11) as f64 / (1u64 << 53) as f64
}

fn boxes(count: u32, size: f64) -> Vec<Corners> {
    let corners = |i: u32| {
        let at = DVec3::new(hashed(i, 0), hashed(i, 1), hashed(i, 2));
        [at, at + DVec3::new(hashed(i, 3), hashed(i, 4), hashed(i, 5)) * size]
    };
    (0..count).map(corners).collect()
}

fn overlap([a, b]: Corners, [c, d]: Corners) -> bool {
    a.cmple(d).all() && c.cmple(b).all()
}

/// Collects the visited pairs, lower item first, and asserts that none comes twice.
fn visited(blocks: &BoxBlocks) -> BTreeSet<[u32; 2]> {
    let mut pairs = BTreeSet::new();
    let _ = blocks.pairs(&mut |row: OverlapRow| {
        for other in row.others() {
            let mut pair = [row.slot, other].map(|slot| blocks.items()[slot]);
            pair.sort_unstable();
            assert!(pairs.insert(pair) && pair[0] < pair[1], "{pair:?}");
        }
        ControlFlow::<()>::Continue(())
    });
    pairs
}

fn all_pairs(boxes: &[Corners]) -> BTreeSet<[u32; 2]> {
    let mut pairs = BTreeSet::new();
    for i in 0..boxes.len() {
        let overlapping = (i + 1..boxes.len()).filter(|&j| overlap(boxes[i], boxes[j]));
        pairs.extend(overlapping.map(|j| [i as u32, j as u32]));
    }
    pairs
}

#[test]
fn all_overlapping_pairs_are_visited_once_and_few_others() {
    for (count, size) in [(0, 0.1), (1, 0.1), (8, 1.0), (9, 0.3), (700, 0.05), (3000, 0.02)] {
        for moved in [0.0, 1e9, 1e-9, -1e300] {
            let boxes: Vec<Corners> =
                boxes(count, size).iter().map(|corners| corners.map(|p| p + moved)).collect();
            let visited = visited(&BoxBlocks::new(boxes.len(), |i| boxes[i as usize]));
            let expected = all_pairs(&boxes);
            assert!(visited.is_superset(&expected));
            assert!(visited.len() <= expected.len() + 2, "{} of {}", visited.len(), expected.len());
        }
    }
}

#[test]
fn far_off_boxes_and_crowds_do_not_spoil_it() {
    let mut boxes = boxes(4000, 0.02);
    for corners in &mut boxes[..2000] {
        *corners = corners.map(|p| p * 1e-4);
    }
    boxes.push([DVec3::splat(1e12), DVec3::splat(2e12)]);
    boxes.push([DVec3::splat(-1e300), DVec3::splat(-1e299)]);
    let visited = visited(&BoxBlocks::new(boxes.len(), |i| boxes[i as usize]));
    let expected = all_pairs(&boxes);
    assert!(visited.is_superset(&expected) && visited.len() <= expected.len() + 20);
}

#[test]
fn boxes_at_one_point_all_meet() {
    let blocks = BoxBlocks::new(100, |_| [DVec3::ONE; 2]);
    assert_eq!(visited(&blocks).len(), 100 * 99 / 2);
}

#[test]
fn pairs_in_a_group_are_left_out_and_no_others() {
    let boxes = boxes(2000, 0.2);
    let group = |i: u32| (!i.is_multiple_of(3)).then_some(i % 3);
    let blocks = BoxBlocks::grouped(boxes.len(), |i| boxes[i as usize], group);
    let visited = visited(&blocks);
    let (inside, between): (Vec<_>, Vec<_>) = all_pairs(&boxes)
        .into_iter()
        .partition(|&[i, j]| group(i).is_some() && group(i) == group(j));
    assert!(between.iter().all(|pair| visited.contains(pair)));
    let left = inside.iter().filter(|pair| visited.contains(*pair)).count();
    assert!(left * 50 < inside.len(), "{left} of {}", inside.len());
}

#[test]
fn a_visitor_that_breaks_ends_it() {
    let boxes = boxes(500, 0.3);
    let mut rows = 0;
    let end = BoxBlocks::new(boxes.len(), |i| boxes[i as usize]).pairs(&mut |_| {
        rows += 1;
        if rows == 3 { ControlFlow::Break("enough") } else { ControlFlow::Continue(()) }
    });
    assert_eq!((end, rows), (ControlFlow::Break("enough"), 3));
}
