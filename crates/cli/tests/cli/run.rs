//! Runs of the program in a temporary folder.

use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use tempfile::TempDir;

/// Temporary folder in which the program runs.
pub struct Run {
    pub folder: TempDir,
}

/// Exit code and streams of a finished run.
pub struct Done {
    pub code: i32,
    pub out: Vec<u8>,
    pub err: String,
}

impl Run {
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().expect("a folder") }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_meshlod"));
        command.args(arguments).current_dir(self.folder.path());
        command
    }

    pub fn run(&self, arguments: &[&str]) -> Done {
        self.run_with(arguments, b"")
    }

    /// Runs the program with bytes on standard input.
    pub fn run_with(&self, arguments: &[&str], input: &[u8]) -> Done {
        let mut command = self.command(arguments);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().expect("the program starts");
        // The program may end without reading its input.
        let _ = child.stdin.take().expect("a pipe").write_all(input);
        Done::of(child.wait_with_output().expect("the program ends"))
    }

    /// Runs a command that must succeed, with `--json`, and returns the object.
    pub fn json(&self, arguments: &[&str]) -> Value {
        let done = self.run(&[arguments, &["--json"]].concat());
        assert_eq!(done.code, 0, "{arguments:?}: {done:?}");
        done.json()
    }

    /// Writes a sample to a file.
    pub fn sample(&self, sample: &str, faces: usize, file: &str) {
        let done = self.run(&["sample", sample, file, "--faces", &faces.to_string()]);
        assert_eq!(done.code, 0, "{done:?}");
    }

    /// Returns the sorted names of the files in the folder.
    pub fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.folder.path()).expect("a folder");
        let name = |entry: std::io::Result<std::fs::DirEntry>| entry.expect("a file").file_name();
        let mut names: Vec<String> =
            entries.map(|entry| name(entry).to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}

impl Done {
    fn of(output: Output) -> Self {
        Self {
            code: output.status.code().expect("no signal ended it"),
            out: output.stdout,
            err: String::from_utf8(output.stderr).expect("messages are text"),
        }
    }

    pub fn text(&self) -> &str {
        std::str::from_utf8(&self.out).expect("text")
    }

    /// Parses standard output as a single JSON object.
    pub fn json(&self) -> Value {
        let value: Value = serde_json::from_slice(&self.out).expect("JSON and nothing else");
        assert!(value.is_object(), "{value}");
        value
    }

    /// Returns true if standard output is empty or, with `--json`, has the object of a failure.
    pub fn has_no_answer(&self) -> bool {
        self.out.is_empty() || self.json()["failure"].is_object()
    }

    /// Returns the only line on standard error.
    pub fn only_line(&self) -> &str {
        let line = self.err.strip_suffix('\n').expect("a whole line");
        assert!(!line.contains('\n') && line.starts_with("meshlod: "), "{line}");
        line
    }
}

/// Standard output is cut after its first characters.
impl std::fmt::Debug for Done {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let out: String = String::from_utf8_lossy(&self.out).chars().take(2000).collect();
        write!(f, "code {}, out {out:?}, err {:?}", self.code, self.err)
    }
}
