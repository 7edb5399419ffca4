//! `cargo xtask check`: house rules that no compiler checks.

mod arrows;
mod circles;
mod folders;
mod functions;
mod lengths;
mod modules;
mod prose;
mod references;
mod source;
mod type_names;

use anyhow::{Result, bail};

use crate::book;
use crate::project::Project;

pub use references::keys_of;

/// Folder of the crate that re-exports the others.
const FACADE: &str = "meshlod";

/// Runs all checks and prints their findings; fails if any is an error.
pub fn run(project: &Project) -> Result<()> {
    let files = project.files(".", ".rs")?;
    let pages = project.files(".", ".md")?;
    let sources: Vec<_> = files.iter().map(source::Source::new).collect();
    let crates = modules::crates(&sources);
    let lengths = lengths::check(&files);
    let functions = functions::check(&sources, &crates);
    let circles = circles::check(&crates);
    for note in [lengths.notes, circles.notes, folders::check(&sources)].concat() {
        println!("note: {note}");
    }
    let mut errors = [lengths.errors, functions, circles.errors].concat();
    errors.extend(references::check(&files, &pages));
    let manifests = [project.files("crates", "Cargo.toml")?, project.files("py", "Cargo.toml")?];
    errors.extend(arrows::check(&manifests.concat(), &pages)?);
    errors.extend(book::check(project)?);
    errors.extend(prose::check(&sources));
    errors.extend(type_names::check_crates(&crates));
    errors.extend(type_names::check_facade(&crates, FACADE));
    for error in &errors {
        println!("error: {error}");
    }
    if !errors.is_empty() {
        bail!("the checks found {} errors", errors.len());
    }
    println!("checked {} sources and {} pages", files.len(), pages.len());
    Ok(())
}
