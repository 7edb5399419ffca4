//! How a file of a batch went, as a row of a table and as JSON.

use serde_json::{Value, json};

use crate::batch::file::FileState;
use crate::batch::plan::FileJob;
use crate::files;

/// State of a file in a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
#[derive(Clone, Debug, PartialEq)]
pub struct FileReport {
    pub input: String,
    pub output: String,
    pub status: Status,
    /// Object that the verb prints with `--json`.
    pub result: Option<Value>,
    pub error: Option<String>,
    pub warnings: Vec<String>,
    pub seconds: f64,
    /// State of the input before it was read.
    pub input_state: Option<FileState>,
    /// State of the output after it was written.
    pub output_state: Option<FileState>,
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
    let rows: Vec<Value> = reports.iter().map(FileReport::to_json).collect();
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
    /// Creates the report of a file of which nothing is known.
    pub fn planned(job: &FileJob) -> Self {
        Self {
            input: files::name(&job.input),
            output: files::name(&job.output),
            status: Status::Planned,
            result: None,
            error: None,
            warnings: Vec::new(),
            seconds: 0.0,
            input_state: None,
            output_state: None,
        }
    }

    /// Returns a message that says which file it is about.
    pub fn placed(&self, line: &str) -> String {
        match line.contains(&self.input) || line.contains(&self.output) {
            true => line.to_owned(),
            false => format!("{}: {line}", self.input),
        }
    }

    pub fn to_json(&self) -> Value {
        let [input, output] = [self.input_state, self.output_state];
        json!({
            "input": self.input,
            "output": self.output,
            "status": self.status.name(),
            "error": self.error,
            "warnings": self.warnings,
            "seconds": self.seconds,
            "bytes": output.map(|state| state.bytes),
            "changed_ns": output.map(|state| state.changed_ns),
            "input_bytes": input.map(|state| state.bytes),
            "input_changed_ns": input.map(|state| state.changed_ns),
            "result": self.result,
        })
    }

    /// Reads what [`Self::to_json`] wrote; `None` if it is anything else.
    pub fn from_json(json: &Value) -> Option<Self> {
        let text = |key: &str| json[key].as_str().map(str::to_owned);
        let state = |bytes: &str, changed: &str| {
            Some(FileState { bytes: json[bytes].as_u64()?, changed_ns: json[changed].as_u64()? })
        };
        let status = json["status"].as_str()?;
        let warnings = json["warnings"].as_array()?.iter().map(|line| line.as_str());
        Some(Self {
            input: text("input")?,
            output: text("output")?,
            status: Status::ALL.into_iter().find(|known| known.name() == status)?,
            result: Some(json["result"].clone()).filter(|result| !result.is_null()),
            error: text("error"),
            warnings: warnings.map(|line| line.map(str::to_owned)).collect::<Option<_>>()?,
            seconds: json["seconds"].as_f64()?,
            input_state: state("input_bytes", "input_changed_ns"),
            output_state: state("bytes", "changed_ns"),
        })
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
            input_state: Some(FileState { bytes: 7, changed_ns: u64::MAX }),
            output_state: Some(FileState { bytes: 3, changed_ns: 1 }),
            ..FileReport::planned(&job)
        }
    }

    #[test]
    fn a_report_comes_back_from_json() {
        let report = report();
        let text = report.to_json().to_string();
        assert_eq!(FileReport::from_json(&serde_json::from_str(&text).unwrap()), Some(report));
        assert_eq!(FileReport::from_json(&json!({ "input": "a" })), None);
        assert_eq!(FileReport::from_json(&json!([])), None);
    }

    #[test]
    fn a_table_quotes_what_would_break_it() {
        let table = table(&[report()], false);
        let expected =
            "\"in/a, \"\"b\"\".ply\",out/a.ply,done,10,5,0.5,,,0.25,3,\"one; two\nlines\",\n";
        assert_eq!(table.split_once('\n').unwrap().1, expected);
    }
}
