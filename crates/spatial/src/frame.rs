//! Local coordinates for computing: centred on a box, at a size near 1.

use glam::DVec3;
use meshlod_mesh::Bounds;

/// Local coordinates with the centre of a box at the origin and the box between -2 and 2, or -4 and
/// 4 at the very end of the range of `f64`.
///
/// The scale is a power of two, so scaling is exact. In local coordinates far-away and extremely
/// large or small meshes fit `f32` boxes, and fourth powers of lengths fit an `f64`.
#[derive(Clone, Copy, Debug)]
pub struct LocalFrame {
    origin: DVec3,
    scale: f64,
}

/// Bound on the exponent of the scale, which keeps the scale and its inverse finite and normal.
const MAX_EXPONENT: f64 = 1022.0;

impl LocalFrame {
    /// Returns the frame of a finite box; an empty or pointlike box keeps the model's units.
    pub fn of(bounds: &Bounds) -> Self {
        let half = DVec3::from(bounds.max) * 0.5 - DVec3::from(bounds.min) * 0.5;
        let half = half.max_element();
        let scale = if half > 0.0 {
            let exponent = -half.log2().floor();
            2f64.powi(exponent.clamp(-MAX_EXPONENT, MAX_EXPONENT) as i32)
        } else {
            1.0
        };
        Self { origin: bounds.center().into(), scale }
    }

    /// Returns the number of local units in a model unit, a power of two.
    #[inline]
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Converts a point of the model to local coordinates.
    #[inline]
    pub fn local(&self, point: [f64; 3]) -> DVec3 {
        (DVec3::from(point) - self.origin) * self.scale
    }

    /// Converts a local point to model coordinates.
    #[inline]
    pub fn model(&self, local: DVec3) -> [f64; 3] {
        (local / self.scale + self.origin).into()
    }

    /// Converts a squared length or an area from local to squared model units.
    #[inline]
    pub fn model_squared(&self, local: f64) -> f64 {
        local / self.scale / self.scale
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(min: f64, max: f64) -> LocalFrame {
        LocalFrame::of(&Bounds { min: [min; 3], max: [max; 3] })
    }

    #[test]
    fn every_finite_box_comes_to_a_size_near_one() {
        for (min, max) in
            [(-1.0, 1.0), (1e6, 1e6 + 1.0), (-1e308, 1e308), (0.0, 1e-200), (1e-5, 3e7)]
        {
            let corner = frame(min, max).local([max; 3]).x;
            assert!((0.99..2.3).contains(&corner), "{min} {max}: {corner}");
        }
    }

    #[test]
    fn a_point_comes_back() {
        let frame = frame(1e6, 1e6 + 3.0);
        let point = [1e6 + 0.125, 1e6 + 2.75, 1e6 + 1.0];
        assert_eq!(frame.model(frame.local(point)), point);
    }

    #[test]
    fn a_box_without_extent_keeps_its_units() {
        assert_eq!(frame(7.0, 7.0).local([9.0; 3]).x, 2.0);
    }
}
