//! Body and tail fin of the fish: outline, cross-sections, colours.

use glam::DVec3;

use super::patch::Spot;
use super::radians;

/// Side of the fish.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Left,
    Right,
}

impl Side {
    /// Returns the sign of z: +1 on the left, -1 on the right.
    pub fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }
}

/// A block of the grid on the left side, and the size it is bent to, as (along, turns).
#[derive(Clone, Copy, Debug)]
pub(super) struct Site {
    pub middle: [f64; 2],
    /// Half the size of the block in the undistorted grid.
    pub half: [f64; 2],
    /// Half the size it is bent to.
    pub open: [f64; 2],
}

impl Site {
    /// Returns a point of the bent block, with both coordinates in [-1, 1].
    pub fn at(&self, a: f64, b: f64) -> [f64; 2] {
        [self.middle[0] + a * self.open[0], self.middle[1] + b * self.open[1]]
    }
}

/// Blocks that the grid bends for on the left; the right side mirrors them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sites {
    pub eye: Site,
    pub pectoral: Site,
    pub pelvic: Site,
}

/// Coordinate along the body where the tail fin begins.
pub(super) const TAIL: f64 = 0.78;

/// A cross-section: heights above and below the axis, and half the width.
struct Section {
    top: f64,
    bottom: f64,
    width: f64,
}

/// Cross-sections of the body: along, top, bottom, width.
const OUTLINE: [[f64; 4]; 11] = [
    [0.00, 0.030, 0.050, 0.034],
    [0.03, 0.100, 0.110, 0.074],
    [0.08, 0.190, 0.170, 0.108],
    [0.15, 0.295, 0.235, 0.140],
    [0.25, 0.390, 0.305, 0.164],
    [0.36, 0.430, 0.345, 0.170],
    [0.48, 0.400, 0.340, 0.150],
    [0.60, 0.285, 0.255, 0.108],
    [0.70, 0.150, 0.145, 0.064],
    [TAIL, 0.098, 0.098, 0.036],
    [1.00, 0.400, 0.400, 0.007],
];

/// Interpolates the cross-section by cubics through the outline.
fn section(along: f64) -> Section {
    let last = OUTLINE.len() - 1;
    let k = OUTLINE[1..last].iter().take_while(|row| row[0] <= along).count();
    let (a, b) = (&OUTLINE[k], &OUTLINE[k + 1]);
    let span = b[0] - a[0];
    let t = ((along - a[0]) / span).clamp(0.0, 1.0);
    let slope = |k: usize, column: usize| {
        let (before, after) = (&OUTLINE[k.saturating_sub(1)], &OUTLINE[(k + 1).min(last)]);
        (after[column] - before[column]) / (after[0] - before[0])
    };
    let column = |column: usize| {
        let rise = b[column] - a[column];
        let (m, n) = (slope(k, column) * span, slope(k + 1, column) * span);
        a[column] + t * (m + t * (3.0 * rise - 2.0 * m - n + t * (m + n - 2.0 * rise)))
    };
    Section { top: column(1), bottom: column(2), width: column(3) }
}

/// Returns the point of the body at `along` (0 lips, 1 tail's end) and `turn` (0 belly, ¼ left, ½
/// back).
pub(super) fn point(along: f64, turn: f64) -> DVec3 {
    let (sin, cos) = radians(turn).sin_cos();
    let Section { top, bottom, width } = section(along);
    let height = if cos < 0.0 { top } else { bottom };
    let tail = ((along - TAIL) / (1.0 - TAIL)).max(0.0);
    // The rays of the tail spread: the outer ones reach farther back, which makes it forked.
    let fork = 0.2 * tail * tail * (cos.abs().powf(1.6) - 0.55);
    DVec3::new(-1.0 + 1.9 * along + fork, -height * cos, width * sin)
}

/// Distance within which the grid bends around a block, in half sizes of the block.
const REACH: f64 = 2.4;

/// Bends a point of the grid: blocks of eyes become discs, those of fins become slits.
fn bend(along: f64, turn: f64, sites: &Sites) -> [f64; 2] {
    let right = turn > 0.5;
    let left = [along, if right { 1.0 - turn } else { turn }];
    let mut bent = left;
    let mut pull = |site: &Site, target: &dyn Fn(f64, f64) -> [f64; 2]| {
        let [a, b] = [0, 1].map(|k| (left[k] - site.middle[k]) / site.half[k]);
        let near = 1.0 - step(1.0, REACH, a.abs().max(b.abs()));
        // Nothing crosses the lines of belly and back, where the sides meet.
        let near = near * step(0.0, 0.03, left[1]) * step(0.0, 0.03, 0.5 - left[1]);
        if near > 0.0 {
            let target = target(a, b);
            bent = [0, 1].map(|k| bent[k] + near * (target[k] - left[k]));
        }
    };
    pull(&sites.eye, &|a, b| super::eye::on_disc(a, b, &sites.eye));
    pull(&sites.pectoral, &|a, b| sites.pectoral.at(a, b));
    pull(&sites.pelvic, &|a, b| sites.pelvic.at(a, b));
    [bent[0], if right { 1.0 - bent[1] } else { bent[1] }]
}

/// Returns a point of the skin with its colour.
pub(super) fn skin(along: f64, turn: f64, sites: &Sites) -> Spot {
    let [along, turn] = bend(along, turn, sites);
    Spot { position: point(along, turn), color: color(along, turn) }
}

/// Returns a point inside the mouth; ring 0 is the innermost.
pub(super) fn mouth(ring: usize, turn: f64) -> Spot {
    let depth = [0.075, 0.02][ring];
    let narrow = [0.55, 0.8][ring];
    let lips = point(0.0, turn);
    let position = DVec3::new(lips.x + depth, lips.y * narrow, lips.z * narrow);
    Spot { position, color: DVec3::new(0.25, 0.05, 0.06) }
}

const BACK: DVec3 = DVec3::new(0.04, 0.16, 0.42);
const FLANK: DVec3 = DVec3::new(0.07, 0.52, 0.74);
const BELLY: DVec3 = DVec3::new(0.93, 0.95, 0.86);
const BAR: DVec3 = DVec3::new(0.03, 0.07, 0.20);
const LIPS: DVec3 = DVec3::new(0.95, 0.62, 0.38);
/// Colour of fins at the root.
pub(super) const FIN_ROOT: DVec3 = DVec3::new(0.98, 0.55, 0.08);
/// Colour of fins at the rim.
pub(super) const FIN_RIM: DVec3 = DVec3::new(1.0, 0.86, 0.30);

fn color(along: f64, turn: f64) -> DVec3 {
    // 0 at the belly, 1 at the back.
    let up = 0.5 - 0.5 * radians(turn).cos();
    let skin = BELLY.lerp(FLANK, step(0.12, 0.42, up)).lerp(BACK, step(0.55, 0.95, up));
    let bar = |middle: f64, half: f64| 1.0 - step(0.4 * half, half, (along - middle).abs());
    // Bars lean forward towards the belly, and fade there.
    let lean = 0.05 * (up - 0.5);
    let bars = bar(0.30 + lean, 0.045).max(bar(0.46 + lean, 0.05)).max(bar(0.62 + lean, 0.045));
    let gill = 0.5 * bar(0.205 - 0.06 * (up - 0.45) * (up - 0.45), 0.022);
    let skin = skin.lerp(BAR, (0.85 * bars * step(0.1, 0.4, up)).max(gill));
    let skin = skin.lerp(LIPS, 1.0 - step(0.0, 0.035, along));
    let tail = FIN_ROOT.lerp(FIN_RIM, step(TAIL, 1.0, along));
    skin.lerp(tail, step(TAIL - 0.08, TAIL + 0.02, along))
}

/// Smoothstep: 0 below `low`, 1 above `high`.
pub(super) fn step(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
