//! `run`: does what a recipe says.

use std::path::PathBuf;

use clap::Args;

use crate::args::GlobalArgs;
use crate::command::VerbLine;
use crate::failure::Failure;
use crate::recipe::Recipe;

/// Run a recipe: a verb with its options in a TOML or JSON file. Keys are the long names of the
/// options, and verb, input and output: verb = "simplify", ratio = "10%", measured = true. Paths in a
/// recipe are relative to its folder
#[derive(Args)]
pub struct Run {
    /// Recipe, a .toml or .json file, or its JSON itself, in braces
    #[arg(value_name = "RECIPE")]
    recipe: PathBuf,
    /// Paths in place of those of the recipe, in the order of the verb: mostly IN OUT
    #[arg(value_name = "PATH")]
    paths: Vec<PathBuf>,
}

impl Run {
    /// Returns the command line that the recipe stands for; global options that are given with
    /// `run` come before those of the recipe.
    pub fn line(&self, global: GlobalArgs) -> Result<VerbLine, Failure> {
        let line = Recipe::read(&self.recipe)?.line(&self.paths)?;
        Ok(VerbLine { global: global.or(line.global), ..line })
    }
}
