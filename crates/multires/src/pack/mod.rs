//! Compact encodings shared by the packed model and the file.

mod exact_positions;
mod ranked_set;
mod short_lengths;
mod zigzag;

pub(crate) use exact_positions::ExactPositions;
pub(crate) use ranked_set::RankedSet;
pub(crate) use short_lengths::{ERRORS, MIN_ERROR, error9, error16, radius8, radius16};
pub(crate) use zigzag::{unzigzag, zigzag};
