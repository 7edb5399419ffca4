//! Lloyd relaxation: parts are grown again from their middles, several times [Llo82], with a
//! distance whose ball is nearly a cube [LCL10].

use glam::{DVec3, Vec3};
use meshlod_mesh::Bounds;
use rayon::prelude::*;

use super::face_graph::FaceGraph;

/// Limits on all rounds and on rounds without improvement. Horse, feline and squirrel, in parts of
/// 70 % reduction, are best after 7 to 15 rounds, 7 to 14 % better than before; from round 7 on the
/// gain is 1 %.
const ROUNDS: usize = 16;
const PATIENCE: usize = 2;
/// Number of distance buckets up to the largest box side.
const STEPS: usize = 2048;
/// Weight of the sum of a distance's components next to the largest one, which decides between
/// seeds that are equally far by that alone. Five scans take within 1 % of that without it, and up
/// to 1 % more at a sixteenth.
const SUM: f32 = 1.0 / 64.0;
/// Exponent of a box's size in the factor on its part's distances, by which large parts give faces
/// to small ones: the largest decides. Squirrel, bunny, horse, dragon and igea take 3.9, 2.4, .3, .1
/// and 0 % less than at 0, and with .5 they take .7, .7, .2, .2 and -.2 % more.
const BALANCE: f32 = 0.25;
/// Limits on that factor.
const WEIGHTS: [f32; 2] = [0.5, 2.0];
/// A box that covers this fraction of the mesh's extent along an axis counts as spanning it.
const SPANNING: f64 = 0.999;
/// Minimum number of faces whose boxes are merged.
const CHUNK: usize = 1 << 16;

/// Improves a partition until its common box shrinks no further. Every part keeps a face.
pub(super) fn relax(graph: &FaceGraph, parts: Vec<u32>, count: usize) -> Vec<u32> {
    let boxes_of = |parts: &[u32]| boxes(graph, parts, count);
    let mut boxes = boxes_of(&parts);
    let mut best = (cost(&boxes), parts.clone());
    let (mut parts, mut from, mut worse) = (parts, Vec::new(), 0);
    let mut weights = vec![1.0; count];
    for _ in 0..ROUNDS {
        let axes = counted_axes(graph, &boxes);
        let seeds = seeds(graph, &parts, &boxes, axes);
        if seeds == from || worse > PATIENCE {
            break;
        }
        balance(&mut weights, &boxes, axes);
        let grower = Grower::new(graph, &seeds, &weights, &boxes, axes);
        parts = grower.grow(&parts);
        from = seeds;
        boxes = boxes_of(&parts);
        let cost = cost(&boxes);
        worse = if cost < best.0 { 0 } else { worse + 1 };
        if cost < best.0 {
            best = (cost, parts.clone());
        }
    }
    best.1
}

/// Returns the box of each part.
pub(super) fn boxes(graph: &FaceGraph, parts: &[u32], count: usize) -> Vec<Bounds> {
    // A chunk has at least as many faces as there are boxes, so merging these costs little.
    let size = CHUNK.max(count);
    let of_chunk = |(chunk, parts): (usize, &[u32])| {
        let mut boxes = vec![Bounds::EMPTY; count];
        for (face, &part) in (chunk * size..).zip(parts) {
            boxes[part as usize].merge(graph.face_box(face as u32));
        }
        boxes
    };
    let merge = |mut all: Vec<Bounds>, boxes: Vec<Bounds>| {
        all.iter_mut().zip(&boxes).for_each(|(all, of)| all.merge(of));
        all
    };
    parts.par_chunks(size).enumerate().map(of_chunk).reduce_with(merge).unwrap_or_default()
}

/// Returns the squared diagonal of the least box that all boxes fit into, to which the mean squared
/// error is proportional.
pub(super) fn cost(boxes: &[Bounds]) -> f64 {
    common_sides(boxes).length_squared()
}

fn common_sides(boxes: &[Bounds]) -> DVec3 {
    boxes.iter().map(sides).fold(DVec3::ZERO, DVec3::max)
}

fn sides(of: &Bounds) -> DVec3 {
    DVec3::from(of.max) - DVec3::from(of.min)
}

/// Returns 1 for each axis along which distances count, and 0 for those along which a part spans
/// the whole mesh already, so that all others may, too. Else parts of a plate would have faces on
/// its upper or its lower side only, and borders around each hole.
fn counted_axes(graph: &FaceGraph, boxes: &[Bounds]) -> Vec3 {
    let is_spanned = common_sides(boxes).cmpge(graph.extent() * SPANNING);
    Vec3::select(is_spanned, Vec3::ZERO, Vec3::ONE)
}

/// Increases the weights of parts with large boxes, and decreases those of the others.
fn balance(weights: &mut [f32], boxes: &[Bounds], axes: Vec3) {
    let common = common_sides(boxes).max(DVec3::splat(f64::MIN_POSITIVE));
    let share = |of: &Bounds| ((sides(of) / common).as_vec3() * axes).max_element();
    let mean = boxes.iter().map(share).sum::<f32>() / boxes.len() as f32;
    for (weight, of) in weights.iter_mut().zip(boxes) {
        let ratio = if mean > 0.0 { share(of) / mean } else { 1.0 };
        *weight = (*weight * ratio.powf(BALANCE)).clamp(WEIGHTS[0], WEIGHTS[1]);
    }
}

/// Returns the face of each part that is closest to the middle of its box.
fn seeds(graph: &FaceGraph, parts: &[u32], boxes: &[Bounds], axes: Vec3) -> Vec<u32> {
    let middles: Vec<_> = boxes.iter().map(|of| graph.middle(of)).collect();
    let mut seeds = vec![(f32::INFINITY, 0); boxes.len()];
    for (face, &part) in (0..).zip(parts) {
        let distance = ((graph.center(face) - middles[part as usize]) * axes).length_squared();
        let best = &mut seeds[part as usize];
        if distance < best.0 {
            *best = (distance, face);
        }
    }
    seeds.into_iter().map(|(_, face)| face).collect()
}

/// Growth of parts from their seeds.
struct Grower<'g> {
    graph: &'g FaceGraph<'g>,
    seeds: &'g [u32],
    /// Middle of each seed, and the factor on distances from it.
    from: Vec<(Vec3, f32)>,
    axes: Vec3,
}

impl<'g> Grower<'g> {
    fn new(
        graph: &'g FaceGraph<'_>,
        seeds: &'g [u32],
        weights: &[f32],
        boxes: &[Bounds],
        axes: Vec3,
    ) -> Self {
        let longest = boxes.iter().map(super::longest_side).fold(0.0, f64::max);
        let unit = (1.0 + SUM) * graph.unit_length(longest).max(f32::MIN_POSITIVE);
        let from = seeds.iter().zip(weights);
        let from =
            from.map(|(&seed, &by)| (graph.center(seed), by / unit * STEPS as f32)).collect();
        Self { graph, seeds, from, axes }
    }

    /// Assigns each face to the seed from which it is reached with the least distance, to within a
    /// [`STEPS`]th of the largest box. Faces that no seed reaches stay in their part.
    ///
    /// Cost: O(n), n = faces.
    fn grow(&self, before: &[u32]) -> Vec<u32> {
        let mut parts = before.to_vec();
        // The least step at which a face waits, then 0 when it has its part.
        let mut least = vec![u16::MAX; parts.len()];
        let mut waiting = vec![Vec::new(); STEPS + 2];
        waiting[1] = self.seeds.iter().copied().zip(0..).collect();
        self.seeds.iter().for_each(|&seed| least[seed as usize] = 1);
        for now in 1..waiting.len() {
            let mut at = 0;
            while let Some(&(face, part)) = waiting[now].get(at) {
                at += 1;
                if usize::from(least[face as usize]) != now {
                    continue;
                }
                least[face as usize] = 0;
                parts[face as usize] = part;
                for other in self.graph.neighbours(face) {
                    let waits = &mut least[other as usize];
                    if usize::from(*waits) > now {
                        let step = self.step(other, part).max(now);
                        if step < usize::from(*waits) {
                            *waits = step as u16;
                            waiting[step].push((other, part));
                        }
                    }
                }
            }
            waiting[now] = Vec::new();
        }
        parts
    }

    /// Returns the step at which a part reaches a face: 1 to [`STEPS`] + 1.
    fn step(&self, face: u32, part: u32) -> usize {
        let (from, scale) = self.from[part as usize];
        let reach = self.graph.reach(face, from) * self.axes;
        let distance = (reach.max_element() + SUM * reach.element_sum()) * scale;
        // What is farther than any box was comes last.
        1 + (distance as usize).min(STEPS)
    }
}
