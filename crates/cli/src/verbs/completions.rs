//! `completions`: what a shell needs to complete the command line.

use clap::{Args, Command};
use clap_complete::{Shell, generate};
use serde_json::json;

use crate::session::answer::Answer;
use crate::session::failure::Failure;

/// Print a script that completes verbs and options in a shell
///
/// For bash: meshlod completions bash > ~/.local/share/bash-completion/completions/meshlod
#[derive(Args)]
pub struct Completions {
    /// Shell that runs the script
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

impl Completions {
    /// Prints a script for the whole `command`.
    pub fn run(self, mut command: Command) -> Result<Answer, Failure> {
        let mut script = Vec::new();
        generate(self.shell, &mut command, "meshlod", &mut script);
        let script = String::from_utf8(script).map_err(Failure::new)?;
        let json = json!({ "shell": self.shell.to_string(), "script": script });
        Ok(Answer { is_output: true, ..Answer::new(json, script) })
    }
}
