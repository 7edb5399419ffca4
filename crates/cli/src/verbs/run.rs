//! `run`: does what a recipe says.

use std::path::PathBuf;

use clap::Args;

use crate::recipe::Recipe;
use crate::session::failure::Failure;

/// Run a recipe: a verb with its options, in TOML or JSON
///
/// Keys are the long names of the options, and verb, input and output: verb = "simplify", ratio =
/// "10%", measured = true. Paths in a recipe are relative to its folder.
#[derive(Args)]
pub struct Run {
    /// Recipe, a .toml or .json file, or its JSON itself, in braces
    #[arg(value_name = "RECIPE")]
    recipe: PathBuf,
    /// Paths in place of those of the recipe, in the order of the verb: mostly IN OUT
    #[arg(value_name = "PATH")]
    pub paths: Vec<PathBuf>,
}

impl Run {
    /// Reads the recipe.
    pub fn recipe(&self) -> Result<Recipe, Failure> {
        Recipe::read(&self.recipe)
    }
}
