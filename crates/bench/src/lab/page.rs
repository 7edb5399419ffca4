//! `cargo xtask results`: measures everything again and rewrites docs/RESULTS.md.

use anyhow::{Context, Result, bail};

use crate::lab::folders::root;
use crate::lab::{
    accuracy, bounds, check, compression, constriction, contacts, flock, hard, levels, machine,
    memory, parts, reading, speed, strips, textured, tiles, volume,
};

type Section = fn() -> Result<String>;

/// Sections and their titles, in the order of the page.
const SECTIONS: [(&str, Section); 18] = [
    // First, while this process is still small: see the module.
    ("Memory and determinism", memory::section),
    ("Accuracy", accuracy::section),
    ("Volume", volume::section),
    ("Volume of textured models", volume::textured::section),
    ("Face constriction", constriction::section),
    ("Textured", textured::section),
    ("Many parts", parts::section),
    ("Hard surfaces", hard::section),
    ("Speed of simplification", speed::section),
    ("Bounds", bounds::section),
    ("Check", check::section),
    ("Contacts", contacts::section),
    ("All levels", levels::section),
    ("Strips", strips::section),
    ("Compression", compression::section),
    ("Tiles", tiles::section),
    ("Flocks", flock::section),
    ("Reading and measuring", reading::section),
];

/// Sections that others make, as they need packages of Python and a browser: `py/bench.py` and
/// `web/test/figures`. They are kept as they are.
const OF_OTHERS: [&str; 2] = ["\n## Python\n\n", "\n## In a browser\n\n"];

/// Makes all tables of measurements, and writes docs/RESULTS.md, whose history has earlier ones.
///
/// Takes some minutes. Tables whose meshes are missing say so. With `names`, only the sections
/// whose title contains one of them are remade, and marked with the date.
///
/// # Errors
/// A name that no title contains, before any work; a table that cannot be made.
pub fn run(names: &[String]) -> Result<()> {
    check_names(names)?;
    let machine = machine::describe();
    let results = root().join("docs/RESULTS.md");
    let all = std::fs::read_to_string(&results);
    let page_before = all.as_ref().map_or("", String::as_str);
    let of_others = OF_OTHERS.map(|heading| section_of(page_before, heading)).concat();
    let old = if names.is_empty() { String::new() } else { all? };
    let mut page = match old.split_once("\n## ") {
        Some((head, _)) => head.to_owned(),
        None => format!(
            "# Results\n\nMade by `cargo xtask results` on {}, {}. Distances are measured in both directions with \
             500,000 samples each and all vertices, in % of the diagonal of the input's bounding box.\n",
            machine.date, machine.what
        ),
    };
    for (title, section) in SECTIONS {
        let is_asked = names.iter().any(|name| is_named(title, name));
        let heading = format!("\n## {title}\n\n");
        if !names.is_empty() && !is_asked {
            page.push_str(section_of(&old, &heading));
            continue;
        }
        eprintln!("{title} …");
        page.push_str(&heading);
        if is_asked {
            page.push_str(&format!("Remade on {}, {}.\n\n", machine.date, machine.what));
        }
        page.push_str(&section()?);
    }
    page.push_str(&of_others);
    std::fs::write(&results, &page).with_context(|| results.display().to_string())?;
    print!("{page}");
    Ok(())
}

/// Returns a section of a page with its heading, or an empty string if there is no such section.
fn section_of<'p>(page: &'p str, heading: &str) -> &'p str {
    let Some(start) = page.find(heading) else { return "" };
    let end = page[start + heading.len()..].find("\n## ");
    &page[start..end.map_or(page.len(), |end| start + heading.len() + end)]
}

fn check_names(names: &[String]) -> Result<()> {
    let unknown = |name: &&String| !SECTIONS.iter().any(|(title, _)| is_named(title, name));
    match names.iter().find(unknown) {
        Some(name) => {
            let titles = SECTIONS.map(|(title, _)| title).join(", ");
            bail!("no section title contains {name:?}; the sections are {titles}")
        }
        None => Ok(()),
    }
}

fn is_named(title: &str, name: &str) -> bool {
    title.to_lowercase().contains(&name.to_lowercase())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_section_ends_where_the_next_begins() {
        let page = "# Results\n\n## A\n\none\n\n### B\n\ntwo\n\n## B\n\nthree\n";
        assert_eq!(section_of(page, "\n## A\n\n"), "\n## A\n\none\n\n### B\n\ntwo\n");
        assert_eq!(section_of(page, "\n## B\n\n"), "\n## B\n\nthree\n");
        assert_eq!(section_of(page, "\n## C\n\n"), "");
    }
}
