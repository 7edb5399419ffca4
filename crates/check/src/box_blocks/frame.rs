//! Translated and scaled coordinates in which boxes can be rounded to `f32`.

use glam::DVec3;
use meshlod_mesh::Frame;

use super::{BoxF32, Corners};

/// Maps boxes to coordinates of magnitude about 1, centred at the median of a sample of their
/// centres.
#[derive(Clone, Copy, Debug)]
pub(super) struct FloatFrame {
    frame: Frame,
}

/// Coordinates beyond this are clamped: sums of two of them still fit an `f32`.
const FARTHEST: f64 = 1e30;

impl FloatFrame {
    /// Boxes sampled for the median, far more than it needs to be stable.
    const SAMPLES: usize = 101;

    pub(super) fn of(count: usize, corners: &impl Fn(u32) -> Corners) -> Self {
        if count == 0 {
            return Self { frame: Frame::new(DVec3::ZERO, 0) };
        }
        let samples = Self::SAMPLES.min(count);
        let centers: Vec<DVec3> =
            (0..samples).map(|i| center(corners((i * count / samples) as u32))).collect();
        let median = |axis: usize| {
            let mut along: Vec<f64> = centers.iter().map(|p| p[axis]).collect();
            along.sort_unstable_by(f64::total_cmp);
            along[samples / 2]
        };
        let origin = DVec3::new(median(0), median(1), median(2));
        let size = |p: DVec3| (p * 0.5 - origin * 0.5).abs().max_element();
        let mut far = centers.into_iter().map(size).fold(0.0, f64::max);
        if far == 0.0 {
            far = (0..count as u32).flat_map(corners).map(size).fold(0.0, f64::max);
        }
        let exponent = if far > 0.0 { far.log2().floor() } else { 0.0 };
        Self { frame: Frame::new(origin, exponent.clamp(-1000.0, 1000.0) as i32) }
    }

    /// Converts a box to `f32`. Rounding is monotone, so boxes that overlap still do.
    #[inline]
    pub(super) fn rounded(&self, [lo, hi]: Corners) -> BoxF32 {
        BoxF32 { lo: self.local(lo).as_vec3(), hi: self.local(hi).as_vec3() }
    }

    #[inline]
    fn local(&self, p: DVec3) -> DVec3 {
        self.frame.local(p).clamp(DVec3::splat(-FARTHEST), DVec3::splat(FARTHEST))
    }
}

/// Returns the centre of a box without overflow.
fn center([lo, hi]: Corners) -> DVec3 {
    lo * 0.5 + hi * 0.5
}
