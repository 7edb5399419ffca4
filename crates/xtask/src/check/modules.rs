//! The modules of each crate, and the modules that each of them imports from.

use std::collections::BTreeSet;

use crate::check::source::Source;

/// The modules of a crate, without test modules.
pub struct Crate<'s> {
    /// Name of the crate's folder in `crates`.
    pub name: &'s str,
    /// Modules of the crate, one for each source file.
    pub modules: Vec<Module<'s>>,
}

/// A source file as a module of its crate.
pub struct Module<'s> {
    /// Path of the file from the root of the project.
    pub file: &'s str,
    /// Source code of the file without comments, literals and test items.
    pub code: &'s str,
    /// Module names from the crate's root; empty for the root.
    path: Vec<&'s str>,
    uses: Vec<Use>,
}

/// A name that a `use` declaration brings into scope.
pub struct Use {
    /// Imported path as written; it ends in `*` for a glob import.
    pub path: Vec<String>,
    /// Name by which the imported item is known in the importing module.
    pub name: String,
    is_public: bool,
}

/// Groups source files into crates; files outside `src` and test modules are left out.
pub fn crates(sources: &[Source]) -> Vec<Crate<'_>> {
    let mut crates: Vec<Crate<'_>> = Vec::new();
    for source in sources {
        let Some((name, path)) = place(&source.path) else { continue };
        let module = Module {
            file: &source.path,
            code: &source.code,
            path,
            uses: Parser::new(&source.code).uses(),
        };
        match crates.iter_mut().find(|krate| krate.name == name) {
            Some(krate) => krate.modules.push(module),
            None => crates.push(Crate { name, modules: vec![module] }),
        }
    }
    crates.retain(|krate| krate.modules.iter().any(|module| module.path.is_empty()));
    for Crate { name, modules } in &mut crates {
        let tests = sources.iter().filter_map(|source| Some((place(&source.path)?, source)));
        let tests: Vec<_> = tests
            .filter(|((of, _), _)| of == name)
            .flat_map(|((_, path), source)| {
                source.test_modules.iter().map(move |child| [&path[..], &[child.as_str()]].concat())
            })
            .collect();
        modules.retain(|module| !tests.iter().any(|test| module.path.starts_with(test)));
    }
    crates
}

/// Returns crate and module path of `crates/NAME/src/…`, `None` for other files.
fn place(path: &str) -> Option<(&str, Vec<&str>)> {
    let (name, file) = path.strip_prefix("crates/")?.split_once("/src/")?;
    let mut names: Vec<_> = file.strip_suffix(".rs")?.split('/').collect();
    let is_root = names == ["lib"] || names == ["main"];
    if is_root || names.last() == Some(&"mod") {
        names.pop();
    }
    Some((name, names))
}

impl Crate<'_> {
    /// Returns the crate's root module.
    pub fn root(&self) -> &Module<'_> {
        &self.modules[self.module(&[]).expect("each crate has one")]
    }

    /// Iterates over the names that the root module re-exports.
    pub fn public_uses(&self) -> impl Iterator<Item = &Use> {
        self.root().uses.iter().filter(|used| used.is_public)
    }

    /// Returns, for each module, the indices of the modules that define the names it imports with
    /// `use`.
    ///
    /// Re-exports are followed to the defining module and are no imports themselves.
    pub fn imports(&self) -> Vec<BTreeSet<usize>> {
        let imports = self.modules.iter().enumerate().map(|(at, module)| {
            let used = module.uses.iter().filter(|used| !used.is_public);
            used.filter_map(|used| self.resolve(&module.path, &used.path, 0))
                .filter(|&from| from != at)
                .collect()
        });
        imports.collect()
    }

    fn module(&self, path: &[&str]) -> Option<usize> {
        self.modules.iter().position(|module| module.path == path)
    }

    /// Finds the module that defines `path` as seen from module `from`; `None` outside this crate.
    fn resolve(&self, from: &[&str], path: &[String], reexports: usize) -> Option<usize> {
        const MAX_REEXPORTS: usize = 8;
        let mut names = from.to_vec();
        let mut rest = path;
        while let [first, others @ ..] = rest {
            match first.as_str() {
                "crate" => names.clear(),
                "self" => {}
                "super" => drop(names.pop()?),
                _ => break,
            }
            rest = others;
        }
        let is_relative = rest.len() == path.len();
        let mut here = self.module(&names)?;
        while let [first, others @ ..] = rest {
            names.push(first);
            let Some(child) = self.module(&names) else { break };
            (here, rest) = (child, others);
        }
        if is_relative && rest.len() == path.len() {
            return None;
        }
        let Some((item, others)) = rest.split_first() else { return Some(here) };
        let module = &self.modules[here];
        match module.uses.iter().find(|used| used.name == *item) {
            Some(used) if reexports < MAX_REEXPORTS => {
                let path = [&used.path, others].concat();
                self.resolve(&module.path, &path, reexports + 1)
            }
            _ => Some(here),
        }
    }
}

/// Parser of `use` declarations.
struct Parser<'c> {
    tokens: Vec<&'c str>,
    at: usize,
}

impl<'c> Parser<'c> {
    fn new(code: &'c str) -> Self {
        Self { tokens: tokens(code), at: 0 }
    }

    fn uses(mut self) -> Vec<Use> {
        let mut uses = Vec::new();
        while self.at < self.tokens.len() {
            let before = self.at.checked_sub(1).map(|at| self.tokens[at]);
            let is_use = self.take("use");
            // `use<'a>` is a bound of a type.
            if is_use && self.tokens.get(self.at) != Some(&"<") {
                let from = uses.len();
                self.tree(&[], &mut uses);
                let is_public = matches!(before, Some("pub" | ")"));
                uses[from..].iter_mut().for_each(|used| used.is_public = is_public);
            } else if !is_use {
                self.at += 1;
            }
        }
        uses
    }

    /// Parses one branch of a use tree below the path `above`.
    fn tree(&mut self, above: &[String], uses: &mut Vec<Use>) {
        let mut path = above.to_vec();
        self.take("::");
        if self.take("{") {
            while !self.take("}") && self.at < self.tokens.len() {
                self.tree(&path, uses);
                self.take(",");
            }
            return;
        }
        let Some(&name) = self.tokens.get(self.at) else { return };
        self.at += 1;
        if name != "self" || above.is_empty() {
            path.push(name.to_owned());
        }
        if self.tokens.get(self.at) == Some(&"::") {
            return self.tree(&path, uses);
        }
        let mut name = path.last().cloned().unwrap_or_default();
        if self.take("as") {
            name = self.tokens.get(self.at).copied().unwrap_or_default().to_owned();
            self.at += 1;
        }
        uses.push(Use { path, name, is_public: false });
    }

    fn take(&mut self, token: &str) -> bool {
        let is_next = self.tokens.get(self.at) == Some(&token);
        self.at += usize::from(is_next);
        is_next
    }
}

/// Splits code into words, `::`, and single characters.
fn tokens(code: &str) -> Vec<&str> {
    let mut tokens = Vec::new();
    let mut rest = code.trim_start();
    while let Some(first) = rest.chars().next() {
        let word = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
        let len = match word {
            0 if rest.starts_with("::") => 2,
            0 => first.len_utf8(),
            _ => word,
        };
        tokens.push(&rest[..len]);
        rest = rest[len..].trim_start();
    }
    tokens
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::project::Text;

    fn sources(files: &[(&str, &str)]) -> Vec<Source> {
        let texts = files.iter().map(|(path, text)| Text {
            path: format!("crates/a/src/{path}"),
            text: (*text).into(),
        });
        texts.map(|text| Source::new(&text)).collect()
    }

    /// Lists the files that the first file imports from.
    fn imports(files: &[(&str, &str)]) -> Vec<String> {
        let sources = sources(files);
        let crates = crates(&sources);
        let krate = &crates[0];
        let imports = krate.imports();
        let found = imports[0].iter().map(|&at| krate.modules[at].file);
        found.map(|file| file.replace("crates/a/src/", "")).collect()
    }

    #[test]
    fn files_are_modules() {
        assert_eq!(place("crates/a/src/lib.rs"), Some(("a", vec![])));
        assert_eq!(place("crates/a/src/b/mod.rs"), Some(("a", vec!["b"])));
        assert_eq!(place("crates/a/src/b/c.rs"), Some(("a", vec!["b", "c"])));
        for other in ["crates/a/src/b.txt", "crates/a/tests/b.rs", "fuzz/src/lib.rs"] {
            assert_eq!(place(other), None);
        }
    }

    #[test]
    fn modules_for_tests_are_left_out() {
        let files =
            [("lib.rs", "mod b;"), ("b.rs", "#[cfg(test)]\nmod scenes;\n#[cfg(test)] mod tests;")];
        let scenes =
            [("b/scenes/mod.rs", ""), ("b/scenes/x.rs", ""), ("b/tests.rs", ""), ("tests.rs", "")];
        let sources = sources(&[&files[..], &scenes].concat());
        let crates = crates(&sources);
        let files: Vec<_> = crates[0].modules.iter().map(|module| module.file).collect();
        assert_eq!(files, ["crates/a/src/lib.rs", "crates/a/src/b.rs", "crates/a/src/tests.rs"]);
    }

    #[test]
    fn trees_are_read_to_their_leaves() {
        let code =
            "pub(crate) use a::{b::C, d::{self, E as F}, g::*};\nfn f() -> impl T + use<'a> {}";
        let uses = Parser::new(code).uses();
        let found: Vec<_> = uses.iter().map(|used| (used.path.join("::"), &*used.name)).collect();
        let expected = [("a::b::C", "C"), ("a::d", "d"), ("a::d::E", "F"), ("a::g::*", "*")];
        assert_eq!(found, expected.map(|(path, name)| (path.to_owned(), name)));
        assert!(uses.iter().all(|used| used.is_public));
    }

    #[test]
    fn imports_lead_to_the_file_that_defines() {
        let files = [
            ("b/c.rs", "use super::D;\nuse crate::e::{F, Inner::G};\nuse std::fmt;"),
            ("lib.rs", "mod b;\nmod e;"),
            ("b/mod.rs", "mod c;\nmod d;\npub use self::d::D;"),
            ("b/d.rs", "pub struct D;"),
            ("e.rs", "pub struct F;"),
        ];
        assert_eq!(imports(&files), ["b/d.rs", "e.rs"]);
    }

    #[test]
    fn children_are_imported_and_other_crates_are_not() {
        let files = [("lib.rs", "mod b;\nuse b::f;\nuse c::g;"), ("b.rs", "pub fn f() {}")];
        assert_eq!(imports(&files), ["b.rs"]);
    }

    #[test]
    fn a_reexport_is_no_import() {
        assert_eq!(imports(&[("lib.rs", "mod b;\npub use b::f;"), ("b.rs", "")]), [""; 0]);
    }
}
