//! Splits Rust source into code, comments and string literals.

use crate::project::Text;

/// A Rust source file, split into code, comments and strings.
pub struct Source {
    /// Path of the file from the project's root, with slashes.
    pub path: String,
    /// Code with comments, literals and `#[cfg(test)]` items blanked, so that line numbers stay the
    /// same.
    pub code: String,
    /// Comments with their markers; each `//` line is a piece of its own.
    pub comments: Vec<Piece>,
    /// Contents of string literals as written, escapes included.
    pub strings: Vec<Piece>,
    /// Names of the `#[cfg(test)]` modules that are in files of their own.
    pub test_modules: Vec<String>,
}

/// A comment or string literal with its place in the file.
#[derive(Debug, PartialEq)]
pub struct Piece {
    /// Number of the line on which the piece begins, from 1.
    pub line: usize,
    /// The whole comment with its marker, or the text between the quotes of a string.
    pub text: String,
}

impl Source {
    /// Splits a Rust source file into code, comments and strings.
    pub fn new(file: &Text) -> Self {
        let mut lexer = Lexer { rest: &file.text, line: 1, ..Lexer::default() };
        lexer.run();
        let Lexer { mut code, comments, strings, .. } = lexer;
        let test_modules = blank_tests(&mut code);
        Self { path: file.path.clone(), code, comments, strings, test_modules }
    }
}

#[derive(Default)]
struct Lexer<'t> {
    rest: &'t str,
    line: usize,
    code: String,
    comments: Vec<Piece>,
    strings: Vec<Piece>,
}

impl Lexer<'_> {
    fn run(&mut self) {
        while let Some(c) = self.rest.chars().next() {
            let is_in_word = self.code.ends_with(|c: char| c.is_alphanumeric() || c == '_');
            if self.rest.starts_with("//") {
                let len = self.rest.find('\n').unwrap_or(self.rest.len());
                self.comment(len);
            } else if self.rest.starts_with("/*") {
                self.comment(block_comment(self.rest));
            } else if c == '"' {
                self.string(1, "\"", true);
            } else if let Some(hashes) = raw_string(self.rest).filter(|_| !is_in_word) {
                self.string(hashes + 2, &format!("\"{}", "#".repeat(hashes)), false);
            } else if let Some(len) = char_literal(self.rest) {
                self.blank(len);
            } else {
                self.code.push(c);
                self.line += usize::from(c == '\n');
                self.rest = &self.rest[c.len_utf8()..];
            }
        }
    }

    fn comment(&mut self, len: usize) {
        self.comments.push(Piece { line: self.line, text: self.rest[..len].to_owned() });
        self.blank(len);
    }

    /// Takes a string literal whose contents begin after `open` bytes and end with `close`.
    fn string(&mut self, open: usize, close: &str, has_escapes: bool) {
        let contents = &self.rest[open..];
        let mut len = 0;
        while len < contents.len() && !contents[len..].starts_with(close) {
            let is_escape = has_escapes && contents[len..].starts_with('\\');
            let mut chars = contents[len..].chars();
            len += chars.next().map_or(0, char::len_utf8);
            if is_escape {
                len += chars.next().map_or(0, char::len_utf8);
            }
        }
        self.strings.push(Piece { line: self.line, text: contents[..len].to_owned() });
        self.blank((open + len + close.len()).min(self.rest.len()));
    }

    /// Replaces the next `len` bytes with spaces, keeping line breaks.
    fn blank(&mut self, len: usize) {
        for c in self.rest[..len].chars() {
            self.code.push(if c == '\n' { '\n' } else { ' ' });
            self.line += usize::from(c == '\n');
        }
        self.rest = &self.rest[len..];
    }
}

/// Returns the length of the block comment at the start of `text`.
fn block_comment(text: &str) -> usize {
    let (mut depth, mut at) = (0, 0);
    while at < text.len() {
        let rest = &text[at..];
        if rest.starts_with("/*") {
            (depth, at) = (depth + 1, at + 2);
        } else if rest.starts_with("*/") {
            (depth, at) = (depth - 1, at + 2);
            if depth == 0 {
                break;
            }
        } else {
            at += rest.chars().next().map_or(1, char::len_utf8);
        }
    }
    at
}

/// Returns the number of hashes of the raw string at the start of `text`.
fn raw_string(text: &str) -> Option<usize> {
    let rest = text.strip_prefix('r')?;
    let hashes = rest.len() - rest.trim_start_matches('#').len();
    rest[hashes..].starts_with('"').then_some(hashes)
}

/// Returns the length of the character literal at the start of `text`, `None` for a lifetime.
fn char_literal(text: &str) -> Option<usize> {
    let rest = text.strip_prefix('\'')?;
    if let Some(escape) = rest.strip_prefix('\\') {
        let first = escape.chars().next()?.len_utf8();
        return Some(2 + first + escape[first..].find('\'')? + 1);
    }
    let c = rest.chars().next()?;
    rest[c.len_utf8()..].starts_with('\'').then(|| c.len_utf8() + 2)
}

/// Blanks every `#[cfg(test)]` item; returns the names of test modules without a body.
fn blank_tests(code: &mut String) -> Vec<String> {
    const MARK: &str = "#[cfg(test)]";
    let mut modules = Vec::new();
    while let Some(start) = code.find(MARK) {
        let len = MARK.len() + item(&code[start + MARK.len()..]);
        let test = &code[start..start + len];
        if let Some((_, name)) = test.strip_suffix(';').and_then(|test| test.split_once("mod ")) {
            modules.push(name.trim().to_owned());
        }
        let blank: String = test.chars().map(|c| if c == '\n' { c } else { ' ' }).collect();
        code.replace_range(start..start + len, &blank);
    }
    modules
}

/// Returns the length of the item at the start of `code`, up to its semicolon or closing brace.
fn item(code: &str) -> usize {
    let mut depth = 0;
    for (at, c) in code.char_indices() {
        match c {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            _ => {}
        }
        if depth == 0 && (c == ';' || c == '}') {
            return at + 1;
        }
    }
    code.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(text: &str) -> Source {
        Source::new(&Text { path: "a.rs".into(), text: text.into() })
    }

    fn texts(pieces: &[Piece]) -> Vec<(usize, &str)> {
        pieces.iter().map(|piece| (piece.line, piece.text.as_str())).collect()
    }

    #[test]
    fn comments_and_strings_are_set_apart_with_their_lines() {
        let found = source("let a = \"x // y\"; // one\n/* two /* three */\n*/ let b = 1;");
        assert_eq!(texts(&found.comments), [(1, "// one"), (2, "/* two /* three */\n*/")]);
        assert_eq!(texts(&found.strings), [(1, "x // y")]);
        assert_eq!(found.code.split_whitespace().collect::<String>(), "leta=;letb=1;");
        assert_eq!(found.code.lines().count(), 3);
    }

    #[test]
    fn strings_end_where_rust_ends_them() {
        let found = source("(\"a\\\"b\", r#\"c\"d\"#, b\"e\", 'f', '\"', '\\'', \"g\", for_r)");
        let expected = [(1, "a\\\"b"), (1, "c\"d"), (1, "e"), (1, "g")];
        assert_eq!(texts(&found.strings), expected);
    }

    #[test]
    fn lifetimes_are_code() {
        assert_eq!(source("fn f<'a>(x: &'a str) {}").code, "fn f<'a>(x: &'a str) {}");
    }

    #[test]
    fn test_items_are_left_out_of_the_code() {
        let text = "struct A;\n#[cfg(test)]\nmod tests {\n  struct B { x: u8 }\n}\n\
                    #[cfg(test)]\nuse x::{y, z};\n#[cfg(test)]\nfn f(_: [u8; 3]) {}\nstruct C;";
        let code = source(text).code;
        assert_eq!(
            code.split_whitespace().collect::<Vec<_>>(),
            ["struct", "A;", ";", "struct", "C;"]
        );
        assert_eq!(code.lines().count(), text.lines().count());
    }
}
