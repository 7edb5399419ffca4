//! How a file of a batch went, as a row of a table and as JSON.

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::batch::file::FileState;
use crate::batch::plan::FileJob;
use crate::session::files;

/// State of a file in a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// Nothing was tried yet.
    Planned,
    Done,
    /// It was there already.
    Skipped,
    /// It was written, but `--strict` asked for a target that was missed.
    Missed,
    Failed,
}

impl Status {
    pub const ALL: [Self; 5] =
        [Self::Planned, Self::Done, Self::Skipped, Self::Missed, Self::Failed];

    pub fn name(self) -> &'static str {
        match self {
            Self::Planned => "planned",
            Self::Done => "done",
            Self::Skipped => "skipped",
            Self::Missed => "missed",
            Self::Failed => "failed",
        }
    }

    /// Returns the words for a number of such files.
    pub fn words(self) -> &'static str {
        match self {
            Self::Planned => "to do",
            Self::Skipped => "there already",
            Self::Missed => "missed their target",
            Self::Done | Self::Failed => self.name(),
        }
    }
}

/// How one file went.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FileReport {
    pub input: String,
    pub output: String,
    pub status: Status,
    pub error: Option<String>,
    pub warnings: Vec<String>,
    pub seconds: f64,
    /// State of the output after it was written.
    pub bytes: Option<u64>,
    pub changed_ns: Option<u64>,
    /// State of the input before it was read.
    pub input_bytes: Option<u64>,
    pub input_changed_ns: Option<u64>,
    /// Object that the verb prints with `--json`.
    pub result: Option<Value>,
}

/// Columns of the table, with the place of each in the JSON of a report.
const COLUMNS: [(&str, &[&str]); 12] = [
    ("input", &["/input"]),
    ("output", &["/output"]),
    ("status", &["/status"]),
    ("input_faces", &["/result/input_faces"]),
    ("output_faces", &["/result/output_faces", "/result/faces"]),
    ("error_estimate", &["/result/error_estimate"]),
    ("error_measured", &["/result/error_measured/max"]),
    ("error_proved", &["/result/error_proved"]),
    ("seconds", &["/seconds"]),
    ("bytes", &["/bytes"]),
    ("warnings", &["/warnings"]),
    ("error", &["/error"]),
];

/// Formats reports as a table: CSV, or JSON with all that is known.
pub fn table(reports: &[FileReport], as_json: bool) -> String {
    let rows: Vec<Value> = reports.iter().map(|report| json!(report)).collect();
    if as_json {
        return format!("{:#}\n", Value::Array(rows));
    }
    let head = COLUMNS.map(|(name, _)| name.to_owned());
    let row = |row: &Value| {
        let found = |places: &[&str]| places.iter().find_map(|place| row.pointer(place)).map(field);
        COLUMNS.map(|(_, places)| found(places).unwrap_or_default())
    };
    let lines = std::iter::once(head).chain(rows.iter().map(row));
    lines.map(|fields| fields.join(",") + "\n").collect()
}

/// Formats a value as a field of CSV, with quotes where it needs them.
fn field(value: &Value) -> String {
    let text = match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Array(texts) => {
            texts.iter().filter_map(Value::as_str).collect::<Vec<_>>().join("; ")
        }
        other => other.to_string(),
    };
    match text.contains(['"', ',', '\n', '\r']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text,
    }
}

impl FileReport {
    /// Creates the report of a file before anything is known about it.
    pub fn planned(job: &FileJob) -> Self {
        Self {
            input: files::name(&job.input),
            output: files::name(&job.output),
            status: Status::Planned,
            error: None,
            warnings: Vec::new(),
            seconds: 0.0,
            bytes: None,
            changed_ns: None,
            input_bytes: None,
            input_changed_ns: None,
            result: None,
        }
    }

    /// Returns a message that says which file it is about.
    pub fn placed(&self, line: &str) -> String {
        match line.contains(&self.input) || line.contains(&self.output) {
            true => line.to_owned(),
            false => format!("{}: {line}", self.input),
        }
    }

    /// Notes the state of the input before it was read.
    pub fn set_input(&mut self, state: Option<FileState>) {
        self.input_bytes = state.map(|state| state.bytes);
        self.input_changed_ns = state.map(|state| state.changed_ns);
    }

    /// Notes the state of the output after it was written.
    pub fn set_output(&mut self, state: Option<FileState>) {
        self.bytes = state.map(|state| state.bytes);
        self.changed_ns = state.map(|state| state.changed_ns);
    }

    /// Returns whether input and output were in these states.
    pub fn is_of(&self, [input, output]: [FileState; 2]) -> bool {
        let bytes = [self.input_bytes, self.bytes] == [input.bytes, output.bytes].map(Some);
        let changed = [input.changed_ns, output.changed_ns].map(Some);
        bytes && [self.input_changed_ns, self.changed_ns] == changed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report() -> FileReport {
        let job = FileJob { input: "in/a, \"b\".ply".into(), output: "out/a.ply".into() };
        FileReport {
            status: Status::Done,
            result: Some(json!({ "input_faces": 10, "output_faces": 5, "error_estimate": 0.5 })),
            warnings: vec!["one".into(), "two\nlines".into()],
            seconds: 0.25,
            bytes: Some(3),
            changed_ns: Some(1),
            input_bytes: Some(7),
            input_changed_ns: Some(u64::MAX),
            ..FileReport::planned(&job)
        }
    }

    #[test]
    fn a_report_comes_back_from_json() {
        let report = report();
        let text = json!(report).to_string();
        assert_eq!(serde_json::from_str::<FileReport>(&text).unwrap(), report);
        assert!(serde_json::from_str::<FileReport>(r#"{ "input": "a" }"#).is_err());
        assert!(serde_json::from_str::<FileReport>("[]").is_err());
    }

    #[test]
    fn a_table_quotes_what_would_break_it() {
        let table = table(&[report()], false);
        let expected =
            "\"in/a, \"\"b\"\".ply\",out/a.ply,done,10,5,0.5,,,0.25,3,\"one; two\nlines\",\n";
        assert_eq!(table.split_once('\n').unwrap().1, expected);
    }
}
