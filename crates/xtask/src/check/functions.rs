//! Checks that long functions give a reason for their length.

use std::collections::{BTreeMap, BTreeSet};

use crate::check::modules::Crate;
use crate::check::source::Source;

/// Number of lines above which a function must give a reason.
const LONG: usize = 60;
/// Start of the comment line above a function that gives the reason.
const REASON: &str = "Long because ";
/// Sources of the crate that is in no folder of `crates`.
const PYTHON: &str = "py/src/";

/// A function: its name, and its first and last line, from 1.
#[derive(Debug, PartialEq)]
struct Function<'s> {
    name: &'s str,
    lines: [usize; 2],
}

/// Returns errors for functions outside tests of more than 60 lines, unless a line of the comment
/// above them begins with `Long because `.
pub fn check(sources: &[Source], crates: &[Crate<'_>]) -> Vec<String> {
    let modules = crates.iter().flat_map(|krate| &krate.modules).map(|module| module.file);
    let modules: BTreeSet<&str> = modules.collect();
    let counts = |path: &str| modules.contains(path) || path.starts_with(PYTHON);
    let mut errors = Vec::new();
    for source in sources.iter().filter(|source| counts(&source.path)) {
        for Function { name, lines: [first, last] } in unexcused(source) {
            let what = format!("{}:{first}: `{name}` has {} lines", source.path, last - first + 1);
            errors.push(format!("{what}: divide it, or say above it `// {REASON}…`"));
        }
    }
    errors
}

/// Iterates over the long functions of a source that give no reason.
fn unexcused(source: &Source) -> impl Iterator<Item = Function<'_>> {
    let comments: BTreeMap<usize, &str> =
        source.comments.iter().map(|piece| (piece.line, piece.text.as_str())).collect();
    let code: Vec<&str> = source.code.lines().collect();
    let is_long = |function: &Function<'_>| function.lines[1] - function.lines[0] >= LONG;
    functions(&source.code).into_iter().filter(is_long).filter(move |function| {
        let above = (1..function.lines[0]).rev().map_while(|line| match comments.get(&line) {
            Some(comment) => Some(*comment),
            None => code[line - 1].trim_start().starts_with("#[").then_some(""),
        });
        let mut texts = above.map(|comment| comment.trim_start_matches('/').trim_start());
        !texts.any(|text| text.starts_with(REASON))
    })
}

/// Lists the functions with a body in code without comments and literals, inner ones, too.
fn functions(code: &str) -> Vec<Function<'_>> {
    let line_of = |at: usize| code[..at].matches('\n').count() + 1;
    let is_in_word = |c: char| c.is_alphanumeric() || c == '_';
    let mut functions = Vec::new();
    for (at, _) in code.match_indices("fn ") {
        let rest = &code[at + 3..];
        let name = &rest[..rest.find(|c: char| !is_in_word(c)).unwrap_or(rest.len())];
        if name.is_empty() || code[..at].ends_with(is_in_word) {
            continue;
        }
        if let Some(len) = body(rest) {
            functions.push(Function { name, lines: [at, at + 3 + len].map(line_of) });
        }
    }
    functions
}

/// Returns where the body of a function ends, given the code from its name; `None` without a body.
fn body(code: &str) -> Option<usize> {
    let (mut brackets, mut braces) = (0i32, 0i32);
    for (at, c) in code.char_indices() {
        match c {
            '(' | '[' => brackets += 1,
            ')' | ']' => brackets -= 1,
            '{' => braces += 1,
            '}' => braces -= 1,
            _ => {}
        }
        if brackets == 0 && braces == 0 && (c == ';' || c == '}') {
            return (c == '}').then_some(at);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::modules::crates;
    use crate::project::Text;

    fn errors(path: &str, above: &str, lines: usize) -> Vec<String> {
        let body = "    x(|| [1; 3]);\n".repeat(lines - 2);
        let text = format!("struct A;\n{above}pub fn long(a: [u8; 3]) -> u8 {{\n{body}}}\n");
        let root = Text { path: "crates/a/src/lib.rs".into(), text: String::new() };
        let sources = [Source::new(&root), Source::new(&Text { path: path.into(), text })];
        check(&sources, &crates(&sources))
    }

    #[test]
    fn long_functions_are_errors() {
        let path = "crates/a/src/b.rs";
        assert_eq!(errors(path, "", 60), [""; 0]);
        let expected = "crates/a/src/b.rs:2: `long` has 61 lines: divide it, or say above it \
                        `// Long because …`";
        assert_eq!(errors(path, "", 61), [expected]);
        assert_eq!(errors("crates/a/tests/b.rs", "", 61), [""; 0]);
        assert_eq!(errors("py/src/b.rs", "", 61).len(), 1);
    }

    #[test]
    fn a_reason_right_above_excuses_length() {
        for above in ["// Long because: no\n", "/// Long because it is a table.\n\n"] {
            assert_eq!(errors("crates/a/src/b.rs", above, 61).len(), 1, "{above}");
        }
        for above in [
            "// Long because it is a table.\n",
            "/// Returns it.\n///\n/// Long because it is a table.\n#[inline]\n",
        ] {
            assert_eq!(errors("crates/a/src/b.rs", above, 61), [""; 0], "{above}");
        }
    }

    #[test]
    fn functions_end_with_their_bodies() {
        let code =
            "fn a() {\n  fn b(f: fn(u8)) where T: X {}\n}\ntrait T { fn c();\n fn d() {\n\n} }";
        let found = functions(code);
        let found: Vec<_> = found.iter().map(|f| (f.name, f.lines)).collect();
        assert_eq!(found, [("a", [1, 3]), ("b", [2, 2]), ("d", [5, 7])]);
    }
}
