//! Hard surfaces: what is flat goes without an error, tunnels close, and many parts cost little more
//! than one.

mod lossless;
mod speed;
mod tunnels;

use anyhow::Result;

use super::command::Program;

/// Returns the tables of hard surfaces.
pub fn section() -> Result<String> {
    let program = Program::build()?;
    let tables = [
        ("Lossless", lossless::table(&program)?),
        ("Tunnels", tunnels::table(&program)?),
        ("Speed on parts", speed::table()?),
    ];
    Ok(tables.map(|(title, table)| format!("### {title}\n\n{table}")).join("\n"))
}
