//! Coding of directions as residuals of geometric predictions.

use glam::DVec3;
use meshlod_mesh::octahedral::{project, unfold};

use super::adjacency::{next, previous};
use super::coder::Coder;
use super::energy::{Energy, LEVELS};
use super::entries::LayerEntries;
use super::job::LayerJob;
use super::octahedron::{fold_in, shortest};

/// Contexts of the residuals: bends, inside and on the border, levels of the residuals around,
/// components.
pub(super) const DIRECTION_RESIDUALS: usize = BENDS * 2 * LEVELS * 2;
const BENDS: usize = 3;

/// Mode of a layer of directions unrelated to the geometry, such as a constant: each is predicted
/// as the mean of its neighbours.
pub(super) const BY_NEIGHBOURS: u8 = 0x80;

/// Predicted direction.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Guess {
    /// Unit direction, or zero if the geometry is not asked; `None` if it has none.
    pub(super) direction: Option<DVec3>,
    /// Distance of the faces around from a plane: 0 to 2.
    pub(super) bend: usize,
    /// True if the faces around are not all known.
    pub(super) is_open: bool,
}

/// Directions to expect in a block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Expected<G> {
    /// Returns the direction predicted from the geometry for an entry.
    pub(super) guess: G,
    /// Fraction of the neighbours' residuals that is expected again.
    pub(super) trust: f64,
}

/// Returns the parameters of the mode [`BY_NEIGHBOURS`]: no guess, and all of the neighbours'
/// residuals.
pub(super) fn by_neighbours() -> Expected<impl Fn(usize) -> Guess> {
    Expected { guess: |_| Guess { direction: Some(DVec3::ZERO), ..Guess::default() }, trust: 1.0 }
}

/// Codes the directions of all entries.
pub(super) fn code_directions(
    job: &LayerJob,
    expected: &Expected<impl Fn(usize) -> Guess>,
    coder: &mut impl Coder,
    numbers: &mut [i32],
) {
    let &LayerJob { entries, layer, .. } = job;
    let bits = layer.coding.direction_bits().expect("a layer of directions");
    let stride = job.width();
    let mut energy = Energy::new(entries.len());
    // Residual of each direction against its geometric prediction.
    let mut differences: Vec<DVec3> = Vec::with_capacity(entries.len());
    let mut last = DVec3::Z;
    for entry in 0..entries.len() {
        let guess = (expected.guess)(entry);
        let mut difference = DVec3::ZERO;
        let mut known = 0;
        energy.clear();
        for other in neighbours(entries, entry) {
            difference += differences[other];
            known += 1;
            energy.see(other);
        }
        let direction = guess.direction.unwrap_or(last);
        let whole = direction + difference * (expected.trust / f64::from(known.max(1)));
        let without = if direction == DVec3::ZERO { last } else { DVec3::Z };
        let whole = if whole.length_squared() > 0.0 { whole } else { without };
        let at = project(whole, bits).map(|x| (x + 0.5).floor() as i32);
        let way = job.wanted(entry).map(|wanted| shortest(at, [wanted[0], wanted[1]], bits));
        let surroundings = guess.bend * 2 + usize::from(guess.is_open);
        let mut magnitude = energy.around();
        let mut code = [0; 2];
        for k in 0..2 {
            let level = Energy::level(magnitude);
            let context = (surroundings * LEVELS + level) * 2 + k;
            let residual = coder.residual(job.contexts.residuals + context, way.map(|way| way[k]));
            code[k] = at[k].wrapping_add(residual);
            let size = f64::from(residual.unsigned_abs());
            energy.add(entry, size);
            magnitude = 0.5 * magnitude + size;
        }
        let code = fold_in(code, bits);
        numbers[stride * entry..][..2].copy_from_slice(&code);
        last = unfold(code.map(|x| x as u32), bits);
        differences.push(last - direction);
    }
}

/// Returns the entries before one that have a corner in a face of it, possibly more than once.
fn neighbours(entries: &LayerEntries, entry: usize) -> impl Iterator<Item = usize> {
    let ends = entries.around(entry).flat_map(|corner| [next(corner), previous(corner)]);
    ends.filter_map(move |corner| entries.before(corner, entry))
}
