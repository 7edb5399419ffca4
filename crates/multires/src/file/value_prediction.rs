//! Prediction of attribute values from those around a vertex that is split, and above it.

use glam::{DVec2, DVec3, Vec3};
use meshlod_mesh::LayerKind;
use meshlod_mesh::octahedral::{project, unfold};

use super::layer_coding::{LayerCoding, Numbers};
use super::octahedral_plane::{OctahedralPlane, Place};
use super::slope::Slope;
use crate::cut::StarFace;
use crate::forest::NONE;
use crate::implicit::Implicit;

/// Number of ancestors by whose siblings values are predicted, the weight of the first, where that of
/// a step to a wedge around is 1, and the weight of each relative to the one before.
///
/// They decide where those around are in a row or missing: bytes per wedge of flight-helmet and duck
/// are 5.95 and 5.18 without them, 5.70 and 5.03 with 1/32, and 5.71 and 5.07 with 1/4.
const ANCESTORS: usize = 6;
const ABOVE: f64 = 1.0 / 32.0;
const FADE: f64 = 0.5;
/// Weight of a step between two wedges around: without them, and with .3 and 1, bytes per wedge of duck,
/// fish-bream and flight-helmet are 4.75 4.01 5.66, 4.71 3.98 5.66 and 4.69 3.96 5.69.
const ALONG: f64 = 0.25;
/// Weight of the step from the parent to the first child, which leads on to the second: all three are
/// mostly on a line.
const OWN: f64 = 8.0;
/// Greatest number of faces around a vertex from which values are predicted, so that a file with hubs
/// of many wedges is read in linear time.
const MOST_AROUND: usize = 64;

/// Length of a step along a line, short enough not to leave it.
const STEP: f64 = 1.0 / 64.0;

/// Line in the plane of the unfolded octahedron, near which places mostly are.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Line {
    /// Coordinate that grows faster.
    axis: usize,
    /// By how much the other one grows with it.
    slope: f64,
}

impl Line {
    fn along(way: DVec2) -> Self {
        let axis = usize::from(way.y.abs() > way.x.abs());
        let slope = way[1 - axis] / way[axis];
        Self { axis, slope: if slope.is_finite() { slope } else { 0.0 } }
    }

    /// Encodes a step as its coordinate along the line and by how much the other is off it.
    pub(super) fn encode(self, step: Place) -> Place {
        let along = step[self.axis];
        [along, step[1 - self.axis].wrapping_sub(self.across(along))]
    }

    /// Decodes a step that [`encode`](Self::encode) has encoded.
    pub(super) fn decode(self, [along, off]: Place) -> Place {
        let across = off.wrapping_add(self.across(along));
        if self.axis == 0 { [along, across] } else { [across, along] }
    }

    fn across(self, along: i32) -> i32 {
        (self.slope * f64::from(along)).round() as i32
    }
}

/// Slopes from which the values of a pair are predicted.
#[derive(Default)]
pub(super) struct PairSlopes {
    /// Slope of the difference, from all that is known.
    pub(super) difference: Slope,
    /// Slope of the wedges around alone. The parent's own value does not matter for it, so it tells
    /// by how much that is off before it is rounded.
    pub(super) ring: Slope,
}

/// Relations of a wedge.
#[derive(Clone, Copy)]
pub(super) struct Kin {
    pub(super) node: u32,
    pub(super) parent: u32,
    /// Wedge of the other child that has the same parent, or [`NONE`].
    pub(super) sibling: u32,
}

/// Columns of a layer.
#[derive(Clone, Copy, Debug)]
pub(super) struct LayerColumns {
    pub(super) start: usize,
    pub(super) end: usize,
    /// Bits of directions, in the first two columns.
    pub(super) directions: Option<u8>,
    pub(super) kind: LayerKind,
}

impl LayerColumns {
    /// Returns the columns of each layer, in the order in which values are predicted: each by those
    /// before.
    pub(super) fn of(coding: &[LayerCoding]) -> Vec<Self> {
        let mut end = 0;
        let columns = |layer: &LayerCoding| {
            let start = end;
            end += layer.columns();
            let directions = match layer.numbers {
                Numbers::Directions(bits) => Some(bits),
                _ => None,
            };
            Self { start, end, directions, kind: layer.kind }
        };
        let mut all: Vec<Self> = coding.iter().map(columns).collect();
        all.sort_by_key(|layer| layer.kind == LayerKind::Tangent);
        all
    }

    /// Returns the columns that are numbers of their own, and not of a direction.
    pub(super) fn plain(&self) -> std::ops::Range<usize> {
        self.start + if self.directions.is_some() { 2 } else { 0 }..self.end
    }
}

/// Values and relations of all wedges of a model.
pub(super) struct Known<'m> {
    pub(super) mt: &'m Implicit,
    /// Integers, a row for each wedge.
    pub(super) rows: Vec<i32>,
    pub(super) columns: usize,
    pub(super) kin: Vec<Kin>,
    /// Columns of the normals, and their bits.
    pub(super) normals: Option<(usize, u8)>,
}

impl Known<'_> {
    pub(super) fn row(&self, wedge: u32) -> &[i32] {
        &self.rows[wedge as usize * self.columns..][..self.columns]
    }

    pub(super) fn place(&self, wedge: u32) -> DVec3 {
        let node = self.kin[wedge as usize].node;
        Vec3::from(self.mt.stored_position(node)).as_dvec3()
    }

    /// Returns the way from the second wedge to the first.
    fn way(&self, [to, from]: [u32; 2]) -> DVec3 {
        self.place(to) - self.place(from)
    }

    /// Fits a slope to the steps around a wedge that is split, and above it; with a child, also to
    /// the step to that.
    pub(super) fn fit(&self, wedge: u32, child: Option<u32>, star: &[StarFace], slope: &mut Slope) {
        slope.clear();
        if let Some(child) = child {
            slope.add(self.way([child, wedge]), [child, wedge], OWN);
        }
        let star = if star.len() <= MOST_AROUND { star } else { &[] };
        let own = || star.iter().filter(|face| face.own == wedge);
        for face in own() {
            let [a, b] = face.others;
            slope.add(self.way([b, a]), [b, a], ALONG);
            slope.add(self.way([a, wedge]), [a, wedge], 1.0);
            if own().all(|other| other.others[0] != b) {
                slope.add(self.way([b, wedge]), [b, wedge], 1.0);
            }
        }
        let (mut at, mut weight) = (wedge, ABOVE);
        for _ in 0..ANCESTORS {
            let Kin { parent, sibling, .. } = self.kin[at as usize];
            if sibling != NONE {
                slope.add(self.way([at, sibling]), [at, sibling], weight);
                weight *= FADE;
            }
            if parent == NONE {
                break;
            }
            at = parent;
        }
        slope.fit();
    }

    /// Fits the slopes of a pair's values to the steps around its parent.
    pub(super) fn fit_pair(&self, parent: u32, star: &[StarFace], slopes: &mut PairSlopes) {
        self.fit(parent, None, star, &mut slopes.difference);
        self.fit_ring(parent, star, &mut slopes.ring);
    }

    /// Fits a slope to the steps between the wedges around one that is split, along the faces that use
    /// it, but not to its own values.
    pub(super) fn fit_ring(&self, wedge: u32, star: &[StarFace], slope: &mut Slope) {
        slope.clear();
        let star = if star.len() <= MOST_AROUND { star } else { &[] };
        for face in star.iter().filter(|face| face.own == wedge) {
            let [a, b] = face.others;
            slope.add(self.way([b, a]), [b, a], 1.0);
        }
        slope.fit();
    }

    /// Returns by how much a column changes along a way.
    pub(super) fn change(&self, slope: &Slope, way: DVec3, column: usize) -> i32 {
        let at = |wedge: u32| f64::from(self.rows[wedge as usize * self.columns + column]);
        let steps = slope.parts(way).map(|(part, [to, from])| part * (at(to) - at(from)));
        steps.sum::<f64>().round() as i32
    }

    /// Returns the line along which directions mostly differ from that of a wedge: tangents turn about
    /// the normal.
    pub(super) fn line(&self, wedge: u32, layer: &LayerColumns, bits: u8) -> Line {
        let at = self.direction(wedge, layer.start, bits);
        let across = match self.normals {
            Some((start, bits)) if layer.kind == LayerKind::Tangent => {
                self.direction(wedge, start, bits).cross(at)
            }
            _ => return Line::default(),
        };
        let place = |at: DVec3| DVec2::from(project(at, bits.into()));
        Line::along(place(at + STEP * across) - place(at))
    }

    /// Returns the code of a direction.
    pub(super) fn code(&self, wedge: u32, start: usize) -> Place {
        let row = self.row(wedge);
        [row[start], row[start + 1]]
    }

    fn direction(&self, wedge: u32, start: usize, bits: u8) -> DVec3 {
        // Only damaged data is out of range.
        let at = self.code(wedge, start).map(|x| x.clamp(0, (1 << bits) - 1) as u32);
        unfold(at, bits.into())
    }

    /// Predicts the places of the directions of wedges, near to that of another wedge from which the
    /// slope leads to them. Tangents are across their wedges' normals, which are known already.
    pub(super) fn directions_at<const N: usize>(
        &self,
        slope: &Slope,
        (wedges, from): ([u32; N], u32),
        layer: &LayerColumns,
        bits: u8,
    ) -> [Place; N] {
        let start = self.direction(from, layer.start, bits);
        let of = |wedge: u32| match wedge == from {
            true => start,
            false => self.direction(wedge, layer.start, bits),
        };
        let mut all = [start; N];
        let mut parts = wedges.map(|wedge| slope.parts(self.way([wedge, from])));
        for [to, end] in slope.ends() {
            let change = of(to) - of(end);
            for (at, parts) in all.iter_mut().zip(&mut parts) {
                *at += parts.next().map_or(0.0, |(part, _)| part) * change;
            }
        }
        std::array::from_fn(|k| {
            let mut at = all[k];
            if layer.kind == LayerKind::Tangent
                && let Some((start, bits)) = self.normals
            {
                let normal = self.direction(wedges[k], start, bits);
                at -= at.dot(normal) * normal;
            }
            let is_clear = at.length_squared() > 1e-6;
            let at = project(if is_clear { at } else { start }, bits.into());
            let place = at.map(|x| x.round() as i32);
            OctahedralPlane::new(bits).near(place, self.code(from, layer.start))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_along_a_line_are_nothing_across_it() {
        let line = Line::along(DVec2::new(1.0, -3.0));
        assert_eq!(line.encode([4, -12]), [-12, 0]);
        for step in [[0, 0], [5, 7], [-9, 2], [i32::MAX, i32::MIN]] {
            assert_eq!(line.decode(line.encode(step)), step);
            assert_eq!(Line::default().encode(step), step);
        }
        for none in [DVec2::ZERO, DVec2::NAN] {
            assert_eq!(Line::along(none).encode([3, 4]), [3, 4]);
        }
    }
}
