//! Progress display, shown only on a terminal.

use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use meshlod::simplify::Observe;

/// Progress line on standard error.
pub struct Progress {
    bar: ProgressBar,
    listener: Option<Listener>,
}

/// Callback with the number of things done and their total.
pub type Listener = Box<dyn Fn(usize, usize) + Send + Sync>;

impl Progress {
    /// Makes a line that is hidden if `quiet`, or where standard error is no terminal.
    pub fn new(quiet: bool) -> Self {
        let on_terminal = !quiet && std::io::stderr().is_terminal();
        let target =
            if on_terminal { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(None, target);
        if on_terminal {
            bar.enable_steady_tick(Duration::from_millis(100));
        }
        Self { bar, listener: None }
    }

    /// Creates a progress line that is never shown.
    pub fn hidden() -> Self {
        Self { bar: ProgressBar::hidden(), listener: None }
    }

    /// Creates a progress line that is never shown, but told to a listener where numbers are known.
    pub fn told(listener: Listener) -> Self {
        Self { listener: Some(listener), ..Self::hidden() }
    }

    /// Shows a stage of work of unknown length.
    pub fn stage(&self, what: &str) {
        self.bar.set_style(ProgressStyle::default_spinner());
        self.bar.set_message(what.to_owned());
    }

    /// Shows the progress of a simplification that removes `faces` faces, if that number is known.
    pub fn contractions(&self, what: &str, faces: Option<usize>) -> Watch<'_> {
        self.stage(what);
        if let Some(faces) = faces {
            let style = ProgressStyle::with_template("{spinner} {msg} {bar:40} {percent}%");
            self.bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            self.bar.set_length(faces as u64);
        }
        self.bar.set_position(0);
        Watch { bar: &self.bar, gone: 0, shown: 0 }
    }

    /// Shows how many steps of a stage are done, as a part where their number is known.
    pub fn step(&self, done: usize, of: Option<usize>) {
        if let Some(of) = of.filter(|_| done == 0) {
            let style = ProgressStyle::with_template("{spinner} {msg} {bar:40} {percent}%");
            self.bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            self.bar.set_length(of as u64);
        }
        self.bar.set_position(done as u64);
    }

    /// Shows how many of a known number of things are done.
    pub fn part(&self, what: &str, done: usize, of: usize) {
        if done == 0 {
            self.stage(what);
            let style = ProgressStyle::with_template("{spinner} {msg} {bar:40} {pos}/{len}");
            self.bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            self.bar.set_length(of as u64);
        }
        self.bar.set_position(done as u64);
        if let Some(listener) = &self.listener {
            listener(done, of);
        }
    }

    /// Runs `act` while the progress line is hidden.
    pub fn suspend(&self, act: impl FnOnce()) {
        self.bar.suspend(act);
    }

    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

/// Observer of a simplification that advances the progress bar by the faces removed.
pub struct Watch<'p> {
    bar: &'p ProgressBar,
    gone: u64,
    /// Number of removed faces that the bar shows.
    shown: u64,
}

/// Faces removed between two updates of the bar, each of which costs more than a contraction.
const FACES_A_LOOK: u64 = 8192;

impl Observe for Watch<'_> {
    fn needs_surface(&self) -> bool {
        false
    }

    fn gone(&mut self, faces: usize) {
        self.gone += faces as u64;
        if self.gone >= self.shown + FACES_A_LOOK {
            self.shown = self.gone;
            self.bar.set_position(self.gone);
        }
    }
}
