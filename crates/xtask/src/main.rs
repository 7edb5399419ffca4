//! `cargo xtask VERB`: checks, documentation and measurements of the project itself.
#![forbid(unsafe_code)]

mod book;
mod check;
mod compare;
mod doc;
mod project;
mod results;
mod table;

use std::process::ExitCode;

use project::Project;

const USAGE: &str = "usage: cargo xtask VERB
  check    check references, arrows between crates, imports, names of types, phrases, lengths of files,
           and the links of the book
  book [CHAPTER...] [--write] [--python PATH] [--program PATH]
           run what the chapters of docs/book show and compare what it prints and draws, or write that
           into them
  doc      build the documentation of all crates; warnings are errors
  results [SECTION...]  remake docs/RESULTS.md, or only the sections with such titles
  policies             draw and measure fish of several parts by each policy for contacts, in docs/notes/contacts
  textured [MODEL...]  compare image errors of levels with meshoptimizer's
  parts [--program PATH] [TABLE...]  measure models of many parts, or only these tables:
                       bare, textured, extent, maximum, scenes, hubs
  compare [--meshes NAME,...] [--ratios 10%,...] [--rounds N] [--json]
                       compare speed, distance and volume with meshoptimizer's simplify with update";

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let verb = arguments.next();
    let project = Project::here();
    let outcome = match verb.as_deref() {
        Some("book") => book::run(&project, &arguments.collect::<Vec<_>>()),
        Some("check") => check::run(&project),
        Some("compare") => compare::run(&arguments.collect::<Vec<_>>()),
        Some("doc") => doc::run(&project),
        Some("results") => results::run(&project, &arguments.collect::<Vec<_>>()),
        Some("policies") => results::policies(&project),
        Some("parts") => results::parts(&project, &arguments.collect::<Vec<_>>()),
        Some("textured") => results::textured(&arguments.collect::<Vec<_>>()),
        _ => {
            eprintln!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
