//! Recipes as text: the keys of a TOML or JSON file, with their values and lines.

use std::fmt;
use std::ops::Range;

use serde_json::Value;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Syntax of a recipe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Syntax {
    Toml,
    Json,
}

/// A key of a recipe with its value.
#[derive(Debug, PartialEq)]
pub struct Entry {
    pub key: String,
    /// Line of the key, from 1.
    pub line: usize,
    pub value: Given,
}

/// Value of a key.
#[derive(Debug, PartialEq)]
pub enum Given {
    /// `true` or `false`.
    Flag(bool),
    /// A string or a number, as on the command line.
    Text(String),
    /// A list of these.
    List(Vec<String>),
}

/// Error of a recipe, with its line.
#[derive(Debug, PartialEq)]
pub struct Fault {
    pub line: usize,
    pub reason: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.reason)
    }
}

/// Reads the keys of a recipe, in the order of their lines.
///
/// # Errors
/// Wrong syntax, keys that are there twice, and values that no option has.
pub fn entries(text: &str, syntax: Syntax) -> Result<Vec<Entry>, Fault> {
    match syntax {
        Syntax::Toml => toml_entries(text),
        Syntax::Json => json_entries(text),
    }
}

fn toml_entries(text: &str) -> Result<Vec<Entry>, Fault> {
    let line_of = |span: Range<usize>| line_at(text, span.start);
    let table = DeTable::parse(text).map_err(|error| Fault {
        line: error.span().map_or(1, line_of),
        reason: error.message().to_owned(),
    })?;
    let entry = |(key, value): (&Spanned<_>, &Spanned<DeValue<'_>>)| {
        let (key, line) = (String::from(AsRef::<str>::as_ref(key.get_ref())), line_of(key.span()));
        let value = toml_value(value.get_ref()).ok_or_else(|| unfit(&key, line))?;
        Ok(Entry { key, line, value })
    };
    let mut entries: Vec<Entry> = table.get_ref().iter().map(entry).collect::<Result<_, _>>()?;
    entries.sort_by_key(|entry| entry.line);
    Ok(entries)
}

fn toml_value(value: &DeValue<'_>) -> Option<Given> {
    match value {
        DeValue::Boolean(flag) => Some(Given::Flag(*flag)),
        DeValue::Array(values) => {
            let texts = values.iter().map(|value| toml_text(value.get_ref()));
            texts.collect::<Option<_>>().map(Given::List)
        }
        value => toml_text(value).map(Given::Text),
    }
}

fn toml_text(value: &DeValue<'_>) -> Option<String> {
    match value {
        DeValue::String(text) => Some(text.to_string()),
        DeValue::Integer(number) if number.radix() == 10 => Some(number.as_str().to_owned()),
        DeValue::Float(number) => Some(number.as_str().to_owned()),
        _ => None,
    }
}

fn json_entries(text: &str) -> Result<Vec<Entry>, Fault> {
    let value: Value = serde_json::from_str(text).map_err(|error| {
        let place = format!(" at line {} column {}", error.line(), error.column());
        Fault { line: error.line().max(1), reason: error.to_string().replace(&place, "") }
    })?;
    let Value::Object(object) = value else {
        return Err(Fault { line: 1, reason: "a recipe is a JSON object".into() });
    };
    let keys = json_keys(text);
    let twice = |(at, (key, _)): &(usize, &(String, usize))| {
        keys[..*at].iter().any(|(other, _)| other == key)
    };
    if let Some((_, (key, line))) = keys.iter().enumerate().find(twice) {
        return Err(Fault { line: *line, reason: format!("{key} is there twice") });
    }
    let entry = |((key, value), (_, line)): ((String, Value), &(String, usize))| {
        let value = json_value(&value).ok_or_else(|| unfit(&key, *line))?;
        Ok(Entry { key, line: *line, value })
    };
    // Objects keep the order of the text.
    object.into_iter().zip(&keys).map(entry).collect()
}

fn json_value(value: &Value) -> Option<Given> {
    match value {
        Value::Bool(flag) => Some(Given::Flag(*flag)),
        Value::Array(values) => {
            values.iter().map(json_text).collect::<Option<_>>().map(Given::List)
        }
        value => json_text(value).map(Given::Text),
    }
}

fn json_text(value: &Value) -> Option<String> {
    match value {
        Value::String(text) => Some(text.clone()),
        Value::Number(number) => Some(number.to_string()),
        _ => None,
    }
}

/// Finds the keys of the outermost object of valid JSON, with their lines.
fn json_keys(text: &str) -> Vec<(String, usize)> {
    let bytes = text.as_bytes();
    let (mut keys, mut depth, mut at) = (Vec::new(), 0, 0);
    while at < bytes.len() {
        match bytes[at] {
            b'{' | b'[' => depth += 1,
            b'}' | b']' => depth -= 1,
            b'"' => {
                let end = string_end(bytes, at);
                let is_key = depth == 1 && text[end..].trim_start().starts_with(':');
                if let (true, Ok(key)) = (is_key, serde_json::from_str(&text[at..end])) {
                    keys.push((key, line_at(text, at)));
                }
                at = end;
                continue;
            }
            _ => {}
        }
        at += 1;
    }
    keys
}

/// Returns the end of the JSON string that begins at `start`.
fn string_end(bytes: &[u8], start: usize) -> usize {
    let mut at = start + 1;
    while at < bytes.len() && bytes[at] != b'"' {
        at += if bytes[at] == b'\\' { 2 } else { 1 };
    }
    (at + 1).min(bytes.len())
}

fn unfit(key: &str, line: usize) -> Fault {
    let reason = format!("{key} must be a string, a number, true, false or a list of strings");
    Fault { line, reason }
}

fn line_at(text: &str, at: usize) -> usize {
    1 + text.as_bytes()[..at.min(text.len())].iter().filter(|&&byte| byte == b'\n').count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_syntaxes_say_the_same() {
        let toml = "verb = 'simplify'\nratio = '10%'\nmeasured = true\n\nboundary = 2.50\n\
            faces = 1_000\nlevels = ['50%', 10]\n";
        let json = "{\"verb\": \"simplify\",\n\"ratio\": \"10%\", \n\"measured\":\ntrue,\n\
            \"boundary\": 2.5,\n\"faces\": 1000,\n\"levels\": [\"50%\", 10]}";
        let [toml, json] = [(toml, Syntax::Toml), (json, Syntax::Json)]
            .map(|(text, syntax)| entries(text, syntax).unwrap());
        let lines = |entries: &[Entry]| entries.iter().map(|e| e.line).collect::<Vec<_>>();
        assert_eq!((lines(&toml), lines(&json)), (vec![1, 2, 3, 5, 6, 7], vec![1, 2, 3, 5, 6, 7]));
        for (toml, json) in toml.iter().zip(&json).filter(|(toml, _)| toml.key != "boundary") {
            assert_eq!((&toml.key, &toml.value), (&json.key, &json.value));
        }
        assert_eq!(json[5].value, Given::List(vec!["50%".into(), "10".into()]));
        assert_eq!(toml[3].value, Given::Text("2.50".into()));
    }

    #[test]
    fn errors_have_lines() {
        let cases = [
            ("a = 1\nb = \n", Syntax::Toml, 2),
            ("a = 1\n\na = 2\n", Syntax::Toml, 3),
            ("a = 1\n[b]\nc = 2\n", Syntax::Toml, 2),
            ("a = 1979-05-27\n", Syntax::Toml, 1),
            ("{\"a\": 1,\n\"b\": }", Syntax::Json, 2),
            ("{\"a\": \"}\\\"\",\n\n\"\\u0061\": 2}", Syntax::Json, 3),
            ("{\n\"a\": null}", Syntax::Json, 2),
            ("{\n\"a\": {\"b\": 1}}", Syntax::Json, 2),
            ("[1]", Syntax::Json, 1),
            ("", Syntax::Json, 1),
        ];
        for (text, syntax, line) in cases {
            let fault = entries(text, syntax).unwrap_err();
            assert_eq!(fault.line, line, "{text:?}: {fault}");
            assert!(!fault.reason.contains(" at line "), "{fault}");
        }
    }
}
