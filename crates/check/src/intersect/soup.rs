//! The faces as the search sees them: corners by place, coordinates that cannot overflow.

use std::borrow::Cow;
use std::ops::Range;

use glam::DVec3;
use meshlod_mesh::{Connectivity, FaceId, VertexId};

use super::exact::open_axis;
use super::meet::Triangle;
use crate::{Objects, Places};

/// What a search for meetings looks at.
#[derive(Clone, Copy)]
pub(crate) struct Ground<'a> {
    pub(crate) positions: &'a [[f64; 3]],
    /// A face that has no part repeats a vertex; all others name finite positions.
    pub(crate) faces: &'a [[VertexId; 3]],
    /// Of these faces.
    pub(crate) connectivity: &'a Connectivity,
    pub(crate) places: &'a Places,
    pub(crate) objects: &'a Objects,
}

/// Faces whose corners are places: vertices at one place are one.
pub(crate) struct Soup<'a> {
    pub(crate) corners: Cow<'a, [[VertexId; 3]]>,
    pub(crate) points: Points<'a>,
}

impl<'a> Soup<'a> {
    pub(crate) fn of(ground: &Ground<'a>) -> Self {
        let corners = match ground.places.doubles().next() {
            None => Cow::Borrowed(ground.faces),
            Some(_) => ground.faces.iter().map(|face| at_places(face, ground.places)).collect(),
        };
        let points = Points::of(ground.positions, &corners);
        Self { corners, points }
    }

    #[inline]
    pub(crate) fn triangle(&self, face: FaceId) -> Triangle {
        self.points.triangle(self.corners[face.index()])
    }

    /// Whether a face has a part: three places, and some area.
    pub(crate) fn counts(&self, face: FaceId) -> bool {
        whole(&self.corners[face.index()]) && open_axis(&self.triangle(face)).is_some()
    }
}

/// Whether a face has three different corners.
#[inline]
pub(crate) fn whole(&[a, b, c]: &[VertexId; 3]) -> bool {
    a != b && b != c && c != a
}

fn at_places(face: &[VertexId; 3], places: &Places) -> [VertexId; 3] {
    if whole(face) { face.map(|v| places.first(v)) } else { *face }
}

/// Positions, scaled by a power of two where their products would leave the range of `f64`.
///
/// Determinants of them are exact as long as no coordinate other than 0 is less than 1e-88 of the
/// greatest: coordinates are then multiples of 2^-358, and products of three of 2^-1074, the least
/// number there is.
#[derive(Clone, Copy)]
pub(crate) struct Points<'a> {
    positions: &'a [[f64; 3]],
    scale: f64,
}

/// Where the greatest coordinate needs no scaling: products of three do not overflow, nor do those
/// of what is 1e-88 of it underflow.
const FITTING: Range<f64> = 1e-3..1e60;

impl<'a> Points<'a> {
    pub(crate) fn of(positions: &'a [[f64; 3]], corners: &[[VertexId; 3]]) -> Self {
        let size = |p: &[f64; 3]| DVec3::from(*p).abs().max_element();
        let fits = |size: f64| size == 0.0 || FITTING.contains(&size);
        if fits(positions.iter().map(size).fold(0.0, f64::max)) {
            return Self { positions, scale: 1.0 };
        }
        // Only vertices of faces count; the others may be anywhere.
        let used = corners.iter().filter(|face| whole(face)).flatten();
        let greatest = used.map(|v| size(&positions[v.index()])).fold(0.0, f64::max);
        let exponent = if fits(greatest) { 0.0 } else { -greatest.log2().floor() };
        Self { positions, scale: 2f64.powi(exponent.clamp(-1022.0, 1022.0) as i32) }
    }

    /// The same points as those with this scale.
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

    /// A place found among these points, in model units.
    pub(crate) fn place(&self, place: [f64; 3]) -> [f64; 3] {
        place.map(|x| x / self.scale)
    }

    /// A length found among these points, in model units.
    pub(crate) fn length(&self, length: f64) -> f64 {
        length / self.scale
    }
}
