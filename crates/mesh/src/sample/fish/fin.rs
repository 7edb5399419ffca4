//! Fins: thin curved sheets with two sides.

use glam::DVec3;

use super::body::{self, FIN_RIM, FIN_ROOT, Side, step};
use super::build::{Chart, Shape, Spot, Within};

/// A fin and where it stands.
pub(super) struct Fin {
    /// Its root along the body.
    pub along: [f64; 2],
    /// Its root around the body.
    pub turn: f64,
    /// Rows of quads from root to rim at 32 quads around the body.
    pub levels: usize,
    /// The first of the two charts that its sides take.
    cell: usize,
    kind: Kind,
}

enum Kind {
    /// On the back or below, in the plane of symmetry: height, and how far it sweeps back.
    Median { height: f64, sweep: f64 },
    /// One of a pair: its span as a vector on the left side, and its breadth at the rim.
    Paired { side: Side, span: [f64; 3], breadth: f64 },
}

/// All fins but the tail.
pub(super) fn all() -> Vec<Fin> {
    let mut fins = vec![
        Fin {
            along: [0.27, 0.70],
            turn: 0.5,
            levels: 4,
            cell: 2,
            kind: Kind::Median { height: 0.25, sweep: 0.55 },
        },
        Fin {
            along: [0.50, 0.71],
            turn: 0.0,
            levels: 3,
            cell: 4,
            kind: Kind::Median { height: 0.23, sweep: 0.8 },
        },
    ];
    for (side, cell) in [(Side::Left, 6), (Side::Right, 8)] {
        let (span, breadth) = ([0.27, -0.06, 0.17], 0.24);
        let kind = Kind::Paired { side, span, breadth };
        fins.push(Fin { along: [0.25, 0.325], turn: side.turn(0.215), levels: 4, cell, kind });
    }
    for (side, cell) in [(Side::Left, 10), (Side::Right, 12)] {
        let (span, breadth) = ([0.20, -0.24, 0.05], 0.13);
        let kind = Kind::Paired { side, span, breadth };
        fins.push(Fin { along: [0.33, 0.395], turn: side.turn(0.075), levels: 4, cell, kind });
    }
    fins
}

/// Half the thickness at the root; it thins towards the rim.
const THICKNESS: f64 = 0.011;

impl Fin {
    /// The middle of the sheet: `u` from its front to its back, `t` from root to rim.
    fn sheet(&self, u: f64, t: f64) -> DVec3 {
        let root = body::point(self.along[0] + u * (self.along[1] - self.along[0]), self.turn);
        match self.kind {
            Kind::Median { height, sweep } => {
                // Tall in front, low at the back, with a swing to a point at the very end.
                let rise = 0.18 + 0.82 * step(0.0, 0.28, u) * (1.0 - 0.45 * step(0.3, 0.9, u));
                let outward = root.y.signum();
                let back = sweep * t * (0.35 + 0.65 * t) * (0.45 + 0.55 * u);
                root + t * height * rise * DVec3::Y * outward + height * back * DVec3::X
            }
            Kind::Paired { side, span, breadth } => {
                let middle = body::point(0.5 * (self.along[0] + self.along[1]), self.turn);
                let span = DVec3::new(span[0], span[1], span[2] * side.sign());
                let across = self.chord();
                let spread = step(-0.3, 0.75, t);
                let swell = across * (u - 0.5) * breadth;
                // The rim is round: its middle rays are the longest.
                let ray = 1.0 - 0.32 * (2.0 * u - 1.0).powi(2) * t;
                let bow = DVec3::Z * side.sign() * 0.05 * t * (1.0 - t);
                (root - middle).lerp(swell, spread) + middle + span * t * ray + bow
            }
        }
    }

    /// The direction from a paired fin's front to its back at the rim.
    fn chord(&self) -> DVec3 {
        let Kind::Paired { side, span, .. } = self.kind else { return DVec3::X };
        let span = DVec3::new(span[0], span[1], span[2] * side.sign());
        let lift = DVec3::new(0.5, -0.85, -0.1 * side.sign());
        (lift - span * lift.dot(span) / span.length_squared()).normalize()
    }

    /// The unit vector across the sheet, towards greater `v`.
    fn across(&self) -> DVec3 {
        match self.kind {
            Kind::Median { .. } => DVec3::Z * if self.turn == 0.5 { -1.0 } else { 1.0 },
            Kind::Paired { side, span, .. } => {
                let span = DVec3::new(span[0], span[1], span[2] * side.sign());
                span.cross(self.chord()).normalize()
            }
        }
    }
}

impl Shape for Fin {
    fn place(&self, at: Within) -> DVec3 {
        // Thin at the rim and at both edges, nowhere nothing.
        let round = 0.25 + 0.75 * (1.0 - (2.0 * at.u - 1.0).powi(4));
        let half = THICKNESS * round * (1.0 - 0.75 * at.t);
        self.sheet(at.u, at.t) + self.across() * half * (2.0 * at.v - 1.0)
    }

    fn look(&self, at: Within, quad: Within) -> (Chart, Spot) {
        let rays = 0.06 * (radians_of_rays(at.u)).cos();
        let color = FIN_ROOT.lerp(FIN_RIM, step(0.1, 1.0, at.t)) * (1.0 + rays);
        let color = color.min(DVec3::ONE);
        // The narrow faces on the rims fold out beside their side's chart.
        let fold = 0.06 * (1.0 - (2.0 * at.v - 1.0).abs());
        let u = match at.u {
            0.0 => -fold,
            1.0 => 1.0 + fold,
            u => u,
        };
        let t = if at.t == 1.0 { 1.0 + fold } else { at.t };
        let cell = self.cell + usize::from(quad.v > 0.5);
        let uv = [0.08 + 0.84 * u, 0.02 + 0.9 * t];
        (Chart { cell, uv }, Spot { position: self.place(at), color })
    }
}

/// Rays from the root to the rim, as an angle.
fn radians_of_rays(u: f64) -> f64 {
    super::radians(6.0 * u)
}
