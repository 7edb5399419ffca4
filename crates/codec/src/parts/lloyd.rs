//! Parts that are grown anew from their middles, again and again [Llo82], in the distance whose ball is a
//! cube [LCL10].

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec3;
use meshlod_mesh::Bounds;

use super::surface::Surface;

/// So often parts are grown anew at most, and so often without getting better. On horse, feline and
/// squirrel all that is gained is gained in the first dozen rounds.
const ROUNDS: usize = 24;
const PATIENCE: usize = 6;

/// Parts whose common box is as small as was found, from given ones. All have a face.
pub(super) fn settle(surface: &Surface, parts: Vec<u32>, count: usize) -> Vec<u32> {
    let mut best = (common_box(&boxes(surface, &parts, count)), parts.clone());
    let (mut parts, mut worse) = (parts, 0);
    for _ in 0..ROUNDS {
        parts = grow(surface, &seeds(surface, &parts, count));
        let size = common_box(&boxes(surface, &parts, count));
        if cost(size) < cost(best.0) {
            best = (size, parts.clone());
            worse = 0;
        } else {
            worse += 1;
        }
        if worse > PATIENCE {
            break;
        }
    }
    best.1
}

/// The sides of the least box that each part fits into.
pub(super) fn common_box(boxes: &[Bounds]) -> DVec3 {
    let sides = boxes.iter().map(|of| DVec3::from(of.max) - DVec3::from(of.min));
    sides.fold(DVec3::ZERO, DVec3::max)
}

/// The box of each part.
pub(super) fn boxes(surface: &Surface, parts: &[u32], count: usize) -> Vec<Bounds> {
    let mut boxes = vec![Bounds::EMPTY; count];
    for (face, &part) in (0..).zip(parts) {
        surface.corners(face).into_iter().for_each(|corner| boxes[part as usize].add(corner));
    }
    boxes
}

/// The mean square of the error of cells that share a box so out, but for a factor.
fn cost(size: DVec3) -> f64 {
    size.length_squared()
}

/// The face of each part that is closest to the middle of its box.
fn seeds(surface: &Surface, parts: &[u32], count: usize) -> Vec<u32> {
    let middles = boxes(surface, parts, count).into_iter().map(|of| DVec3::from(of.center()));
    let middles: Vec<DVec3> = middles.collect();
    let mut seeds = vec![(f64::INFINITY, 0); count];
    for (face, &part) in (0..).zip(parts) {
        let distance = center(surface, face).distance(middles[part as usize]);
        let best = &mut seeds[part as usize];
        if distance < best.0 {
            *best = (distance, face);
        }
    }
    seeds.into_iter().map(|(_, face)| face).collect()
}

/// Each face to the seed from which it is reached with the least stretch.
fn grow(surface: &Surface, seeds: &[u32]) -> Vec<u32> {
    let centers: Vec<DVec3> = seeds.iter().map(|&seed| center(surface, seed)).collect();
    let stretch = |face: u32, part: u32| {
        let from = centers[part as usize];
        let corners = surface.corners(face).map(|corner| (DVec3::from(corner) - from).abs());
        corners[0].max(corners[1]).max(corners[2]).max_element()
    };
    let mut parts = vec![NONE; surface.faces()];
    // Lengths are not negative: their bits are in their order.
    let entry = |face: u32, part: u32| Reverse((stretch(face, part).to_bits(), face, part));
    let mut waiting: BinaryHeap<_> =
        seeds.iter().zip(0..).map(|(&seed, part)| Reverse((0, seed, part))).collect();
    while let Some(Reverse((_, face, part))) = waiting.pop() {
        if parts[face as usize] != NONE {
            continue;
        }
        parts[face as usize] = part;
        let open = surface.neighbours(face).filter(|&other| parts[other as usize] == NONE);
        waiting.extend(open.map(|other| entry(other, part)));
    }
    // What no seed can reach goes to the one that is closest all the same.
    for face in 0..surface.faces() as u32 {
        if parts[face as usize] == NONE {
            let closest = (0..seeds.len() as u32).min_by_key(|&part| stretch(face, part).to_bits());
            parts[face as usize] = closest.unwrap_or(0);
        }
    }
    parts
}

const NONE: u32 = u32::MAX;

fn center(surface: &Surface, face: u32) -> DVec3 {
    let [a, b, c] = surface.corners(face).map(|corner| DVec3::from(corner) / 3.0);
    a + b + c
}
