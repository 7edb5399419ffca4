//! Axis-aligned bounding boxes.

use glam::DVec3;

/// Axis-aligned bounding box, empty (`min` above `max`) until a point is added.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Corner of the box with the smallest coordinates.
    pub min: [f64; 3],
    /// Corner of the box with the largest coordinates.
    pub max: [f64; 3],
}

impl Default for Bounds {
    fn default() -> Self {
        Self::EMPTY
    }
}

/// Writes the corners as `min` and `max`, and an empty box as nothing.
#[cfg(feature = "serde")]
impl serde::Serialize for Bounds {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.is_empty() {
            true => serializer.serialize_none(),
            false => serializer.collect_map([("min", self.min), ("max", self.max)]),
        }
    }
}

impl Bounds {
    /// Empty box, which contains no point.
    pub const EMPTY: Self = Self { min: [f64::INFINITY; 3], max: [f64::NEG_INFINITY; 3] };

    /// Returns the smallest axis-aligned box that contains all the points.
    pub fn of<'a>(points: impl IntoIterator<Item = &'a [f64; 3]>) -> Self {
        let mut bounds = Self::EMPTY;
        for &point in points {
            bounds.add(point);
        }
        bounds
    }

    /// Extends the box to contain `point`.
    #[inline]
    pub fn add(&mut self, point: [f64; 3]) {
        // Comparisons: `f64::min` checks both sides for NaN, five instructions instead of one.
        for (axis, x) in point.into_iter().enumerate() {
            let (min, max) = (self.min[axis], self.max[axis]);
            self.min[axis] = if x < min { x } else { min };
            self.max[axis] = if x > max { x } else { max };
        }
    }

    /// Extends the box to contain the box `other`.
    #[inline]
    pub fn merge(&mut self, other: &Self) {
        for axis in 0..3 {
            self.min[axis] = self.min[axis].min(other.min[axis]);
            self.max[axis] = self.max[axis].max(other.max[axis]);
        }
    }

    /// Returns true if the box contains no point.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.min[0] > self.max[0]
    }

    /// Returns the center of the box, or the origin if the box is empty.
    pub fn center(&self) -> [f64; 3] {
        if self.is_empty() {
            return [0.0; 3];
        }
        (DVec3::from(self.min) * 0.5 + DVec3::from(self.max) * 0.5).into()
    }

    /// Returns the length of the box's diagonal in model units, or 0 if the box is empty.
    pub fn diagonal(&self) -> f64 {
        if self.is_empty() {
            return 0.0;
        }
        (DVec3::from(self.max) - DVec3::from(self.min)).length()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn diagonal_of_a_unit_cube() {
        let cube = Bounds::of(&[[0.0, 0.0, 1.0], [1.0, 1.0, 0.0]]);
        assert_eq!((cube.diagonal(), cube.center()), (3f64.sqrt(), [0.5; 3]));
    }

    #[test]
    fn the_empty_box_has_no_extent() {
        assert_eq!((Bounds::EMPTY.diagonal(), Bounds::EMPTY.center()), (0.0, [0.0; 3]));
    }
}
