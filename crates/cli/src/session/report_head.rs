//! Head of every JSON object on standard output, and the object that stands for a failure.
//!
//! docs/formats/json.md lists the keys of every verb.

use serde_json::{Map, Value};

use crate::session::failure::Failure;

/// Name of the format, under the key `format`.
const FORMAT: &str = "meshlod-report";

/// Version of the format: it grows when a key goes or changes its meaning, not when one is added.
const VERSION: u32 = 1;

/// Puts the head before the keys of a verb.
pub fn with_head(verb: &str, json: Value) -> Value {
    let mut all = head(Some(verb));
    match json {
        Value::Object(own) => all.extend(own),
        other => drop(all.insert("answer".into(), other)),
    }
    Value::Object(all)
}

/// Returns the object of a failure; the verb is unknown where the arguments could not be parsed.
pub fn of_failure(verb: Option<&str>, failure: &Failure) -> Value {
    let mut all = head(verb);
    all.insert("failure".into(), failure.to_json());
    all.insert("exit".into(), failure.exit_code().into());
    Value::Object(all)
}

fn head(verb: Option<&str>) -> Map<String, Value> {
    let entries: [(&str, Value); 3] =
        [("format", FORMAT.into()), ("version", VERSION.into()), ("verb", verb.into())];
    entries.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
}
