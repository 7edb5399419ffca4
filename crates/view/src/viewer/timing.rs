//! Times of frames.

use std::time::Instant;

/// Times between frames, and times to the first frame and picture.
#[derive(Debug)]
pub(crate) struct FrameTimes {
    started: Instant,
    /// Start of the last frame, if it asked for the next one at once.
    last: Option<Instant>,
    frames: usize,
    all: Intervals,
    loading: Intervals,
    pub first_frame_ms: Option<f64>,
    pub first_picture_ms: Option<f64>,
}

/// Times between frames in milliseconds.
#[derive(Debug, Default)]
struct Intervals(Vec<f32>);

/// Number of the latest frames that the average covers.
const RECENT: usize = 30;

impl FrameTimes {
    pub fn new(started: Instant) -> Self {
        Self {
            started,
            last: None,
            frames: 0,
            all: Intervals::default(),
            loading: Intervals::default(),
            first_frame_ms: None,
            first_picture_ms: None,
        }
    }

    /// Begins a frame.
    pub fn begin(&mut self, is_loading: bool) {
        let now = Instant::now();
        self.frames += 1;
        if let Some(last) = self.last.take() {
            let ms = (now - last).as_secs_f32() * 1e3;
            self.all.0.push(ms);
            if is_loading {
                self.loading.0.push(ms);
            }
        }
        self.first_frame_ms.get_or_insert((now - self.started).as_secs_f64() * 1e3);
        self.last = Some(now);
    }

    /// Marks a pause: the time to the next frame, which waits for an event, is not counted.
    pub fn rest(&mut self) {
        self.last = None;
    }

    /// Notes that the first picture of a file is on the screen.
    pub fn picture_shown(&mut self) {
        let ms = self.started.elapsed().as_secs_f64() * 1e3;
        self.first_picture_ms.get_or_insert(ms);
    }

    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Returns the mean time between the latest frames that followed each other, in milliseconds.
    pub fn recent_ms(&self) -> Option<f32> {
        let recent = &self.all.0[self.all.0.len().saturating_sub(RECENT)..];
        (!recent.is_empty()).then(|| recent.iter().sum::<f32>() / recent.len() as f32)
    }

    /// Returns the median and the longest time between frames, in milliseconds.
    pub fn summary(&self) -> [Option<f64>; 2] {
        [self.all.median(), self.all.longest()]
    }

    /// Returns the median and the longest time between frames while loading, in milliseconds.
    pub fn loading_summary(&self) -> [Option<f64>; 2] {
        [self.loading.median(), self.loading.longest()]
    }
}

impl Intervals {
    fn median(&self) -> Option<f64> {
        let mut sorted = self.0.clone();
        sorted.sort_by(f32::total_cmp);
        sorted.get(sorted.len() / 2).map(|&ms| ms.into())
    }

    fn longest(&self) -> Option<f64> {
        self.0.iter().copied().max_by(f32::total_cmp).map(f64::from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pause_is_no_frame_time() {
        let mut times = FrameTimes::new(Instant::now());
        times.begin(true);
        times.rest();
        times.begin(false);
        assert_eq!((times.frames(), times.summary()), (2, [None; 2]));
        times.begin(true);
        assert!(times.summary()[0].is_some() && times.loading_summary()[1].is_some());
    }
}
