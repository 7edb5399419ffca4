//! Scores of an arm over its bias, and the triangles needed for an image error.

use serde::Serialize;

use crate::evaluate::score::FrameScore;

/// Triangles and image errors of an arm in one scene at one share of the triangles.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Name of the scene.
    pub scene: String,
    /// Name of the arm.
    pub arm: String,
    /// Share of the triangles of full detail for which the bias was set.
    pub share: f64,
    /// Triangles drawn in each scored frame.
    pub triangles: Vec<usize>,
    /// Score of each scored frame.
    pub frames: Vec<FrameScore>,
    /// Change of the error from a frame to the next, in parts of white.
    pub temporal_error: f64,
    /// Changes of level per member and second.
    pub switches_per_second: f64,
    /// Time of one choice for the whole flock, in seconds.
    pub selection_seconds: f64,
}

/// Triangles that an arm needs in a scene for an image error.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Needed {
    /// Name of the scene.
    pub scene: String,
    /// Name of the arm.
    pub arm: String,
    /// Mean FLIP to reach.
    pub flip: f64,
    /// Mean triangles a frame; `None` if the error is not reached at any share that was tried.
    pub triangles: Option<f64>,
}

impl Row {
    /// Returns the mean FLIP of the frames, each with the same weight.
    pub fn flip(&self) -> f64 {
        mean(self.frames.iter().map(|frame| frame.flip))
    }

    /// Returns the mean SSIM of the frames.
    pub fn ssim(&self) -> f64 {
        mean(self.frames.iter().map(|frame| frame.ssim))
    }

    /// Returns the mean number of triangles of the frames.
    pub fn mean_triangles(&self) -> f64 {
        mean(self.triangles.iter().map(|&count| count as f64))
    }
}

pub(super) fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
    if count == 0 { 0.0 } else { sum / f64::from(count) }
}

/// Error below which two pictures count as equal, so that one without any error has a logarithm.
const LEAST_ERROR: f64 = 1e-3;

/// Returns the least number of triangles at which a curve reaches an error, interpolated between
/// the logarithms of both; `None` if it does not.
///
/// Points are triangles and errors, in ascending order of triangles. If the coarsest point is
/// already below the error, its triangles are the answer.
pub fn triangles_for(points: &[[f64; 2]], error: f64) -> Option<f64> {
    let first = points.iter().position(|point| point[1] <= error)?;
    let Some(before) = first.checked_sub(1) else { return Some(points[0][0]) };
    let log = |x: f64| x.max(LEAST_ERROR).ln();
    let [coarse, fine] = [points[before], points[first]].map(|p| p.map(log));
    let part = (log(error) - coarse[1]) / (fine[1] - coarse[1]);
    Some((coarse[0] + (fine[0] - coarse[0]) * part.clamp(0.0, 1.0)).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_are_interpolated_between_logarithms() {
        let points = [[100.0, 0.1], [1_000.0, 0.01], [10_000.0, 0.001]];
        let at = |error| triangles_for(&points, error);
        assert!((at(0.01).unwrap() - 1_000.0).abs() < 1e-6);
        assert!((at(0.1f64.sqrt() * 0.1).unwrap() - 100.0 * 10f64.sqrt()).abs() < 1e-6);
        assert_eq!((at(0.5), at(0.0001)), (Some(100.0), None));
    }
}
