//! Finds import circles: files that import each other in a circle cannot be read one by one.

use std::collections::BTreeSet;

use crate::check::modules::Crate;

/// Number of files above which a circle is an error.
const LARGE: usize = 6;
/// Folder whose files must not import each other in a circle.
const LAYERED: &str = "crates/simplify/src/kernel/";

/// Circles of imports that were found: small ones are only reported, others are errors.
#[derive(Debug, Default, PartialEq)]
pub struct Circles {
    /// The largest import circle of each crate, for information.
    pub notes: Vec<String>,
    /// Circles of more than six files, and circles in the folder that must be layered.
    pub errors: Vec<String>,
}

/// Finds the circles of imports among the source files of each crate.
pub fn check(crates: &[Crate<'_>]) -> Circles {
    let mut found = Circles::default();
    for krate in crates {
        let imports = krate.imports();
        let mut all = circles(&imports, |_| true);
        all.sort_by_key(BTreeSet::len);
        let smaller = all.partition_point(|circle| circle.len() <= LARGE);
        found.errors.extend(all[smaller..].iter().map(|circle| describe(krate, circle)));
        found.notes.extend(all[..smaller].last().map(|circle| describe(krate, circle)));
        let is_layered = |at: usize| krate.modules[at].file.starts_with(LAYERED);
        let layered = circles(&imports, is_layered);
        found.errors.extend(layered.iter().map(|circle| describe(krate, circle)));
    }
    found
}

/// Finds the strongly connected components of two or more nodes, ignoring nodes outside `within`.
///
/// Cost: O(nodes · edges).
fn circles(edges: &[BTreeSet<usize>], within: impl Fn(usize) -> bool) -> Vec<BTreeSet<usize>> {
    let reached: Vec<_> = (0..edges.len())
        .map(|node| if within(node) { reach(edges, node, &within) } else { BTreeSet::new() })
        .collect();
    let mut circles = Vec::new();
    for (node, ahead) in reached.iter().enumerate() {
        let circle: BTreeSet<usize> =
            ahead.iter().copied().filter(|&other| reached[other].contains(&node)).collect();
        // Each is found from its first node.
        if circle.first() == Some(&node) && circle.len() > 1 {
            circles.push(circle);
        }
    }
    circles
}

/// Returns the nodes reachable from `start` by one edge or more.
fn reach(
    edges: &[BTreeSet<usize>],
    start: usize,
    within: &impl Fn(usize) -> bool,
) -> BTreeSet<usize> {
    let mut reached = BTreeSet::new();
    let mut waiting = vec![start];
    while let Some(node) = waiting.pop() {
        let next = edges[node].iter().copied().filter(|&next| within(next));
        waiting.extend(next.filter(|&next| reached.insert(next)));
    }
    reached
}

fn describe(krate: &Crate<'_>, circle: &BTreeSet<usize>) -> String {
    let modules = || circle.iter().map(|&at| &krate.modules[at]);
    let lines: usize = modules().map(|module| module.code.lines().count()).sum();
    let folder = format!("crates/{}/src/", krate.name);
    let files: Vec<_> = modules().map(|module| module.file.trim_start_matches(&folder)).collect();
    format!(
        "crates/{}: {} of {} files ({lines} lines) import each other in a circle: {}",
        krate.name,
        circle.len(),
        krate.modules.len(),
        files.join(" ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::modules::crates;
    use crate::check::source::Source;
    use crate::project::Text;

    fn found(files: &[(&str, &str)]) -> Circles {
        found_in("simplify", files)
    }

    fn found_in(krate: &str, files: &[(&str, &str)]) -> Circles {
        let texts = files.iter().map(|(path, text)| Text {
            path: format!("crates/{krate}/src/{path}"),
            text: (*text).into(),
        });
        let sources: Vec<_> = texts.map(|text| Source::new(&text)).collect();
        check(&crates(&sources))
    }

    #[test]
    fn components_are_separated() {
        let edges = [vec![1], vec![2], vec![0, 3], vec![4], vec![3], vec![]];
        let edges = edges.map(|ends| ends.into_iter().collect::<BTreeSet<usize>>());
        let sets = |nodes: &[&[usize]]| -> Vec<BTreeSet<usize>> {
            nodes.iter().map(|nodes| nodes.iter().copied().collect()).collect()
        };
        assert_eq!(circles(&edges, |_| true), sets(&[&[0, 1, 2], &[3, 4]]));
        assert_eq!(circles(&edges, |node| node != 1), sets(&[&[3, 4]]));
    }

    #[test]
    fn the_largest_circle_of_a_crate_is_noted() {
        let files = [
            ("lib.rs", "mod a; mod b; mod c;"),
            ("a.rs", "use crate::b::B;"),
            ("b.rs", "use super::a::A;"),
            ("c.rs", "use crate::a::A;"),
        ];
        let note =
            "crates/simplify: 2 of 4 files (2 lines) import each other in a circle: a.rs b.rs";
        assert_eq!(found(&files), Circles { notes: vec![note.into()], errors: Vec::new() });
    }

    #[test]
    fn a_large_circle_is_an_error() {
        let files = |count: usize| {
            let each = (0..count).map(|i| {
                let text = format!("use crate::f{}::F;", (i + 1) % count);
                (format!("f{i}.rs"), text)
            });
            each.chain([("lib.rs".into(), String::new())]).collect::<Vec<_>>()
        };
        for (count, errors) in [(6, 0), (7, 1)] {
            let files = files(count);
            let files: Vec<_> = files.iter().map(|(path, text)| (&path[..], &text[..])).collect();
            assert_eq!(found_in("mesh", &files).errors.len(), errors, "{count}");
        }
    }

    #[test]
    fn a_circle_inside_the_layered_folder_is_an_error() {
        let files = [
            ("lib.rs", "mod kernel; mod x;"),
            ("x.rs", "use crate::kernel::a::A;"),
            ("kernel/mod.rs", "mod a; mod b;"),
            ("kernel/a.rs", "use super::b::B;"),
            ("kernel/b.rs", "use super::a::A;"),
        ];
        assert_eq!(found(&files).errors.len(), 1);
        let through_outside = [
            ("lib.rs", "mod kernel; mod x;"),
            ("x.rs", "use crate::kernel::a::A;"),
            ("kernel/mod.rs", "mod a;"),
            ("kernel/a.rs", "use crate::x::X;"),
        ];
        let found = found(&through_outside);
        assert_eq!((found.notes.len(), found.errors.len()), (1, 0));
    }
}
