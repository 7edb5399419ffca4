//! The laboratory: measures what docs/RESULTS.md and the notes show, beside other programs.
//!
//! `cargo xtask results` and four other verbs start it. Read in this order:
//!
//! | module | what it holds |
//! |---|---|
//! | `page` | the page of results: its sections, and how some of them are remade |
//! | `table`, `plot` | tables in Markdown, plots in SVG |
//! | `command`, `folders`, `machine` | the program that is measured, where, and on what |
//! | `accuracy`, `volume`, `constriction`, `textured`, `parts` | what levels are like |
//! | `hard` | what is left of flats without an error, and of tunnels |
//! | `bounds` | what levels within a proved error are like, and cost |
//! | `speed`, `memory`, `reading` | what levels cost |
//! | `check`, `contacts` | defects and contacts |
//! | `levels`, `strips`, `compression`, `flock`, `tiles` | one section for each of the other crates |
//! | `compare` | meshoptimizer in alternating rounds, by the verb of this name alone |

mod accuracy;
mod bounds;
mod check;
mod command;
mod compare;
mod compression;
mod constriction;
mod contacts;
mod flock;
mod folders;
mod hard;
mod levels;
mod machine;
mod memory;
mod page;
mod parts;
mod plot;
mod reading;
mod speed;
mod strips;
mod table;
mod textured;
mod tiles;
mod volume;

use std::process::ExitCode;

use anyhow::Result;

const USAGE: &str = "usage: lab VERB
  results [SECTION...]  remake docs/RESULTS.md, or only the sections with such titles
  policies             draw and measure fish of several parts by each policy for contacts, in docs/notes/contacts
  textured [MODEL...]  compare image errors of levels with meshoptimizer's
  parts [--program PATH] [TABLE...]  measure models of many parts, or only these tables:
                       bare, textured, extent, maximum, scenes, hubs
  tiles [--program PATH] [--large] [MODEL...]  measure tilesets, with --large one of 10⁸ faces too
  compare [--meshes NAME,...] [--ratios 10%,...] [--rounds N] [--json]
                       compare speed, distance and volume with meshoptimizer's simplify with update";

/// Runs the verb that the first argument names, with the others, and prints what it measures.
pub fn lab(arguments: &[String]) -> ExitCode {
    let Some(outcome) = arguments.split_first().and_then(|(verb, rest)| run(verb, rest)) else {
        eprintln!("{USAGE}");
        return ExitCode::from(2);
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

/// Runs a verb; `None` for one that there is not.
fn run(verb: &str, arguments: &[String]) -> Option<Result<()>> {
    Some(match verb {
        "results" => page::run(arguments),
        "policies" => contacts::policies::run(),
        "textured" => textured::print(arguments),
        "parts" => parts::run(arguments),
        "tiles" => tiles::run(arguments),
        "compare" => compare::run(arguments),
        _ => return None,
    })
}
