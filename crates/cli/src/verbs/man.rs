//! `man`: manual pages, made of the same texts as the help.

use std::io;
use std::path::PathBuf;

use clap::{Args, Command};
use clap_mangen::Man as ManualPage;
use meshlod::io::write_file;
use serde_json::json;

use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;

/// Print the manual page, or write a page for each verb to a folder
///
/// For man to find them: meshlod man ~/.local/share/man/man1
#[derive(Args)]
pub struct Man {
    /// Folder for meshlod.1, meshlod-simplify.1 and the others; created if missing
    #[arg(value_name = "DIR")]
    folder: Option<PathBuf>,
}

impl Man {
    /// Prints or writes the pages of the whole `command`.
    pub fn run(self, mut command: Command, session: &Session) -> Result<Answer, Failure> {
        command.build();
        let Some(folder) = self.folder else {
            let page = page(&command)?;
            let json = json!({ "page": page });
            return Ok(Answer { is_output: true, ..Answer::new(json, page) });
        };
        files::make_folder(&folder)?;
        session.progress.stage("writing manual pages");
        let mut written = Vec::new();
        let verbs = command.get_subcommands().filter(|verb| verb.get_name() != "help");
        for command in std::iter::once(&command).chain(verbs) {
            let name = command.get_display_name().unwrap_or(command.get_name());
            let path = folder.join(format!("{name}.1"));
            write_file(&path, page(command)?.as_bytes())?;
            written.push(files::name(&path));
        }
        let text = written.iter().map(|path| format!("{path}\n")).collect();
        Ok(Answer::new(json!({ "files": written }), text))
    }
}

/// Formats the manual page of the program or of a verb.
fn page(command: &Command) -> Result<String, Failure> {
    let mut page = Vec::new();
    ManualPage::new(command.clone())
        .render(&mut page)
        .map_err(|error: io::Error| Failure::new(format_args!("manual page: {error}")))?;
    String::from_utf8(page).map_err(Failure::new)
}
