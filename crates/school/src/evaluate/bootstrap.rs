//! Intervals by resampling of scenes and their frames.

use serde::Serialize;

/// Mean with the interval that holds nine tenths of its resamples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Interval {
    /// Value over all frames.
    pub mean: f64,
    /// Five percent of the resamples are below this.
    pub low: f64,
    /// Five percent of the resamples are above this.
    pub high: f64,
}

/// Number of resamples.
const RESAMPLES: usize = 500;

impl Interval {
    /// Computes a figure over all scenes and frames, and over resamples of them, with a generator
    /// of fixed seed [Efr79]: scenes are drawn with replacement, and then frames of each.
    ///
    /// `figure` gets scenes and the frames of each; it may be undefined for some of the resamples,
    /// which do not count. Returns `None` if it is undefined for all frames.
    pub(super) fn of(
        scenes: usize,
        frames: usize,
        figure: impl Fn(&[(usize, Vec<usize>)]) -> Option<f64>,
    ) -> Option<Self> {
        let all: Vec<_> = (0..scenes).map(|scene| (scene, (0..frames).collect())).collect();
        let mean = figure(&all)?;
        let mut state = 0x9e37_79b9_7f4a_7c15u64;
        let mut draw = |count: usize| {
            // xorshift64* [Vig16].
            state ^= state >> 12;
            state ^= state << 25;
            state ^= state >> 27;
            (state.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize % count
        };
        let mut resamples = Vec::with_capacity(RESAMPLES);
        for _ in 0..RESAMPLES {
            let mut drawn = Vec::with_capacity(scenes);
            for _ in 0..scenes {
                let scene = draw(scenes);
                drawn.push((scene, (0..frames).map(|_| draw(frames)).collect()));
            }
            resamples.extend(figure(&drawn));
        }
        resamples.sort_by(f64::total_cmp);
        let at = |part: f64| {
            let index = (part * resamples.len() as f64) as usize;
            resamples.get(index.min(resamples.len().saturating_sub(1))).copied().unwrap_or(mean)
        };
        Some(Self { mean, low: at(0.05), high: at(0.95) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mean_of(values: &[f64], drawn: &[(usize, Vec<usize>)]) -> Option<f64> {
        let frames: Vec<usize> = drawn.iter().flat_map(|(_, frames)| frames.clone()).collect();
        Some(frames.iter().map(|&frame| values[frame]).sum::<f64>() / frames.len() as f64)
    }

    #[test]
    fn the_interval_of_equal_frames_is_a_point() {
        let interval = Interval::of(2, 5, |drawn| mean_of(&[3.0; 5], drawn)).unwrap();
        assert_eq!((interval.mean, interval.low, interval.high), (3.0, 3.0, 3.0));
    }

    #[test]
    fn the_interval_of_different_frames_holds_the_mean() {
        let values: Vec<f64> = (0..20).map(f64::from).collect();
        let interval = Interval::of(1, 20, |drawn| mean_of(&values, drawn)).unwrap();
        assert!(interval.low < 9.5 && 9.5 < interval.high && interval.mean == 9.5);
        assert!(interval.high - interval.low < 6.0);
        assert_eq!(Interval::of(2, 3, |_| None), None);
    }
}
