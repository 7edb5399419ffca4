//! The error of a mesh that `extract` writes, asked for and known, as JSON and text.

use meshlod::multires::Tolerance;
use meshlod::{PoseCounts, Verification};
use serde::Serialize;

use crate::session::model_file;
use crate::text::numbers::{count, percent, plural, value};

/// Error that was asked for.
#[derive(Clone, Copy, PartialEq)]
pub enum Asked {
    /// The finest mesh in the file.
    Finest,
    /// Length in model units.
    Length(f64),
    Pixels(f64),
    /// Nothing: a number of faces was asked for.
    Faces,
}

impl Asked {
    pub fn of(tolerance: &Tolerance<'_>) -> Self {
        match tolerance {
            _ if tolerance.is_finest() => Self::Finest,
            Tolerance::Uniform(most) => Self::Length(*most),
            Tolerance::Pixels { pixels, .. } => Self::Pixels(*pixels),
            Tolerance::Field(_) | Tolerance::Each(_) => Self::Faces,
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
    /// Error by what the file says in the poses in which it was measured, in model units; `None` if it
    /// was measured in none, or is not known.
    pub in_poses: Option<PosedError>,
}

/// Error of an extracted mesh in the poses in which the errors of its file were measured.
#[derive(Clone, Copy)]
pub struct PosedError {
    pub poses: PoseCounts,
    /// Greatest error that the file has for the mesh, in model units; `None` if that was not asked
    /// for, or counts in a focus only.
    pub stored: Option<f64>,
}

/// Error of an extracted mesh for programs, in model units unless pixels are said.
#[derive(Serialize)]
pub struct KeptFigures {
    asked: Option<f64>,
    asked_px: Option<f64>,
    proved: Option<f64>,
    proved_px: Option<f64>,
    kept: Option<bool>,
    in_focus: bool,
    poses: Option<PosedFigures>,
    updates_added: Option<usize>,
    rounds: Option<usize>,
}

#[derive(Serialize)]
struct PosedFigures {
    #[serde(flatten)]
    poses: PoseCounts,
    error: Option<f64>,
}

impl KeptError {
    /// Returns the proven error in model units; `None` if it is in pixels or unknown.
    fn proved(&self) -> Option<f64> {
        match (self.known, self.asked) {
            _ if !self.is_whole => None,
            (Known::Verified(_), Asked::Length(asked)) if self.is_kept() == Some(true) => {
                Some(asked)
            }
            (Known::Verified(proof), Asked::Length(asked)) if proof.holds => {
                Some(asked + self.moved)
            }
            (Known::Verified(proof), Asked::Length(_) | Asked::Finest) => {
                Some(proof.rounding + self.moved)
            }
            (Known::Measured(error), _) => error.map(|error| error + self.moved),
            _ => None,
        }
    }

    /// Returns the proven error in pixels; `None` if it is a length or unknown.
    fn proved_px(&self) -> Option<f64> {
        match self.asked {
            Asked::Pixels(asked) => (self.is_kept() == Some(true)).then_some(asked),
            _ => None,
        }
    }

    /// Returns by how much coordinates may change when they are written without a word: by the
    /// rounding of the file at most, and within what the proof leaves for it.
    pub fn spare(&self, rounding: f64) -> f64 {
        match (self.known, self.asked) {
            // A point moves by at most the square root of three times as much.
            (Known::Verified(proof), Asked::Length(_) | Asked::Pixels(_)) => {
                rounding.min(0.5 * proof.spare)
            }
            _ => rounding,
        }
    }

    /// Notes that writing the mesh changes coordinates by up to this length, in model units.
    pub fn note_rounding(&mut self, of_coordinates: f64) {
        self.moved += 3f64.sqrt() * of_coordinates;
    }

    /// Returns a warning if less was asked for than the file can give.
    pub fn warning(&self) -> Option<String> {
        let Known::Verified(Verification { holds: false, rounding, .. }) = self.known else {
            return None;
        };
        let (asked, part) = match self.asked {
            Asked::Finest | Asked::Faces => return None,
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
            (Known::Verified(proof), Asked::Length(_) | Asked::Pixels(_)) if self.is_whole => {
                Some(proof.holds && self.moved <= proof.spare)
            }
            _ => None,
        }
    }

    pub fn figures(self) -> KeptFigures {
        let [asked, asked_px] = match self.asked {
            Asked::Finest => [Some(0.0), None],
            Asked::Length(asked) => [Some(asked), None],
            Asked::Pixels(asked) => [None, Some(asked)],
            Asked::Faces => [None; 2],
        };
        let proof = match self.known {
            Known::Verified(proof) if self.is_whole => Some(proof),
            _ => None,
        };
        let posed = |PosedError { poses, stored: error }: PosedError| PosedFigures { poses, error };
        KeptFigures {
            asked,
            asked_px,
            proved: self.proved(),
            proved_px: self.proved_px(),
            kept: self.is_kept(),
            in_focus: self.is_local,
            poses: self.in_poses.map(posed),
            updates_added: proof.map(|proof| proof.added),
            rounds: proof.map(|proof| proof.rounds),
        }
    }

    pub fn to_text(self) -> String {
        let place = if self.is_local { " in the focus" } else { "" };
        let pose = if self.in_poses.is_some() { " in the pose of the file" } else { "" };
        let mut text = match self.known {
            Known::Stored => "error: by what the file says, not verified\n".into(),
            _ if !self.is_whole => "error: unknown, as the file is truncated\n".into(),
            Known::Measured(None) => "error: unknown, as it could not be measured\n".into(),
            Known::Measured(Some(_)) => {
                format!("error: at most {}{pose}, measured\n", self.bound())
            }
            Known::Verified(_) if self.asked == Asked::Finest => {
                format!(
                    "error: at most {}{place}{pose}: the finest mesh of the file\n",
                    self.bound()
                )
            }
            Known::Verified(Verification { added, .. }) => {
                let more = format!("{} update{} added", count(added), plural(added));
                format!("error: at most {}{place}{pose}, verified; {more}\n", self.bound())
            }
        };
        if let Some(PosedError { poses, stored: Some(stored) }) = self.in_poses {
            text += &format!(
                "error in poses: {} ({}) by what the file has, measured over {}\n",
                value(stored),
                percent(100.0 * stored / self.diagonal),
                model_file::poses_text(poses),
            );
        }
        text
    }

    /// Describes the proven error.
    fn bound(&self) -> String {
        let length = |length: f64| {
            format!("{} ({})", value(length), percent(100.0 * length / self.diagonal))
        };
        match (self.proved(), self.known, self.asked) {
            (Some(proved), ..) => length(proved),
            (None, Known::Verified(proof), Asked::Pixels(pixels)) => {
                // Where pixels are smaller than the rounding, the mesh is as fine as the file.
                let mut text = format!("{}px", value(pixels));
                if !proof.holds {
                    text += &format!(" or {}, whichever is more", length(proof.rounding));
                }
                if self.moved > proof.spare {
                    text += &format!(" plus {} by which vertices were moved", length(self.moved));
                }
                text
            }
            _ => "unknown".into(),
        }
    }
}
