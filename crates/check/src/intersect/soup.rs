//! The triangle soup that is searched for intersections: corners merged by position, and
//! coordinates scaled so that they cannot overflow.

use std::borrow::Cow;
use std::ops::Range;

use glam::DVec3;
use meshlod_mesh::{Connectivity, FaceId, VertexId};

use super::exact::projection_axis;
use super::triangle_pair::Triangle;
use crate::{Objects, UniquePositions};

/// Input of a search for intersecting faces.
#[derive(Clone, Copy)]
pub(crate) struct SearchInput<'a> {
    pub(crate) positions: &'a [[f64; 3]],
    /// Faces to search. An excluded face repeats a vertex; all others have finite positions.
    pub(crate) faces: &'a [[VertexId; 3]],
    /// Connectivity of these faces.
    pub(crate) connectivity: &'a Connectivity,
    pub(crate) unique: &'a UniquePositions,
    pub(crate) objects: &'a Objects,
}

/// Faces whose corners are merged by position: of the vertices at one position, the lowest stands
/// for all.
pub(crate) struct TriangleSoup<'a> {
    pub(crate) corners: Cow<'a, [[VertexId; 3]]>,
    pub(crate) positions: ScaledPositions<'a>,
}

impl<'a> TriangleSoup<'a> {
    pub(crate) fn of(input: &SearchInput<'a>) -> Self {
        let corners = match input.unique.duplicates().next() {
            None => Cow::Borrowed(input.faces),
            Some(_) => input.faces.iter().map(|face| merged_corners(face, input.unique)).collect(),
        };
        let positions = ScaledPositions::of(input.positions, &corners);
        Self { corners, positions }
    }

    #[inline]
    pub(crate) fn triangle(&self, face: FaceId) -> Triangle {
        self.positions.triangle(self.corners[face.index()])
    }

    /// Returns true if a face takes part in the search: its corners are at three positions and it
    /// has an area.
    pub(crate) fn counts(&self, face: FaceId) -> bool {
        has_distinct_corners(&self.corners[face.index()])
            && projection_axis(&self.triangle(face)).is_some()
    }
}

/// Returns true if a face has three different corners.
#[inline]
pub(crate) fn has_distinct_corners(&[a, b, c]: &[VertexId; 3]) -> bool {
    a != b && b != c && c != a
}

fn merged_corners(face: &[VertexId; 3], unique: &UniquePositions) -> [VertexId; 3] {
    if has_distinct_corners(face) { face.map(|v| unique.representative(v)) } else { *face }
}

/// Positions scaled by a power of two if their products would leave the range of `f64`.
///
/// Their determinants are exact as long as no nonzero coordinate is less than 1e-88 of the
/// greatest: coordinates are then multiples of 2^-358, and products of three are multiples of
/// 2^-1074, the least positive `f64`.
#[derive(Clone, Copy)]
pub(crate) struct ScaledPositions<'a> {
    positions: &'a [[f64; 3]],
    scale: f64,
}

/// Range of the greatest coordinate that needs no scaling: products of three coordinates neither
/// overflow nor, down to 1e-88 of it, underflow.
const FITTING: Range<f64> = 1e-3..1e60;

impl<'a> ScaledPositions<'a> {
    pub(crate) fn of(positions: &'a [[f64; 3]], corners: &[[VertexId; 3]]) -> Self {
        let size = |p: &[f64; 3]| DVec3::from(*p).abs().max_element();
        let fits = |size: f64| size == 0.0 || FITTING.contains(&size);
        if fits(positions.iter().map(size).fold(0.0, f64::max)) {
            return Self { positions, scale: 1.0 };
        }
        // Vertices that no face uses may be anywhere.
        let used = corners.iter().filter(|face| has_distinct_corners(face)).flatten();
        let greatest = used.map(|v| size(&positions[v.index()])).fold(0.0, f64::max);
        let exponent = if fits(greatest) { 0.0 } else { -greatest.log2().floor() };
        Self { positions, scale: 2f64.powi(exponent.clamp(-1022.0, 1022.0) as i32) }
    }

    /// Multiplies all positions by a given scale.
    pub(crate) fn new(positions: &'a [[f64; 3]], scale: f64) -> Self {
        Self { positions, scale }
    }

    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    #[inline]
    pub(crate) fn at(&self, vertex: VertexId) -> DVec3 {
        DVec3::from(self.positions[vertex.index()]) * self.scale
    }

    #[inline]
    pub(crate) fn triangle(&self, [a, b, c]: [VertexId; 3]) -> Triangle {
        [self.at(a), self.at(b), self.at(c)]
    }

    /// Converts a scaled point to model coordinates.
    pub(crate) fn unscaled(&self, point: [f64; 3]) -> [f64; 3] {
        point.map(|x| x / self.scale)
    }

    /// Converts a scaled length to model units.
    pub(crate) fn unscaled_length(&self, length: f64) -> f64 {
        length / self.scale
    }
}
