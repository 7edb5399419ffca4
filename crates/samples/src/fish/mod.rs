//! Sample mesh of a reef fish: one closed surface with texture coordinates, colours and normals.
//!
//! The body is a grid of rings from the mouth to the tail fin. Each of the other fins and both eyes
//! replace a block of quads of the grid: walls rise from the rim of the block, and a cap closes
//! them. So the fish is one 2-manifold of genus 0 at any size.
//!
//! ```text
//!      cap  ┌──┬──┐          mouth ring 0 .. 2   lips at 2, then M rings of the body,
//!    walls ┌┴┐ │ ┌┴┐         the last of which is the rim of the tail fin
//!    body ─┘ block └─        both end rings are laced shut
//! ```

mod body;
mod build;
mod eye;
mod fin;
mod patch;
#[cfg(test)]
mod tests;

use std::f64::consts::TAU;

use body::{Side, Site, Sites};
use build::Builder;
use fin::{Fin, Root};
use patch::{Block, Patch};

use meshlod_mesh::Mesh;

/// Builds a closed reef fish with texture coordinates, colours and normals.
///
/// It reaches from -1 to 1 along x and swims towards -x, with its left side towards +z.
///
/// The body has one wedge per vertex, two along the belly. Each side of each fin, the eyes, the
/// mouth and the rim of the tail have wedges of their own, so that no two texture charts overlap.
/// Layers: `Normal` (smooth everywhere), `Uv(0)` and `Color(0)` (3 wide, sRGB).
///
/// Faces: within 2 % of `faces` from 2,000 on; at least about 1,300.
pub fn fish(faces: usize) -> Mesh {
    let plan = Plan::for_faces(faces);
    let mut builder = Builder::new(plan.rings, plan.around);
    let patches = plan.patches();
    let sites = plan.sites();
    builder.body(&patches, |ring, turn| match ring.checked_sub(MOUTH_RINGS) {
        None => body::mouth(ring, turn),
        Some(ring) => body::skin(plan.along(ring), turn, &sites),
    });
    for patch in &patches {
        builder.patch(patch);
    }
    builder.finish()
}

/// Number of rings inside the mouth, before the lips.
const MOUTH_RINGS: usize = 2;

/// Resolution of the grid.
struct Plan {
    /// Number of quads from the innermost ring of the mouth to the end of the tail.
    rings: usize,
    /// Number of quads around the body, a multiple of 8.
    around: usize,
}

impl Plan {
    /// Returns the plan with the number of faces closest to `faces` and nearly square quads on the
    /// flank.
    fn for_faces(faces: usize) -> Self {
        // Measured: 3.9 faces per square of `around` where quads are square.
        let around = ((faces as f64 / 3.9).sqrt() / 8.0).round().max(2.0) as usize * 8;
        let plan = |rings| Self { rings, around };
        let least = 26;
        // More rings mean more faces: bisect for the smallest plan that is large enough.
        let (mut low, mut high) = (least, least + 4 * around);
        while low < high {
            let middle = (low + high) / 2;
            if plan(middle).faces() < faces { low = middle + 1 } else { high = middle }
        }
        let below = plan(low.saturating_sub(1).max(least));
        if below.faces().abs_diff(faces) < plan(low).faces().abs_diff(faces) {
            below
        } else {
            plan(low)
        }
    }

    fn faces(&self) -> usize {
        let walls: usize = self.patches().iter().map(|patch| patch.added_faces()).sum();
        2 * self.rings * self.around + 2 * (self.around - 2) + walls
    }

    /// Returns the coordinate along the body of a ring behind the lips: 0 at the lips, 1 at the
    /// tail's end.
    fn along(&self, ring: usize) -> f64 {
        ring as f64 / (self.rings - MOUTH_RINGS) as f64
    }

    /// Returns the block at a root on one side, `thickness` quads wide across the chord of the
    /// root.
    fn block(&self, root: Root, side: Side, thickness: usize) -> Block {
        let ring = |along: f64| (along * (self.rings - MOUTH_RINGS) as f64).round() as usize;
        let place = |turn: f64| (turn * self.around as f64).round() as usize;
        let (rings, [low, high]) = match root {
            Root::Along([from, to], turn) => {
                let low = place(turn) + self.around - thickness / 2;
                ([ring(from), ring(to).max(ring(from) + 1)], [low, low + thickness])
            }
            Root::Around(along, [from, to]) => {
                let first = ring(along) - thickness / 2;
                ([first, first + thickness], [place(from), place(to).max(place(from) + 2)])
            }
        };
        let around = match side {
            Side::Left => [low, high],
            Side::Right => [3 * self.around - high, 3 * self.around - low],
        };
        Block { rings: rings.map(|ring| ring + MOUTH_RINGS), around }
    }

    fn eye_block(&self, side: Side) -> Block {
        self.block(eye::ROOT, side, (self.around / 8).max(2))
    }

    /// Returns the number of quads across the root of a fin: even, so that an edge runs along its
    /// rim.
    fn thickness(&self) -> usize {
        2 * (self.around as f64 / 40.0).round().max(1.0) as usize
    }

    /// Returns the blocks that the grid bends for: around the eyes, and close to the fins.
    fn sites(&self) -> Sites {
        let site = |block: Block| {
            let [first, last] = block.rings.map(|ring| self.along(ring - MOUTH_RINGS));
            let [low, high] = block.around.map(|j| (j as f64 / self.around as f64).fract());
            let middle = [0.5 * (first + last), 0.5 * (low + high)];
            Site { middle, half: [0.5 * (last - first), 0.5 * (high - low)], open: [0.0; 2] }
        };
        let eye = site(self.eye_block(Side::Left));
        let fin = |root| site(self.block(root, Side::Left, self.thickness()));
        Sites {
            eye: Site { open: eye::open(eye.middle), ..eye },
            pectoral: Site { open: fin::PECTORAL_SLIT, ..fin(fin::PECTORAL) },
            pelvic: Site { open: fin::PELVIC_SLIT, ..fin(fin::PELVIC) },
        }
    }

    /// Returns the eyes and fins, in the order of their texture charts.
    fn patches(&self) -> Vec<Patch> {
        let sites = self.sites();
        let mut patches: Vec<_> = [Side::Left, Side::Right]
            .into_iter()
            .map(|side| eye::patch(side, self.eye_block(side), sites.eye))
            .collect();
        for fin in Fin::all(&sites) {
            let block = self.block(fin.root, fin.side(), self.thickness());
            let levels = (fin.levels * self.around).div_ceil(32).max(2);
            patches.push(Patch { block, levels, shape: Box::new(fin) });
        }
        patches
    }
}

/// Converts turns to radians.
fn radians(turn: f64) -> f64 {
    TAU * turn
}
