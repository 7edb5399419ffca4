//! Crates lean on each other only as the map of ARCHITECTURE.md allows.

use anyhow::{Context, Result};
use toml::Table;

use crate::project::Text;

/// The map: a crate's folder, and the folders of the project's crates that it may use.
const MAP: &[(&str, &[&str])] = &[
    ("mesh", &[]),
    ("samples", &["mesh"]),
    ("spatial", &["mesh"]),
    ("io", &["mesh"]),
    ("picture", &["mesh"]),
    ("measure", &["mesh", "spatial"]),
    ("check", &["mesh", "spatial"]),
    ("simplify", &["mesh", "spatial"]),
    ("codec", &["mesh"]),
    ("multires", &["mesh", "spatial", "simplify", "codec"]),
    ("strip", &["mesh", "simplify", "multires"]),
    ("flock", &["mesh", "spatial", "simplify", "check", "picture"]),
    (
        "meshlod",
        &[
            "mesh", "samples", "spatial", "io", "picture", "measure", "check", "simplify", "codec",
            "multires", "strip", "flock",
        ],
    ),
    ("view", &["meshlod"]),
    ("cli", &["meshlod", "view"]),
    ("py", &["meshlod"]),
    // Beside the map, for tests.
    ("fixtures", &["mesh"]),
];

/// Programs for ourselves, which may use anything.
const TOOLS: [&str; 2] = ["bench", "xtask"];

/// Reads the manifests of all crates; gives every arrow that the map does not have.
///
/// Dependencies for building and for one target count; those for tests do not.
/// # Errors
/// A manifest that is not TOML.
pub fn check(manifests: &[Text]) -> Result<Vec<String>> {
    let mut errors = Vec::new();
    for manifest in manifests {
        let Some(name) = folder(&manifest.path).filter(|name| !TOOLS.contains(name)) else {
            continue;
        };
        let table: Table = manifest.text.parse().with_context(|| manifest.path.clone())?;
        let Some((_, allowed)) = MAP.iter().find(|(known, _)| *known == name) else {
            errors.push(format!("{}: `{name}` is not on the map", manifest.path));
            continue;
        };
        for used in used_crates(&table) {
            if !allowed.contains(&used) {
                errors.push(format!("{}: `{name}` may not use `{used}`", manifest.path));
            }
        }
    }
    Ok(errors)
}

/// The crate's folder, from `crates/NAME/Cargo.toml`.
fn folder(path: &str) -> Option<&str> {
    path.strip_prefix("crates/")?.strip_suffix("/Cargo.toml")
}

/// The folders of the project's crates among a manifest's dependencies.
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

/// The folder of a crate of the project by its package name.
fn local(package: &str) -> Option<&str> {
    match package {
        "meshlod" | "xtask" => Some(package),
        _ => package.strip_prefix("meshlod-"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn manifest(name: &str, text: &str) -> Text {
        Text { path: format!("crates/{name}/Cargo.toml"), text: text.into() }
    }

    fn errors(name: &str, text: &str) -> Vec<String> {
        check(&[manifest(name, text)]).expect("TOML")
    }

    #[test]
    fn an_arrow_on_the_map_is_fine() {
        let text = "[dependencies]\nmeshlod-mesh.workspace = true\nglam = '1'";
        assert_eq!(errors("spatial", text), [""; 0]);
    }

    #[test]
    fn an_arrow_that_is_not_is_named() {
        let text = "[dependencies]\nmeshlod-simplify.workspace = true";
        let expected = ["crates/mesh/Cargo.toml: `mesh` may not use `simplify`"];
        assert_eq!(errors("mesh", text), expected);
        assert_eq!(errors("mesh", &text.replace("dep", "build-dep")), expected);
        assert_eq!(errors("mesh", &text.replace("dep", "target.'cfg(unix)'.dep")), expected);
    }

    #[test]
    fn tests_may_use_anything() {
        let text = "[dev-dependencies]\nmeshlod-simplify.workspace = true";
        assert_eq!(errors("mesh", text), [""; 0]);
    }

    #[test]
    fn a_crate_that_is_not_on_the_map_is_named() {
        assert_eq!(errors("thing", "").len(), 1);
    }

    #[test]
    fn the_map_has_no_way_back() {
        for (i, (name, uses)) in MAP.iter().enumerate() {
            for used in *uses {
                let earlier = MAP[..i].iter().any(|(known, _)| known == used);
                assert!(earlier || *name == "cli", "{name} uses {used}, which comes later");
            }
        }
    }
}
