//! Clock of a film that runs live.

use std::time::Instant;

/// Turns time that has passed into whole frames of a film.
#[derive(Debug, Default)]
pub(super) struct FilmClock {
    before: Option<Instant>,
    /// Time for which there was no whole frame yet, in seconds.
    rest_s: f64,
}

/// Longest time that a film makes up for, in seconds; what hangs longer slows the film down.
const LONGEST_S: f64 = 0.1;

impl FilmClock {
    /// Returns the time since the last call, in seconds; 0 for the first.
    pub fn lap(&mut self) -> f64 {
        let now = Instant::now();
        self.before.replace(now).map_or(0.0, |before| (now - before).as_secs_f64())
    }

    /// Returns the number of frames of `frame_s` seconds for which there was time; the rest is kept
    /// for the next call.
    pub fn frames(&mut self, elapsed_s: f64, frame_s: f64) -> usize {
        self.rest_s += elapsed_s.clamp(0.0, LONGEST_S);
        let frames = (self.rest_s / frame_s).floor();
        self.rest_s -= frames * frame_s;
        frames as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_film_neither_gains_nor_loses_time() {
        let mut clock = FilmClock::default();
        let frames: Vec<usize> = (0..6).map(|_| clock.frames(0.025, 0.01)).collect();
        assert_eq!(frames.iter().sum::<usize>(), 15, "{frames:?}");
        assert!(frames.iter().all(|count| [2, 3].contains(count)), "{frames:?}");
        assert_eq!(clock.frames(60.0, 0.01), 10, "what hung is not made up for");
    }
}
