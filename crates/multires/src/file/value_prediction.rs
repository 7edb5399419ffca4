//! Prediction of attribute values from those around a vertex that is split, and above it.

use std::ops::Range;

use glam::{DVec2, DVec3, Vec3};
use meshlod_mesh::LayerKind;
use meshlod_mesh::octahedral::{project, unfold};

use super::fixed_order::{cross, dot};
use super::layer_coding::{LayerCoding, Numbers};
use super::octahedral_plane::{OctahedralPlane, Place};
use super::slope::Slopes;
use crate::cut::StarFace;
use crate::forest::NONE;

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

/// Greatest number of columns that are predicted together.
const TOGETHER: usize = 4;

/// Length of a step along a line, short enough not to leave it.
const STEP: f64 = 1.0 / 64.0;

/// Line in the plane of the unfolded octahedron, near which places mostly are.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Line {
    /// Coordinate that grows faster.
    axis: usize,
    /// Slope of the other coordinate.
    slope: f64,
}

impl Line {
    fn along(way: DVec2) -> Self {
        let axis = usize::from(way.y.abs() > way.x.abs());
        let slope = way[1 - axis] / way[axis];
        Self { axis, slope: if slope.is_finite() { slope } else { 0.0 } }
    }

    /// Encodes a step as its coordinate along the line and the offset of the other from it.
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

/// Place of a wedge, and its relations as far as they are known.
#[derive(Clone, Copy)]
pub(super) struct Kin {
    pub(super) place: Vec3,
    /// Wedge at the node above, or [`NONE`].
    pub(super) parent: u32,
    /// Wedge of the other child that has the same parent, or [`NONE`].
    pub(super) sibling: u32,
}

/// Columns of a layer.
#[derive(Clone, Copy, Debug)]
pub(super) struct LayerColumns {
    pub(super) start: usize,
    pub(super) end: usize,
    /// Directions, in the first two columns.
    pub(super) directions: Option<DirectionColumns>,
    pub(super) kind: LayerKind,
}

/// Two columns that are directions.
#[derive(Clone, Copy, Debug)]
pub(super) struct DirectionColumns {
    pub(super) start: usize,
    pub(super) bits: u8,
    /// Number among the layers of directions.
    number: usize,
}

impl DirectionColumns {
    pub(super) fn plane(self) -> OctahedralPlane {
        OctahedralPlane::new(self.bits)
    }
}

impl LayerColumns {
    /// Returns the columns of each layer, in the order in which values are predicted: each by those
    /// before.
    pub(super) fn of(coding: &[LayerCoding]) -> Vec<Self> {
        let (mut end, mut number) = (0, 0);
        let columns = |layer: &LayerCoding| {
            let start = end;
            end += layer.columns();
            let directions = match layer.numbers {
                Numbers::Directions(code) => {
                    Some(DirectionColumns { start, bits: code.bits() as u8, number })
                }
                _ => None,
            };
            number += usize::from(directions.is_some());
            Self { start, end, directions, kind: layer.kind }
        };
        let mut all: Vec<Self> = coding.iter().map(columns).collect();
        all.sort_by_key(|layer| layer.kind == LayerKind::Tangent);
        all
    }

    /// Returns the columns that do not belong to a direction, by ranges whose changes are computed
    /// together.
    pub(super) fn plain(&self) -> impl Iterator<Item = Range<usize>> + use<> {
        let Self { start, end, directions, .. } = *self;
        let starts = (start + if directions.is_some() { 2 } else { 0 }..end).step_by(TOGETHER);
        starts.map(move |start| start..end.min(start + TOGETHER))
    }
}

/// Values and relations of all wedges of a model.
pub(super) struct Known {
    /// Integers, a row for each wedge.
    pub(super) rows: Vec<i32>,
    pub(super) columns: usize,
    pub(super) kin: Vec<Kin>,
    /// Columns of the normals.
    normals: Option<DirectionColumns>,
    /// Directions that the codes in the rows stand for, of each layer of them, wedge by wedge.
    directions: Vec<DVec3>,
    direction_layers: usize,
}

impl Known {
    pub(super) fn new(layers: &[LayerColumns], rows: Vec<i32>, kin: Vec<Kin>) -> Self {
        let normals = layers.iter().find(|layer| layer.kind == LayerKind::Normal);
        let direction_layers = layers.iter().filter(|layer| layer.directions.is_some()).count();
        Self {
            rows,
            columns: layers.iter().map(|layer| layer.end).max().unwrap_or(0),
            directions: vec![DVec3::ZERO; kin.len() * direction_layers],
            direction_layers,
            kin,
            normals: normals.and_then(|layer| layer.directions),
        }
    }

    pub(super) fn row(&self, wedge: u32) -> &[i32] {
        &self.rows[wedge as usize * self.columns..][..self.columns]
    }

    /// Returns the least and the greatest number of each column.
    pub(super) fn ranges(&self) -> Vec<[i32; 2]> {
        let mut ranges = vec![[i32::MAX, i32::MIN]; self.columns];
        for row in self.rows.chunks_exact(self.columns.max(1)) {
            for ([low, high], &number) in ranges.iter_mut().zip(row) {
                (*low, *high) = ((*low).min(number), (*high).max(number));
            }
        }
        ranges
    }

    pub(super) fn place(&self, wedge: u32) -> DVec3 {
        self.kin[wedge as usize].place.as_dvec3()
    }

    /// Returns the way from the second wedge to the first.
    pub(super) fn way(&self, [to, from]: [u32; 2]) -> DVec3 {
        self.place(to) - self.place(from)
    }

    /// Fits slopes to the steps around a wedge that is split, and above it; with a child, also to the
    /// step to that.
    ///
    /// The slope of those around does not depend on the wedge's own values, so it gives their error
    /// before they are rounded.
    pub(super) fn fit(
        &self,
        wedge: u32,
        child: Option<u32>,
        star: &[StarFace],
        slopes: &mut Slopes,
    ) {
        slopes.clear();
        let own = slopes.add_wedge(wedge, self.place(wedge));
        if let Some(child) = child {
            let child = slopes.add_wedge(child, self.place(child));
            slopes.add_step([child, own], OWN);
        }
        self.add_around(wedge, star, slopes);
        self.add_above(wedge, slopes);
        slopes.fit();
    }

    /// Adds the steps to the wedges around one, the first that was added, and those between them.
    fn add_around(&self, wedge: u32, star: &[StarFace], slopes: &mut Slopes) {
        let star = if star.len() <= MOST_AROUND { star } else { &[] };
        let faces = || star.iter().filter(|face| face.own == wedge);
        let first = slopes.wedges().len();
        for face in faces() {
            slopes.add_wedge(face.others[0], self.place(face.others[0]));
        }
        for (a, face) in (first..).zip(faces()) {
            let other = face.others[1];
            let followed = faces().position(|face| face.others[0] == other);
            let b = match followed {
                Some(at) => first + at,
                None => slopes.add_wedge(other, self.place(other)),
            };
            slopes.add_step_around([b, a], ALONG);
            slopes.add_step([a, 0], 1.0);
            if followed.is_none() {
                slopes.add_step([b, 0], 1.0);
            }
        }
    }

    /// Adds the steps to the wedge that was added first, and to those above it, from their siblings.
    fn add_above(&self, wedge: u32, slopes: &mut Slopes) {
        let (mut at, mut end, mut weight) = (wedge, Some(0), ABOVE);
        for _ in 0..ANCESTORS {
            let Kin { parent, sibling, .. } = self.kin[at as usize];
            if sibling != NONE {
                let end = end.unwrap_or_else(|| slopes.add_wedge(at, self.place(at)));
                let sibling = slopes.add_wedge(sibling, self.place(sibling));
                slopes.add_step([end, sibling], weight);
                weight *= FADE;
            }
            if parent == NONE {
                break;
            }
            (at, end) = (parent, None);
        }
    }

    /// Returns the changes of the columns of a layer, given the shares of known wedges.
    pub(super) fn changes(
        &self,
        layer: &LayerColumns,
        columns: &Range<usize>,
        shares: impl Iterator<Item = (u32, f64)>,
    ) -> [i32; TOGETHER] {
        // The handedness of tangents has no slope.
        if layer.directions.is_some() {
            return [0; TOGETHER];
        }
        let mut sums = [0.0; TOGETHER];
        for (wedge, share) in shares {
            for (sum, &number) in sums.iter_mut().zip(&self.row(wedge)[columns.clone()]) {
                *sum += share * f64::from(number);
            }
        }
        sums.map(|sum| sum.round() as i32)
    }

    /// Returns the line along which directions mostly differ from that of a wedge: tangents turn about
    /// the normal.
    pub(super) fn line(
        &self,
        wedge: u32,
        layer: &LayerColumns,
        directions: DirectionColumns,
    ) -> Line {
        let at = self.direction(wedge, directions);
        let across = match self.normals {
            Some(normals) if layer.kind == LayerKind::Tangent => {
                cross(self.direction(wedge, normals), at)
            }
            _ => return Line::default(),
        };
        let place = |at: DVec3| DVec2::from(project(at, directions.bits.into()));
        Line::along(place(at + STEP * across) - place(at))
    }

    /// Returns the code of a direction.
    pub(super) fn code(&self, wedge: u32, directions: DirectionColumns) -> Place {
        let row = self.row(wedge);
        [row[directions.start], row[directions.start + 1]]
    }

    /// Replaces the code of a direction.
    pub(super) fn set_code(&mut self, wedge: u32, directions: DirectionColumns, code: Place) {
        let start = wedge as usize * self.columns + directions.start;
        self.rows[start..start + 2].copy_from_slice(&code);
        // Only damaged data is out of range.
        let at = code.map(|x| x.clamp(0, (1 << directions.bits) - 1) as u32);
        let number = wedge as usize * self.direction_layers + directions.number;
        self.directions[number] = unfold(at, directions.bits.into());
    }

    fn direction(&self, wedge: u32, DirectionColumns { number, .. }: DirectionColumns) -> DVec3 {
        self.directions[wedge as usize * self.direction_layers + number]
    }

    /// Predicts the places of the directions of wedges, near to that of another wedge, given the shares
    /// by which known wedges change it on the way there. Tangents are across their wedges' normals,
    /// which are known already.
    pub(super) fn directions_at<const N: usize>(
        &self,
        (wedges, from): ([u32; N], u32),
        layer: &LayerColumns,
        directions: DirectionColumns,
        shares: impl Iterator<Item = (u32, [f64; N])>,
    ) -> [Place; N] {
        let start = self.direction(from, directions);
        let mut all = [start; N];
        for (wedge, shares) in shares {
            let direction = self.direction(wedge, directions);
            (0..N).for_each(|k| all[k] += shares[k] * direction);
        }
        std::array::from_fn(|k| {
            let mut at = all[k];
            if let Some(normals) = self.normals.filter(|_| layer.kind == LayerKind::Tangent) {
                let normal = self.direction(wedges[k], normals);
                at -= dot(at, normal) * normal;
            }
            let is_clear = dot(at, at) > 1e-6;
            let at = project(if is_clear { at } else { start }, directions.bits.into());
            let place = at.map(|x| x.round() as i32);
            directions.plane().near(place, self.code(from, directions))
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
