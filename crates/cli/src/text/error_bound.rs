//! The error of `simplify --error`: what was asked for, what is proved, and what writing rounds.

use meshlod::measure::{CertifiedOptions, PreparedSurface, certified_surface_distance};
use meshlod::simplify::Digits;
use meshlod::{Mesh, Report, Scene, Target, rounding_of_level};
use serde::Serialize;

use crate::text::distance;
use crate::text::numbers::value;

/// Part of the error that rounding may take before coordinates are written with 64 bits.
const UNSEEN: f64 = 0.005;

/// Largest part of the error that is kept free for rounding.
const MOST_ROOM: f64 = 0.5;

/// Multiple of the rounding that is kept free where the volume is restored.
const MOVES: f64 = 5.0;

/// Relative difference of two lengths that counts as none: the rounding of their computation.
const EQUAL: f64 = 1e-9;

/// Part of the diagonal below which an error is not proved, only measured.
const LEAST_PROVABLE: f64 = 1e-6;

/// Part of the diagonal below which a distance is not told apart from none: simplification rounds to
/// 32 bits.
const LEAST_TOLD: f64 = f32::EPSILON as f64;

/// An error asked for, in world units.
#[derive(Clone, Copy)]
pub struct AskedError {
    asked: f64,
    /// Largest distance by which writing moves a point.
    rounding: f64,
    /// Distance kept free for rounding, and for moves that restore the volume.
    room: f64,
}

/// An error that was asked for with what is proved of it, in world units.
#[derive(Clone, Copy)]
pub struct ProvedError {
    asked: f64,
    /// Upper bound of the distance between the input and what is written, both ways; `None` if
    /// there is none.
    proved: Option<f64>,
    /// True if a distance greater than what was asked for was found, false if it is only unproved.
    is_exceeded: bool,
    rounds: usize,
    rounding: f64,
}

/// Figures of an error that was asked for, lengths in world units.
#[derive(Serialize)]
pub struct ErrorFigures {
    error_asked: Option<f64>,
    error_proved: Option<f64>,
    error_rounds: Option<usize>,
}

impl AskedError {
    /// Restoring the volume moves vertices too, mostly by about twice the rounding.
    pub fn new(asked: f64, scene: &Scene, digits: Digits, is_volume_restored: bool) -> Self {
        let rounding = rounding_of_level(scene, digits);
        let room = if is_volume_restored { MOVES * rounding } else { rounding };
        Self { asked, rounding, room }
    }

    /// Returns whether rounding takes more of the error than goes unseen.
    pub fn needs_precision(&self) -> bool {
        self.room > UNSEEN * self.asked
    }

    /// Returns the target that leaves room for rounding.
    pub fn target(&self) -> Target {
        Target::Error(self.asked - self.room.min(MOST_ROOM * self.asked))
    }

    /// Returns what the proof in a report says of the level as it is written, after its vertices
    /// have moved by at most `moved`.
    pub fn by_report(&self, report: &Report, moved: f64) -> ProvedError {
        let changed = self.rounding + moved;
        let proved = report.proof.map(|proof| match proof.proved <= proof.asked {
            true => (proof.asked + changed).max(self.asked),
            false => proof.proved + changed,
        });
        let rounds = report.proof.map_or(0, |proof| proof.rounds);
        let is_exceeded = proved.is_none_or(|proved| proved > self.asked * (1.0 + EQUAL));
        ProvedError { asked: self.asked, proved, is_exceeded, rounds, rounding: self.rounding }
    }

    /// Measures an upper bound of the distance between the original surface and a level.
    pub fn by_measuring(
        &self,
        original: Option<&PreparedSurface<'_>>,
        scene: &Scene,
        level: &[Mesh],
    ) -> ProvedError {
        let level = distance::surface_of(scene, level);
        let bracket = original.zip(PreparedSurface::new(&level).ok()).map(|(original, level)| {
            let options = CertifiedOptions::default();
            certified_surface_distance(original, &level, &options).symmetric()
        });
        let proved = bracket.map(|bracket| bracket.upper + self.rounding);
        // Distances too small to be proved are not told apart from none.
        let least = bracket.map_or(0.0, |bracket| bracket.lower);
        let diagonal = original.map_or(0.0, PreparedSurface::diagonal);
        let is_exceeded = match self.asked < LEAST_PROVABLE * diagonal {
            true => least > self.asked.max(LEAST_TOLD * diagonal) + self.rounding,
            false => proved.is_none_or(|proved| proved > self.asked * (1.0 + EQUAL)),
        };
        ProvedError { asked: self.asked, proved, is_exceeded, rounds: 0, rounding: self.rounding }
    }
}

impl ProvedError {
    /// Returns whether the error is within what was asked for: proved, or for errors too small to be
    /// proved, not found to be greater.
    pub fn is_held(&self) -> bool {
        !self.is_exceeded
    }

    /// Formats a warning that says what holds instead, and what would help.
    pub fn warning(&self) -> String {
        let asked = value(self.asked);
        let Some(proved) = self.proved else {
            return format!("--error {asked} is not proved: a surface has no area to measure");
        };
        let proved = value(proved);
        let help = match self.rounding > MOST_ROOM * self.asked {
            true => {
                "the coordinates written are rounded by more than half of that; ply, obj, off \
                and smf take --precision f64"
            }
            false => {
                "a larger error can be kept, and lindstrom-turk and qem keep smaller ones without \
                --exact-volume, --sequence and locks"
            }
        };
        format!("--error {asked}: only {proved} is proved; {help}")
    }

    /// Returns what was asked for and what is proved; `None` of all three where no error was asked
    /// for.
    pub fn figures(kept: Option<&Self>) -> ErrorFigures {
        ErrorFigures {
            error_asked: kept.map(|kept| kept.asked),
            error_proved: kept.and_then(|kept| kept.proved),
            error_rounds: kept.map(|kept| kept.rounds),
        }
    }

    /// Formats the lines with what was asked for and what is proved.
    pub fn text(&self) -> String {
        let proved = self.proved.map_or("nothing".into(), |proved| {
            let plural = if self.rounds == 1 { "" } else { "s" };
            match self.rounds {
                0 => value(proved),
                rounds => format!("{} (mended in {rounds} round{plural})", value(proved)),
            }
        });
        format!("error_asked: {}\nerror_proved: {proved}\n", value(self.asked))
    }
}
