//! Checks that dependencies between crates follow the table in ARCHITECTURE.md, their only map.

use anyhow::{Context, Result};
use toml::Table;

use crate::project::Text;

/// The page with the map, from the root, and the start of its table.
const PAGE: &str = "ARCHITECTURE.md";
const HEADING: &str = "| crate | may use |";
/// A cell that stands for every crate of an earlier row.
const ALL_ABOVE: &str = "all above";

/// One row of the map: a crate and its allowed dependencies.
struct MapRow<'p> {
    /// Folder of the crate.
    name: &'p str,
    /// Folders of the crates it may use.
    allowed: Vec<&'p str>,
}

/// Lists errors: dependencies between crates that the map does not allow, crates missing from it,
/// rows without a crate, and rows that allow a crate from a lower row.
///
/// Build dependencies and target-specific dependencies count, dev-dependencies do not.
/// # Errors
/// A manifest that is not TOML.
pub fn check(manifests: &[Text], pages: &[Text]) -> Result<Vec<String>> {
    let Some(page) = pages.iter().find(|page| page.path == PAGE) else {
        return Ok(vec![format!("{PAGE} is missing")]);
    };
    let map = rows(&page.text);
    let mut errors = arrows_down(&map);
    for MapRow { name, .. } in &map {
        if !manifests.iter().any(|manifest| folder(&manifest.path) == Some(name)) {
            errors.push(format!("{PAGE}: there is no crate `{name}`"));
        }
    }
    for manifest in manifests {
        let Some(name) = folder(&manifest.path) else { continue };
        let table: Table = manifest.text.parse().with_context(|| manifest.path.clone())?;
        let Some(row) = map.iter().find(|row| row.name == name) else {
            errors.push(format!("{}: `{name}` is not in the table of {PAGE}", manifest.path));
            continue;
        };
        for used in used_crates(&table) {
            if !row.allowed.contains(&used) {
                errors.push(format!("{}: `{name}` may not use `{used}`", manifest.path));
            }
        }
    }
    Ok(errors)
}

/// Parses the table of crates.
fn rows(page: &str) -> Vec<MapRow<'_>> {
    let lines = page.lines().skip_while(|line| !line.starts_with(HEADING)).skip(2);
    let mut rows: Vec<MapRow<'_>> = Vec::new();
    for line in lines.take_while(|line| line.starts_with('|')) {
        let mut cells = line.split('|').skip(1).map(str::trim);
        let (name, allowed) = (cells.next().unwrap_or(""), cells.next().unwrap_or(""));
        let allowed = match allowed {
            ALL_ABOVE => rows.iter().map(|row| row.name).collect(),
            "–" => Vec::new(),
            _ => allowed.split(',').map(str::trim).collect(),
        };
        rows.push(MapRow { name: name.trim_matches('`'), allowed });
    }
    rows
}

/// Lists allowed dependencies on the same row or a later one.
fn arrows_down(map: &[MapRow<'_>]) -> Vec<String> {
    let mut errors = Vec::new();
    for (i, MapRow { name, allowed }) in map.iter().enumerate() {
        let is_above = |used: &str| map[..i].iter().any(|row| row.name == used);
        for used in allowed.iter().filter(|used| !is_above(used)) {
            errors.push(format!("{PAGE}: `{name}` may use `{used}`, which is not above it"));
        }
    }
    errors
}

/// Returns `NAME` of `crates/NAME/Cargo.toml`, or of `NAME/Cargo.toml` for a workspace of its own.
fn folder(path: &str) -> Option<&str> {
    path.strip_suffix("/Cargo.toml").map(|folder| folder.strip_prefix("crates/").unwrap_or(folder))
}

/// Lists the folders of the workspace crates among a manifest's dependencies.
fn used_crates(manifest: &Table) -> Vec<&str> {
    let targets = manifest.get("target").and_then(|targets| targets.as_table());
    let for_target = targets.into_iter().flat_map(|t| t.values()).filter_map(|t| t.as_table());
    let mut used = Vec::new();
    for section in std::iter::once(manifest).chain(for_target) {
        for kind in ["dependencies", "build-dependencies"] {
            let dependencies = section.get(kind).and_then(|table| table.as_table());
            used.extend(
                dependencies.into_iter().flat_map(|t| t.keys()).filter_map(|name| local(name)),
            );
        }
    }
    used
}

/// Returns the folder of a workspace crate, given its package name.
fn local(package: &str) -> Option<&str> {
    match package {
        "meshlod" | "xtask" => Some(package),
        _ => package.strip_prefix("meshlod-"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MAP: &str = "# The map\n\n| crate | may use | holds |\n|---|---|---|\n\
        | `mesh` | – | meshes |\n| `spatial` | mesh | trees |\n| `house` | all above | all |\n";

    fn text(path: &str, text: &str) -> Text {
        Text { path: path.into(), text: text.into() }
    }

    fn manifest(name: &str, contents: &str) -> Text {
        text(&format!("crates/{name}/Cargo.toml"), contents)
    }

    /// Checks a workspace in which only the crate `name` has dependencies.
    fn errors(map: &str, name: &str, contents: &str) -> Vec<String> {
        let others = ["mesh", "spatial", "house"].into_iter().filter(|other| *other != name);
        let mut manifests: Vec<_> = others.map(|other| manifest(other, "")).collect();
        manifests.push(manifest(name, contents));
        check(&manifests, &[text(PAGE, map)]).expect("TOML")
    }

    #[test]
    fn an_arrow_on_the_map_is_fine() {
        let dependencies = "[dependencies]\nmeshlod-mesh.workspace = true\nglam = '1'";
        assert_eq!(errors(MAP, "spatial", dependencies), [""; 0]);
        assert_eq!(errors(MAP, "house", &dependencies.replace("mesh.", "spatial.")), [""; 0]);
    }

    #[test]
    fn a_workspace_of_its_own_has_a_row_too() {
        let map = MAP.replace("`house` | all above", "`py` | spatial");
        let manifests = |used: &str| {
            let py = text("py/Cargo.toml", &format!("[dependencies]\nmeshlod-{used} = '1'"));
            [manifest("mesh", ""), manifest("spatial", ""), py]
        };
        let errors = |used| check(&manifests(used), &[text(PAGE, &map)]).expect("TOML");
        assert_eq!(errors("spatial"), [""; 0]);
        assert_eq!(errors("mesh"), ["py/Cargo.toml: `py` may not use `mesh`"]);
    }

    #[test]
    fn an_arrow_that_is_not_is_named() {
        let text = "[dependencies]\nmeshlod-spatial.workspace = true";
        let expected = ["crates/mesh/Cargo.toml: `mesh` may not use `spatial`"];
        assert_eq!(errors(MAP, "mesh", text), expected);
        assert_eq!(errors(MAP, "mesh", &text.replace("dep", "build-dep")), expected);
        assert_eq!(errors(MAP, "mesh", &text.replace("dep", "target.'cfg(unix)'.dep")), expected);
    }

    #[test]
    fn tests_may_use_anything() {
        let text = "[dev-dependencies]\nmeshlod-spatial.workspace = true";
        assert_eq!(errors(MAP, "mesh", text), [""; 0]);
    }

    #[test]
    fn a_crate_that_is_not_on_the_map_is_named() {
        let expected = "crates/thing/Cargo.toml: `thing` is not in the table of ARCHITECTURE.md";
        assert_eq!(errors(MAP, "thing", ""), [expected]);
    }

    #[test]
    fn a_row_without_a_crate_is_named() {
        let map = format!("{MAP}| `flock` | mesh | fish |\n");
        assert_eq!(errors(&map, "mesh", ""), ["ARCHITECTURE.md: there is no crate `flock`"]);
    }

    #[test]
    fn arrows_of_the_map_only_point_up() {
        let map = MAP.replace("| – |", "| spatial |");
        let expected = "ARCHITECTURE.md: `mesh` may use `spatial`, which is not above it";
        assert_eq!(errors(&map, "mesh", ""), [expected]);
    }

    #[test]
    fn a_missing_map_is_an_error() {
        assert_eq!(check(&[], &[]).expect("TOML"), ["ARCHITECTURE.md is missing"]);
        assert_eq!(errors("", "mesh", "").len(), 3);
    }
}
