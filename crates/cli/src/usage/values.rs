//! Tips for values that an option does not take.

use clap::Error;
use clap::error::ContextKind;

use crate::usage::invalid;
use crate::usage::words::{VALUES, has};

/// Says which value was meant.
pub fn tip(error: &Error) -> Option<String> {
    let option = invalid(error, ContextKind::InvalidArg)?;
    let option = option.trim_start_matches('-').split(' ').next()?;
    let value = invalid(error, ContextKind::InvalidValue)?.to_lowercase();
    let is_row = |row: &&(&str, &str, &str)| row.0 == option && has(row.1, &value);
    VALUES.iter().find(is_row).map(|row| row.2.to_owned())
}
