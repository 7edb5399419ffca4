//! The error of a mesh that `extract` writes, asked for and known, as JSON and text.

use meshlod::Verification;
use meshlod::multires::Tolerance;
use serde_json::{Value, json};

use crate::numbers::{count, percent, plural, value};

/// Error that was asked for.
#[derive(Clone, Copy, PartialEq)]
pub enum Asked {
    /// Length in model units.
    Length(f64),
    Pixels(f64),
    /// Nothing: a number of faces was asked for.
    Faces,
}

impl Asked {
    pub fn of(tolerance: &Tolerance<'_>) -> Self {
        match *tolerance {
            Tolerance::Uniform(most) => Self::Length(most),
            Tolerance::Pixels { pixels, .. } => Self::Pixels(pixels),
            Tolerance::Field(_) => Self::Faces,
        }
    }
}

/// Knowledge about the error of an extracted mesh.
#[derive(Clone, Copy)]
pub enum Known {
    /// Only what the file says.
    Stored,
    /// The mesh satisfies the query, or is the finest in the file.
    Verified(Verification),
    /// Upper bound of its distance from the original, in model units, if it could be measured.
    Measured(Option<f64>),
}

/// Error of an extracted mesh: what was asked for and what is known.
#[derive(Clone, Copy)]
pub struct KeptError {
    pub asked: Asked,
    pub known: Known,
    /// True if the error holds in a focus only.
    pub is_local: bool,
    /// False if the file is truncated, so that nothing is known of the distance from the original.
    pub is_whole: bool,
    /// Distance that vertices have been moved since, in model units.
    pub moved: f64,
    /// Length of the diagonal of the finest mesh, in model units.
    pub diagonal: f64,
}

impl KeptError {
    /// Returns the proven error in model units; `None` if it is in pixels or unknown.
    fn proved(&self) -> Option<f64> {
        match (self.known, self.asked) {
            _ if !self.is_whole => None,
            (Known::Verified(proof), Asked::Length(asked)) => {
                Some(if proof.holds { asked } else { proof.rounding } + self.moved)
            }
            (Known::Measured(error), _) => error.map(|error| error + self.moved),
            _ => None,
        }
    }

    /// Returns the proven error in pixels; `None` if it is a length or unknown.
    fn proved_px(&self) -> Option<f64> {
        match (self.known, self.asked) {
            (Known::Verified(proof), Asked::Pixels(asked)) => {
                (proof.holds && self.is_whole && self.moved == 0.0).then_some(asked)
            }
            _ => None,
        }
    }

    /// Returns by how much coordinates may change when they are written without a word: by the
    /// rounding of the file at most, and within what the proof leaves for it.
    pub fn spare(&self, rounding: f64) -> f64 {
        match (self.known, self.asked) {
            (Known::Verified(_), Asked::Length(asked)) if asked > 0.0 => {
                rounding.min(asked / 2000.0)
            }
            _ => rounding,
        }
    }

    /// Returns a warning if less was asked for than the file can give.
    pub fn warning(&self) -> Option<String> {
        let Known::Verified(Verification { holds: false, rounding, .. }) = self.known else {
            return None;
        };
        let (asked, part) = match self.asked {
            Asked::Length(0.0) | Asked::Faces => return None,
            Asked::Length(asked) => (value(asked), "it"),
            Asked::Pixels(asked) => (format!("{}px", value(asked)), "parts of it"),
        };
        Some(format!(
            "--error {asked} is below the rounding of the file, {}: {part} cannot be that close to the \
             mesh; build with --lossless or a smaller --rounding",
            value(rounding)
        ))
    }

    /// Returns whether the error asked for is kept; `None` if that is unknown, or the finest level
    /// was asked for.
    pub fn is_kept(&self) -> Option<bool> {
        match (self.known, self.asked) {
            (_, Asked::Length(0.0)) => None,
            (Known::Verified(proof), _) if self.is_whole => Some(proof.holds && self.moved == 0.0),
            _ => None,
        }
    }

    pub fn to_json(self) -> Value {
        let [asked, asked_px] = match self.asked {
            Asked::Length(asked) => [Some(asked), None],
            Asked::Pixels(asked) => [None, Some(asked)],
            Asked::Faces => [None; 2],
        };
        let proof = match self.known {
            Known::Verified(proof) if self.is_whole => Some(proof),
            _ => None,
        };
        json!({
            "asked": asked,
            "asked_px": asked_px,
            "proved": self.proved(),
            "proved_px": self.proved_px(),
            "kept": self.is_kept(),
            "in_focus": self.is_local,
            "updates_added": proof.map(|proof| proof.added),
            "rounds": proof.map(|proof| proof.rounds),
        })
    }

    pub fn to_text(self) -> String {
        let length = |length: f64| {
            format!("{} ({})", value(length), percent(100.0 * length / self.diagonal))
        };
        let proved = match (self.proved(), self.proved_px()) {
            (Some(proved), _) => length(proved),
            (_, Some(pixels)) => format!("{}px", value(pixels)),
            (None, None) => "unknown".into(),
        };
        match self.known {
            Known::Stored => "error: by what the file says, not verified\n".into(),
            _ if !self.is_whole => "error: unknown, as the file is truncated\n".into(),
            Known::Measured(_) => format!("error: at most {proved}, measured\n"),
            Known::Verified(Verification { added, .. }) => {
                let more = format!("{} update{} added", count(added), plural(added));
                let place = if self.is_local { " in the focus" } else { "" };
                format!("error: at most {proved}{place}, verified; {more}\n")
            }
        }
    }
}
