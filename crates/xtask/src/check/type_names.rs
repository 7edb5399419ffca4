//! Checks that type names are unique within a crate, and public ones across the crates that the
//! facade re-exports.

use std::collections::{BTreeMap, BTreeSet};

use crate::check::modules::{Crate, Use};

/// Lists type names that are defined more than once in a crate, outside tests.
pub fn check_crates(crates: &[Crate<'_>]) -> Vec<String> {
    let mut errors = Vec::new();
    for krate in crates {
        let mut places: BTreeMap<&str, Vec<String>> = BTreeMap::new();
        for module in &krate.modules {
            for (line, name) in types(module.code) {
                places.entry(name).or_default().push(format!("{}:{line}", module.file));
            }
        }
        let twice = places.iter().filter(|(_, places)| places.len() > 1);
        errors.extend(twice.map(|(name, places)| {
            format!(
                "{}: `{name}` is defined {} times: {}",
                krate.name,
                places.len(),
                places.join(", ")
            )
        }));
    }
    errors
}

/// Lists type names that are public at the root of several crates that the facade re-exports.
///
/// A re-export from another crate of the workspace is the same item, so it does not count.
pub fn check_facade(crates: &[Crate<'_>], facade: &str) -> Vec<String> {
    let Some(root) = crates.iter().find(|krate| krate.name == facade) else {
        return vec![format!("the facade `{facade}` is missing")];
    };
    let reached = root.public_uses().filter_map(|used| local(&used.path[0]));
    let reached: BTreeSet<&str> = reached.chain([facade]).collect();
    let mut owners: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for krate in crates.iter().filter(|krate| reached.contains(krate.name)) {
        for name in public_types(krate) {
            owners.entry(name).or_default().insert(krate.name);
        }
    }
    let shared = owners.iter().filter(|(_, owners)| owners.len() > 1);
    shared
        .map(|(name, owners)| {
            let owners: Vec<_> = owners.iter().copied().collect();
            format!("`{name}` is public in {}", owners.join(" and in "))
        })
        .collect()
}

/// Names of the types that a crate defines and makes public at its root.
fn public_types<'c>(krate: &'c Crate<'_>) -> BTreeSet<&'c str> {
    let own = |used: &&Use| local(&used.path[0]).is_none();
    let shown = krate.public_uses().filter(own).map(|used| used.name.as_str());
    let lines = krate.root().code.lines();
    let defined = lines.filter(|line| line.starts_with("pub ")).filter_map(type_name);
    shown.chain(defined).filter(|name| is_type_name(name)).collect()
}

/// Returns the folder of a workspace crate, given its name in code.
fn local(name: &str) -> Option<&str> {
    name.strip_prefix("meshlod_")
}

/// Returns true for a name in camel case, which is no constant, function or module.
fn is_type_name(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_uppercase()) && name.contains(|c: char| c.is_lowercase())
}

/// Line and name of each type definition, associated types aside.
fn types(code: &str) -> impl Iterator<Item = (usize, &str)> {
    let lines = code.lines().enumerate();
    lines.filter_map(|(i, line)| type_name(line).map(|name| (i + 1, name)))
}

/// Returns the name of the type whose definition begins on this line.
fn type_name(line: &str) -> Option<&str> {
    let is_indented = line.starts_with(' ');
    let mut rest = line.trim_start();
    if let Some(public) = rest.strip_prefix("pub") {
        let restriction = public.starts_with('(').then(|| public.find(')')).flatten();
        rest = public[restriction.map_or(0, |end| end + 1)..].trim_start();
    }
    rest = rest.strip_prefix("unsafe ").unwrap_or(rest);
    let (keyword, rest) = rest.split_once(' ')?;
    let is_type = match keyword {
        "struct" | "enum" | "trait" | "union" => true,
        "type" => !is_indented,
        _ => false,
    };
    let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
    (is_type && end > 0).then_some(&rest[..end])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::modules::crates;
    use crate::check::source::Source;
    use crate::project::Text;

    fn sources(files: &[(&str, &str)]) -> Vec<Source> {
        let texts = files
            .iter()
            .map(|(path, text)| Text { path: format!("crates/{path}"), text: (*text).into() });
        texts.map(|text| Source::new(&text)).collect()
    }

    #[test]
    fn definitions_are_recognised() {
        for (line, name) in [
            ("struct A;", "A"),
            ("pub enum B<T> {", "B"),
            ("pub(in crate::x) unsafe trait C_: D {", "C_"),
            ("    pub(crate) union E {", "E"),
            ("type F = u8;", "F"),
        ] {
            assert_eq!(type_name(line), Some(name));
        }
        for line in
            ["    type G = u8;", "structure A", "impl A {", "let union = 3;", "struct $name;"]
        {
            assert_eq!(type_name(line), None, "{line}");
        }
    }

    #[test]
    fn a_name_twice_in_a_crate_is_named_with_its_places() {
        let sources = sources(&[
            ("a/src/lib.rs", "#[cfg(test)] mod tests;\nstruct Same;\nstruct Once;"),
            ("a/src/x.rs", "enum Same {}\n#[cfg(test)]\nmod tests { struct Once; }"),
            ("a/src/tests.rs", "struct Once;"),
            ("b/src/lib.rs", "struct Once;"),
        ]);
        let expected = "a: `Same` is defined 2 times: crates/a/src/lib.rs:2, crates/a/src/x.rs:1";
        assert_eq!(check_crates(&crates(&sources)), [expected]);
    }

    #[test]
    fn public_names_clash_only_in_reach_of_the_facade() {
        let sources = sources(&[
            ("house/src/lib.rs", "pub use meshlod_a as a;\npub use meshlod_b as b;"),
            ("a/src/lib.rs", "mod x;\npub use x::{Other as Options, run};\npub struct One;"),
            ("b/src/lib.rs", "pub struct Options;\npub struct Two;\nstruct One;\npub fn run() {}"),
            ("c/src/lib.rs", "pub struct Two;"),
        ]);
        let found = check_facade(&crates(&sources), "house");
        assert_eq!(found, ["`Options` is public in a and in b"]);
    }

    #[test]
    fn an_item_shown_again_does_not_clash_with_itself() {
        let sources = sources(&[
            (
                "house/src/lib.rs",
                "pub use meshlod_a as a;\npub use meshlod_a::Mesh;\nmod y;\npub use y::Scene;",
            ),
            ("a/src/lib.rs", "pub use x::{Mesh, Scene};"),
        ]);
        let found = check_facade(&crates(&sources), "house");
        assert_eq!(found, ["`Scene` is public in a and in house"]);
    }
}
