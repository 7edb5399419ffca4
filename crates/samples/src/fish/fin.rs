//! Fins of the fish: thin curved sheets with two sides.

use glam::DVec3;

use super::body::{self, FIN_RIM, FIN_ROOT, Side, Site, Sites, step};
use super::patch::{Chart, Shape, Spot, Within};
use super::radians;

/// A fin that replaces a block of the grid.
pub(super) struct Fin {
    pub root: Root,
    /// Number of rows of quads from root to rim, at 32 quads around the body.
    pub levels: usize,
    /// Texture cell of the first side; the second side has the next one.
    cell: usize,
    kind: Kind,
}

/// Root of a fin, on the left side.
#[derive(Clone, Copy, Debug)]
pub(super) enum Root {
    /// Chord along the body: from, to, and the position around it.
    Along([f64; 2], f64),
    /// Chord around the body: the position along it, from and to.
    Around(f64, [f64; 2]),
}

/// Roots of the dorsal, anal, pectoral and pelvic fins.
const DORSAL: Root = Root::Along([0.27, 0.70], 0.5);
const ANAL: Root = Root::Along([0.50, 0.71], 0.0);
pub(super) const PECTORAL: Root = Root::Around(0.265, [0.15, 0.275]);
pub(super) const PELVIC: Root = Root::Along([0.33, 0.42], 0.085);

/// Half the size of the slit of a pectoral fin in the body, along and in turns.
pub(super) const PECTORAL_SLIT: [f64; 2] = [0.007, 0.03];
/// Half the size of the slit of a pelvic fin.
pub(super) const PELVIC_SLIT: [f64; 2] = [0.034, 0.008];

enum Kind {
    /// In the plane of symmetry, on the back or the belly: its height and backward sweep.
    Median { height: f64, sweep: f64 },
    /// One of a pair: its span and its chord at the rim, as vectors.
    Paired { side: Side, site: Site, span: DVec3, chord: DVec3 },
}

impl Fin {
    /// Returns all fins except the tail.
    pub fn all(sites: &Sites) -> Vec<Self> {
        let median = |root, levels, cell, height, sweep| {
            let kind = Kind::Median { height, sweep };
            Self { root, levels, cell, kind }
        };
        let mut fins = vec![median(DORSAL, 4, 2, 0.25, 0.55), median(ANAL, 3, 4, 0.23, 0.8)];
        for (side, cell) in [(Side::Left, 6), (Side::Right, 8)] {
            let span = DVec3::new(0.27, -0.05, 0.17 * side.sign());
            let chord = DVec3::new(0.10, 0.24, -0.03 * side.sign());
            let kind = Kind::Paired { side, site: sites.pectoral, span, chord };
            fins.push(Self { root: PECTORAL, levels: 5, cell, kind });
        }
        for (side, cell) in [(Side::Left, 10), (Side::Right, 12)] {
            let span = DVec3::new(0.17, -0.20, 0.07 * side.sign());
            let chord = DVec3::new(0.13, 0.07, 0.0);
            let kind = Kind::Paired { side, site: sites.pelvic, span, chord };
            fins.push(Self { root: PELVIC, levels: 4, cell, kind });
        }
        fins
    }

    /// Returns the side of the fin, left for median ones.
    pub fn side(&self) -> Side {
        match self.kind {
            Kind::Median { .. } => Side::Left,
            Kind::Paired { side, .. } => side,
        }
    }

    /// Converts a point of the block so that `u` runs along the chord and `v` across the sheet.
    fn local(&self, at: Within) -> Within {
        match (self.root, self.side()) {
            (Root::Along(..), _) => at,
            (Root::Around(..), Side::Left) => Within { u: at.v, v: at.u, ..at },
            (Root::Around(..), Side::Right) => Within { u: 1.0 - at.v, v: at.u, ..at },
        }
    }
}

/// Half the thickness at the root; the fin gets thinner towards the rim.
const THICKNESS: f64 = 0.011;

impl Fin {
    /// Returns a point of the center surface: `u` along the chord, `t` from root to rim.
    fn sheet(&self, u: f64, t: f64) -> DVec3 {
        match self.kind {
            Kind::Median { height, sweep } => self.median(u, t, height, sweep),
            Kind::Paired { side, site, span, chord } => {
                let on_skin = |a, b| {
                    let [along, turn] = site.at(a, b);
                    body::point(along, turn) * DVec3::new(1.0, 1.0, side.sign())
                };
                let middle = on_skin(0.0, 0.0);
                let root = match self.root {
                    Root::Along(..) => on_skin(2.0 * u - 1.0, 0.0),
                    Root::Around(..) => on_skin(0.0, 2.0 * u - 1.0),
                };
                // The rim is round: its middle rays are the longest.
                let ray = 1.0 - 0.3 * (2.0 * u - 1.0).powi(2) * t;
                let bow = DVec3::Z * side.sign() * 0.10 * t * (1.0 - t);
                let across = (root - middle).lerp(chord * (u - 0.5), step(-0.3, 0.9, t));
                middle + across + span * t * ray + bow
            }
        }
    }

    fn median(&self, u: f64, t: f64, height: f64, sweep: f64) -> DVec3 {
        let [along, turn] = match self.root {
            Root::Along([from, to], turn) => [from + u * (to - from), turn],
            Root::Around(along, [from, to]) => [along, from + u * (to - from)],
        };
        let root = body::point(along, turn);
        // Tall in front, low at the back, with a swing to a point at the very end.
        let rise = 0.18 + 0.82 * step(0.0, 0.28, u) * (1.0 - 0.45 * step(0.3, 0.9, u));
        let back = sweep * t * (0.35 + 0.65 * t) * (0.45 + 0.55 * u);
        root + t * height * rise * root.y.signum() * DVec3::Y + height * back * DVec3::X
    }

    /// Returns the unit vector across the sheet, in the direction of growing `v`.
    fn across(&self) -> DVec3 {
        match (&self.kind, self.root) {
            (Kind::Median { .. }, Root::Along(_, 0.5)) => DVec3::NEG_Z,
            (Kind::Median { .. }, _) => DVec3::Z,
            (Kind::Paired { span, chord, .. }, root) => {
                let across = span.cross(*chord).normalize();
                match root {
                    Root::Along(..) => across,
                    Root::Around(..) => across * across.x.signum(),
                }
            }
        }
    }
}

impl Shape for Fin {
    fn place(&self, at: Within) -> DVec3 {
        let at = self.local(at);
        // Thin at the rim and at both edges, but never zero.
        let round = 0.25 + 0.75 * (1.0 - (2.0 * at.u - 1.0).powi(4));
        let half = THICKNESS * round * (1.0 - 0.75 * at.t);
        self.sheet(at.u, at.t) + self.across() * half * (2.0 * at.v - 1.0)
    }

    fn look(&self, at: Within, quad: Within) -> (Chart, Spot) {
        let position = self.place(at);
        let (at, quad) = (self.local(at), self.local(quad));
        let rays = 0.06 * radians(6.0 * at.u).cos();
        let color = FIN_ROOT.lerp(FIN_RIM, step(0.1, 1.0, at.t)) * (1.0 + rays);
        let color = color.min(DVec3::ONE);
        // The narrow faces along the rims unfold next to the chart of their side.
        let fold = 0.06 * (1.0 - (2.0 * at.v - 1.0).abs());
        let u = match at.u {
            0.0 => -fold,
            1.0 => 1.0 + fold,
            u => u,
        };
        let t = if at.t == 1.0 { 1.0 + fold } else { at.t };
        let cell = self.cell + usize::from(quad.v > 0.5);
        let uv = [0.08 + 0.84 * u, 0.02 + 0.9 * t];
        (Chart { cell, uv }, Spot { position, color })
    }
}
