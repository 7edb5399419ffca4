//! The error of a mesh that `extract` writes, asked for and known, as text.

use meshlod::jobs::{AskedError, KeptError, KnownError, PosedError};
use meshlod::model::Verification;

use crate::session::model_file;
use crate::text::numbers::{count, percent, plural, value};

/// Returns a warning if an error was asked for that is not kept.
pub fn warning(error: &KeptError) -> Option<String> {
    let (asked, part) = match error.asked {
        AskedError::Finest | AskedError::Faces => return None,
        AskedError::Length(asked) => (value(asked), "it"),
        AskedError::Pixels(asked) => (format!("{}px", value(asked)), "parts of it"),
    };
    let reason = if let Some(rounding) = error.below_rounding() {
        format!(
            " is below the rounding of the file, {}: {part} cannot be that close to the mesh; build \
             with --lossless or a smaller --rounding",
            value(rounding)
        )
    } else if error.is_kept() == Some(false) {
        format!(
            ": vertices were moved by up to {}, which is more than that leaves room for",
            value(error.moved)
        )
    } else {
        return None;
    };
    Some(format!("--error {asked}{reason}"))
}

/// Describes what is known about the error, in one line or two.
pub fn to_text(error: &KeptError) -> String {
    let place = if error.in_focus { " in the focus" } else { "" };
    let pose = if error.poses.is_some() { " in the pose of the file" } else { "" };
    let mut text = match error.known {
        KnownError::Stored => "error: by what the file says, not verified\n".into(),
        _ if !error.is_whole => "error: unknown, as the file is truncated\n".into(),
        KnownError::Measured(None) => "error: unknown, as it could not be measured\n".into(),
        KnownError::Measured(Some(_)) => {
            format!("error: at most {}{pose}, measured\n", bound(error))
        }
        KnownError::Verified(_) if error.asked == AskedError::Finest => {
            format!("error: at most {}{place}{pose}: the finest mesh of the file\n", bound(error))
        }
        KnownError::Verified(Verification { added, .. }) => {
            let more = format!("{} update{} added", count(added), plural(added));
            format!("error: at most {}{place}{pose}, verified; {more}\n", bound(error))
        }
    };
    if let Some(PosedError { poses, error: Some(stored) }) = error.poses {
        text += &format!(
            "error in poses: {} ({}) by what the file has, measured over {}\n",
            value(stored),
            percent(100.0 * stored / error.diagonal),
            model_file::poses_text(poses),
        );
    }
    text
}

/// Describes the proven error.
fn bound(error: &KeptError) -> String {
    let length =
        |length: f64| format!("{} ({})", value(length), percent(100.0 * length / error.diagonal));
    match (error.proved(), error.known, error.asked) {
        (Some(proved), ..) => length(proved),
        (None, KnownError::Verified(proof), AskedError::Pixels(pixels)) => {
            // Where pixels are smaller than the rounding, the mesh is as fine as the file.
            let mut text = format!("{}px", value(pixels));
            if !proof.holds {
                text += &format!(" or {}, whichever is more", length(proof.rounding));
            }
            if error.moved > proof.spare {
                text += &format!(" plus {} by which vertices were moved", length(error.moved));
            }
            text
        }
        _ => "unknown".into(),
    }
}
