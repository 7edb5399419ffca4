//! `cargo xtask check`: rules of the house that no compiler knows.

mod arrows;
mod lengths;
mod references;

use anyhow::{Result, bail};

use crate::project::Project;

pub use references::keys_of;

/// Runs all checks and prints what they find; fails where anything is an error.
pub fn run(project: &Project) -> Result<()> {
    let sources = project.files(".", ".rs")?;
    let lengths = lengths::check(&sources);
    for note in &lengths.notes {
        println!("note: {note}");
    }
    let mut errors = lengths.errors;
    let pages = project.files(".", ".md")?;
    errors.extend(references::check(&sources, &pages));
    errors.extend(arrows::check(&project.files("crates", "Cargo.toml")?)?);
    for error in &errors {
        println!("error: {error}");
    }
    if !errors.is_empty() {
        bail!("{} found by the checks", errors.len());
    }
    println!("checked {} sources and {} pages", sources.len(), pages.len());
    Ok(())
}
