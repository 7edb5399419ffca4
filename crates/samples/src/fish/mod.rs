//! A reef fish: one closed surface with texture coordinates, colours and normals.
//!
//! The body is a grid of rings from the mouth to the tail fin. Every other fin and both eyes grow
//! out of a block of the grid's quads, which is taken out: walls rise on its rim, a cap closes them.
//! So it stays one 2-manifold of genus 0 at any size.
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

/// A fish, from -1 to 1 along x, that swims towards -x; its left side looks to +z.
///
/// One wedge for each vertex of the body but two along the belly, and own wedges for each side of
/// each fin, the eyes, the mouth and the rim of the tail, so that no chart of its uvs overlaps
/// another. Layers: `Normal` (smooth everywhere), `Uv(0)`, `Color(0)` (3 wide, as shown, not
/// linear).
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

/// Rings inside the mouth, before the lips.
const MOUTH_RINGS: usize = 2;

/// How finely the grid is cut.
struct Plan {
    /// Quads from the innermost ring of the mouth to the tail's end.
    rings: usize,
    /// Quads around: a multiple of 8.
    around: usize,
}

impl Plan {
    /// The plan that comes nearest to `faces`, its quads on the flank about square.
    fn for_faces(faces: usize) -> Self {
        // Measured: 3.9 faces per square of `around` where quads are square.
        let around = ((faces as f64 / 3.9).sqrt() / 8.0).round().max(2.0) as usize * 8;
        let plan = |rings| Self { rings, around };
        let least = 26;
        // More rings are more faces, so the nearest lies where the count passes the wish.
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

    /// The body's coordinate of a ring that far behind the lips: 0 at the lips, 1 at the tail's end.
    fn along(&self, ring: usize) -> f64 {
        ring as f64 / (self.rings - MOUTH_RINGS) as f64
    }

    /// The block at a root, of this side; `thickness` quads across where the root has no width.
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

    /// Quads across a fin's root: an even number, so that a line runs along its rim.
    fn thickness(&self) -> usize {
        2 * (self.around as f64 / 40.0).round().max(1.0) as usize
    }

    /// Where the grid must bend, to run round the eyes and close up to the fins.
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

    /// Eyes and fins, in the order of their texture charts.
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

/// An angle from turns.
fn radians(turn: f64) -> f64 {
    TAU * turn
}
