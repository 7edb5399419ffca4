//! Eyes of the fish: a dark rim, a golden iris, a black pupil.

use glam::DVec3;

use super::body::{self, Side, Site};
use super::fin::Root;
use super::patch::{Block, Chart, Patch, Shape, Spot, Within};

/// Position of the left eye.
pub(super) const ROOT: Root = Root::Along([0.085, 0.155], 0.335);
/// Radius of the eye, in model units.
const RADIUS: f64 = 0.052;

/// Rings of the eye: radius as a fraction of the whole, and height above the skin.
const RINGS: [[f64; 2]; 3] = [[1.0, 0.0], [0.86, 0.013], [0.56, 0.020]];
/// Height of the center of the pupil.
const PUPIL: f64 = 0.023;

/// Creates the eye that replaces `block`.
pub(super) fn patch(side: Side, block: Block, site: Site) -> Patch {
    Patch { block, levels: RINGS.len() - 1, shape: Box::new(Eye { side, site }) }
}

/// Returns half the size, along and in turns, of an eye around `middle` that is a circle on the
/// skin.
pub(super) fn open(middle: [f64; 2]) -> [f64; 2] {
    let step = 1e-3;
    let [along, turn] = middle;
    let from = body::point(along, turn);
    let per_along = from.distance(body::point(along + step, turn)) / step;
    let per_turn = from.distance(body::point(along, turn + step)) / step;
    [RADIUS / per_along, RADIUS / per_turn]
}

/// Maps a point of the square [-1, 1]² around the block of an eye to the disc that it is bent to.
pub(super) fn on_disc(a: f64, b: f64, site: &Site) -> [f64; 2] {
    let square = a.abs().max(b.abs());
    let round = if square == 0.0 { 0.0 } else { square / a.hypot(b) };
    site.at(a * round, b * round)
}

struct Eye {
    side: Side,
    site: Site,
}

impl Eye {
    /// Returns the coordinates in the square [-1, 1]²; `v` runs downward on the right side.
    fn square(&self, at: Within) -> [f64; 2] {
        [2.0 * at.u - 1.0, (2.0 * at.v - 1.0) * self.side.sign()]
    }

    /// Returns the relative radius of a point of the eye, and its height.
    fn ring(at: Within, square: f64) -> [f64; 2] {
        let level = at.t * (RINGS.len() - 1) as f64;
        let [radius, height] = RINGS[level.round() as usize];
        let dome = if at.t == 1.0 { (PUPIL - height) * (1.0 - square * square) } else { 0.0 };
        [radius, height + dome]
    }
}

impl Shape for Eye {
    fn place(&self, at: Within) -> DVec3 {
        let [a, b] = self.square(at);
        let [radius, height] = Self::ring(at, a.abs().max(b.abs()));
        let [along, turn] = on_disc(a * radius, b * radius, &self.site);
        let (dx, dy) = (1e-3, 1e-3);
        let skin = body::point(along, turn);
        let across =
            (body::point(along + dx, turn) - skin).cross(body::point(along, turn + dy) - skin);
        let point = skin + height * across.normalize();
        DVec3::new(point.x, point.y, point.z * self.side.sign())
    }

    fn look(&self, at: Within, quad: Within) -> (Chart, Spot) {
        let [a, b] = self.square(at);
        let square = a.abs().max(b.abs());
        let [radius, _] = Self::ring(at, square);
        let round = if square == 0.0 { 0.0 } else { radius * square / a.hypot(b) };
        let color = match quad.t {
            t if t < 0.5 => DVec3::new(0.02, 0.05, 0.13),
            t if t < 1.0 => DVec3::new(1.0, 0.80, 0.28),
            _ => DVec3::new(0.01, 0.01, 0.02),
        };
        let uv = [0.5 + 0.5 * a * round, 0.5 + 0.5 * b * round];
        let cell = if self.side == Side::Left { 0 } else { 1 };
        (Chart { cell, uv }, Spot { position: self.place(at), color })
    }
}
