//! The error of an extracted mesh: what was asked for, and what is known.

use meshlod_multires::Tolerance;

use crate::model::PoseCounts;
use crate::model::verified::Verification;

/// Error that was asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AskedError {
    /// The error of the finest mesh in the file.
    Finest,
    /// A length in model units.
    Length(f64),
    /// A number of pixels.
    Pixels(f64),
    /// None: a number of faces was asked for.
    Faces,
}

/// Knowledge about the error of an extracted mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum KnownError {
    /// Only what the file says.
    Stored,
    /// The mesh satisfies the query, or is the finest in the file.
    Verified(Verification),
    /// Upper bound of its distance from the original, in model units, if it could be measured.
    Measured(Option<f64>),
}

/// Error of an extracted mesh: what was asked for and what is known.
///
/// As data it has the error that was asked for, what of it is proved and whether it is kept, in model
/// units unless pixels are said.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(into = "form::KeptErrorForm"))]
pub struct KeptError {
    /// The error that was asked for.
    pub asked: AskedError,
    /// The knowledge of the error.
    pub known: KnownError,
    /// True if the error holds in a focus only.
    pub in_focus: bool,
    /// False if the file is truncated, so that nothing is known of the distance from the original.
    pub is_whole: bool,
    /// Distance that vertices have been moved since, in model units.
    pub moved: f64,
    /// Length of the diagonal of the finest mesh, in model units.
    pub diagonal: f64,
    /// Error in the poses in which the errors of the file were measured, by what it says; `None` if
    /// that was only the pose of the file.
    pub poses: Option<PosedError>,
}

/// Error of an extracted mesh in the poses in which the errors of its file were measured.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct PosedError {
    /// Numbers of poses and animations.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub poses: PoseCounts,
    /// Greatest error that the file has for the mesh, in model units; `None` if that was not asked
    /// for, or counts in a focus only.
    pub error: Option<f64>,
}

impl AskedError {
    pub(super) fn of(tolerance: &Tolerance<'_>) -> Self {
        match tolerance {
            _ if tolerance.is_finest() => Self::Finest,
            Tolerance::Uniform(most) => Self::Length(*most),
            Tolerance::Pixels { pixels, .. } => Self::Pixels(*pixels),
            Tolerance::Field(_) | Tolerance::Each(_) => Self::Faces,
        }
    }
}

impl KeptError {
    /// Returns the proven error in model units; `None` if it is in pixels or unknown.
    pub fn proved(&self) -> Option<f64> {
        match (self.known, self.asked) {
            _ if !self.is_whole => None,
            (KnownError::Verified(_), AskedError::Length(asked))
                if self.is_kept() == Some(true) =>
            {
                Some(asked)
            }
            (KnownError::Verified(proof), AskedError::Length(asked)) if proof.holds => {
                Some(asked + self.moved)
            }
            (KnownError::Verified(proof), AskedError::Length(_) | AskedError::Finest) => {
                Some(proof.rounding + self.moved)
            }
            (KnownError::Measured(error), _) => error.map(|error| error + self.moved),
            _ => None,
        }
    }

    /// Returns the proven error in pixels; `None` if it is a length or unknown.
    pub fn proved_px(&self) -> Option<f64> {
        match self.asked {
            AskedError::Pixels(asked) => (self.is_kept() == Some(true)).then_some(asked),
            _ => None,
        }
    }

    /// Returns whether the error asked for is kept; `None` if that is unknown, or the finest level
    /// was asked for.
    pub fn is_kept(&self) -> Option<bool> {
        match (self.known, self.asked) {
            (KnownError::Verified(proof), AskedError::Length(_) | AskedError::Pixels(_))
                if self.is_whole =>
            {
                Some(proof.holds && self.moved <= proof.spare)
            }
            _ => None,
        }
    }

    /// Returns the rounding of the file, in model units, if less than that was asked for.
    pub fn below_rounding(&self) -> Option<f64> {
        match (self.known, self.asked) {
            (_, AskedError::Finest | AskedError::Faces) => None,
            (KnownError::Verified(Verification { holds: false, rounding, .. }), _) => {
                Some(rounding)
            }
            _ => None,
        }
    }

    /// Returns by how much coordinates may change when they are written without a word: by the
    /// rounding of the file at most, and within what the proof leaves for it.
    pub(super) fn spare(&self, rounding: f64) -> f64 {
        match (self.known, self.asked) {
            // A point moves by at most the square root of three times as much.
            (KnownError::Verified(proof), AskedError::Length(_) | AskedError::Pixels(_)) => {
                rounding.min(0.5 * proof.spare)
            }
            _ => rounding,
        }
    }

    /// Notes that writing the mesh changes coordinates by up to this length, in model units.
    pub(super) fn note_rounding(&mut self, of_coordinates: f64) {
        self.moved += 3f64.sqrt() * of_coordinates;
    }
}

#[cfg(feature = "serde")]
mod form {
    use serde::Serialize;

    use super::{AskedError, KeptError, KnownError, PosedError};

    /// Error of an extracted mesh as data.
    #[derive(Serialize)]
    pub(super) struct KeptErrorForm {
        asked: Option<f64>,
        asked_px: Option<f64>,
        proved: Option<f64>,
        proved_px: Option<f64>,
        kept: Option<bool>,
        in_focus: bool,
        poses: Option<PosedError>,
        updates_added: Option<usize>,
        rounds: Option<usize>,
    }

    impl From<KeptError> for KeptErrorForm {
        fn from(error: KeptError) -> Self {
            let [asked, asked_px] = match error.asked {
                AskedError::Finest => [Some(0.0), None],
                AskedError::Length(asked) => [Some(asked), None],
                AskedError::Pixels(asked) => [None, Some(asked)],
                AskedError::Faces => [None; 2],
            };
            let proof = match error.known {
                KnownError::Verified(proof) if error.is_whole => Some(proof),
                _ => None,
            };
            Self {
                asked,
                asked_px,
                proved: error.proved(),
                proved_px: error.proved_px(),
                kept: error.is_kept(),
                in_focus: error.in_focus,
                poses: error.poses,
                updates_added: proof.map(|proof| proof.added),
                rounds: proof.map(|proof| proof.rounds),
            }
        }
    }
}
