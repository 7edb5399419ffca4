//! `cargo xtask check`: house rules that no compiler checks.

mod arrows;
mod circles;
mod lengths;
mod modules;
mod prose;
mod references;
mod source;
mod type_names;

use anyhow::{Result, bail};

use crate::project::Project;

pub use references::keys_of;

/// Environment variable that turns warnings into errors.
const STRICT: &str = "MESHLOD_STRICT";
/// Folder of the crate that re-exports the others.
const FACADE: &str = "meshlod";

/// Runs all checks and prints their findings; fails if any is an error.
pub fn run(project: &Project) -> Result<()> {
    let files = project.files(".", ".rs")?;
    let pages = project.files(".", ".md")?;
    let sources: Vec<_> = files.iter().map(source::Source::new).collect();
    let crates = modules::crates(&sources);
    let lengths = lengths::check(&files);
    let circles = circles::check(&crates);
    for note in lengths.notes.iter().chain(&circles.notes) {
        println!("note: {note}");
    }
    let mut errors = [lengths.errors, circles.errors].concat();
    errors.extend(references::check(&files, &pages));
    errors.extend(arrows::check(&project.files("crates", "Cargo.toml")?, &pages)?);
    // New rules, which older code does not follow yet.
    let warnings = [
        ("phrases", prose::check(&sources)),
        ("type names within a crate", type_names::check_crates(&crates)),
        ("public type names", type_names::check_facade(&crates, FACADE)),
    ];
    let is_strict = std::env::var_os(STRICT).is_some();
    for (rule, found) in warnings {
        if is_strict {
            errors.extend(found);
            continue;
        }
        for warning in &found {
            println!("warning: {warning}");
        }
        if !found.is_empty() {
            println!("warning: {rule}: {} findings, errors if {STRICT} is set", found.len());
        }
    }
    for error in &errors {
        println!("error: {error}");
    }
    if !errors.is_empty() {
        bail!("the checks found {} errors", errors.len());
    }
    println!("checked {} sources and {} pages", files.len(), pages.len());
    Ok(())
}
