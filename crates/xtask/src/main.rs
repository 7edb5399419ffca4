//! `cargo xtask VERB`: checks and documentation of the project itself, and the way to its figures.
#![forbid(unsafe_code)]

mod book;
mod check;
mod doc;
mod instructions;
mod lab;
mod project;

use std::process::ExitCode;

use project::Project;

const USAGE: &str = "usage: cargo xtask VERB
  check    check references, arrows between crates, imports, names of types, phrases, lengths of files
           and functions, and the links of the book
  book [CHAPTER...] [--write] [--python PATH] [--program PATH]
           run what the chapters of docs/book show and compare what it prints and draws, or write that
           into them
  doc [OPTION...]
           build the documentation of all crates, with more options of cargo; warnings are errors
  instructions [--program PATH] [--write]
           count the instructions of commands and compare them with docs/notes/instructions.md
These run in the laboratory, the program `lab` of the crate bench, which is built first:
  results [SECTION...]  remake docs/RESULTS.md, or only the sections with such titles
  policies             draw and measure fish of several parts by each policy for contacts, in docs/notes/contacts
  textured [MODEL...]  compare image errors of levels with meshoptimizer's
  parts [--program PATH] [TABLE...]  measure models of many parts, or only these tables:
                       bare, textured, extent, maximum, scenes, hubs
  tiles [--program PATH] [--large] [MODEL...]  measure tilesets, with --large one of 10⁸ faces too
  compare [--meshes NAME,...] [--ratios 10%,...] [--rounds N] [--json]
                       compare speed, distance and volume with meshoptimizer's simplify with update";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (verb, rest) = match arguments.split_first() {
        Some((verb, rest)) => (verb.as_str(), rest),
        None => ("", &[][..]),
    };
    let project = Project::here();
    let outcome = match verb {
        "book" => book::run(&project, rest),
        "check" => check::run(&project),
        "doc" => doc::run(&project, rest),
        "instructions" => instructions::run(&project, rest),
        _ if lab::VERBS.contains(&verb) => lab::run(&project, &arguments),
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
