//! Hard surfaces: what is flat goes without an error, and tunnels close.

mod lossless;
mod tunnels;

use anyhow::Result;

use super::command::Program;

/// Returns the tables of hard surfaces.
pub fn section() -> Result<String> {
    let program = Program::build()?;
    Ok(format!("{}{}", lossless::table(&program)?, tunnels::table(&program)?))
}
