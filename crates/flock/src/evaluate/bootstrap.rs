//! Intervals by resampling of scenes' frames.

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
    /// Computes a figure over all frames, and over resamples of them, with a generator of fixed
    /// seed [Efr79].
    ///
    /// `figure` gets the indices of the frames; it may be undefined for some of the resamples,
    /// which do not count. Returns `None` if it is undefined for all frames.
    pub(super) fn of(frames: usize, figure: impl Fn(&[usize]) -> Option<f64>) -> Option<Self> {
        let all: Vec<usize> = (0..frames).collect();
        let mean = figure(&all)?;
        let mut state = 0x9e37_79b9_7f4a_7c15u64;
        let mut draw = || {
            // xorshift64* [Vig16].
            state ^= state >> 12;
            state ^= state << 25;
            state ^= state >> 27;
            (state.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize % frames
        };
        let mut resamples = Vec::with_capacity(RESAMPLES);
        for _ in 0..RESAMPLES {
            let drawn: Vec<usize> = (0..frames).map(|_| draw()).collect();
            resamples.extend(figure(&drawn));
        }
        resamples.sort_by(f64::total_cmp);
        let at = |part: f64| {
            let index = (part * resamples.len() as f64) as usize;
            resamples.get(index.min(resamples.len().wrapping_sub(1))).copied().unwrap_or(mean)
        };
        Some(Self { mean, low: at(0.05), high: at(0.95) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_of_equal_frames_is_a_point() {
        let values = [3.0; 5];
        let mean = |frames: &[usize]| {
            Some(frames.iter().map(|&f| values[f]).sum::<f64>() / frames.len() as f64)
        };
        let interval = Interval::of(5, mean).unwrap();
        assert_eq!((interval.mean, interval.low, interval.high), (3.0, 3.0, 3.0));
    }

    #[test]
    fn the_interval_of_different_frames_holds_the_mean() {
        let mean =
            |frames: &[usize]| Some(frames.iter().sum::<usize>() as f64 / frames.len() as f64);
        let interval = Interval::of(20, mean).unwrap();
        assert!(interval.low < 9.5 && 9.5 < interval.high && interval.mean == 9.5);
        assert!(interval.high - interval.low < 6.0);
        assert_eq!(Interval::of(3, |_| None), None);
    }
}
