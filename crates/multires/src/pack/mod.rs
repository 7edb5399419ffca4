//! Compact encodings shared by the packed model and the file.

mod bit_words;
mod exact_positions;
mod packed_rows;
mod packed_table;
mod ranked_set;
mod short_lengths;
mod zigzag;

pub(crate) use exact_positions::ExactPositions;
pub(crate) use packed_table::PackedTable;
pub(crate) use ranked_set::RankedSet;
pub(crate) use short_lengths::{ERRORS, MIN_ERROR, error9, error16, radius8, radius16};
pub(crate) use zigzag::{unzigzag, zigzag};
