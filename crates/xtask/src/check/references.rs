//! Checks that every cited reference is defined in docs/REFERENCES.md, and that every reference
//! there is cited.

use std::collections::BTreeMap;

use crate::project::Text;

/// Path of the page that defines the reference keys, from the project's root.
pub const PAGE: &str = "docs/REFERENCES.md";

/// Lists reference keys that are cited in comments or pages but not defined, defined twice, or
/// never cited.
pub fn check(sources: &[Text], pages: &[Text]) -> Vec<String> {
    let Some(page) = pages.iter().find(|page| page.path == PAGE) else {
        return vec![format!("{PAGE} is missing")];
    };
    let mut errors = Vec::new();
    let mut defined = BTreeMap::new();
    for (line, key) in definitions(&page.text) {
        if defined.insert(key, line).is_some() {
            errors.push(format!("{PAGE}:{line}: [{key}] is defined twice"));
        }
    }
    let cited = citations(sources, pages);
    for (key, place) in &cited {
        if !defined.contains_key(key) {
            errors.push(format!("{place}: [{key}] is not in {PAGE}"));
        }
    }
    for (key, line) in defined {
        if !cited.contains_key(key) {
            errors.push(format!("{PAGE}:{line}: [{key}] is never cited"));
        }
    }
    errors
}

/// Lists the reference keys that a page defines.
pub fn keys_of(page: &Text) -> Vec<&str> {
    definitions(&page.text).map(|(_, key)| key).collect()
}

/// Line number and key of each entry, a list item that begins with its key.
fn definitions(page: &str) -> impl Iterator<Item = (usize, &str)> {
    page.lines().enumerate().filter_map(|(i, line)| {
        let key = line.strip_prefix("- **[")?.split_once("]**")?.0;
        is_key(key).then_some((i + 1, key))
    })
}

/// Maps every cited key to the place that cites it first.
fn citations<'a>(sources: &'a [Text], pages: &'a [Text]) -> BTreeMap<&'a str, String> {
    let comments = sources.iter().flat_map(|source| {
        let lines = source.text.lines().enumerate();
        lines.filter_map(move |(i, line)| Some((source, i, &line[line.find("//")?..])))
    });
    let prose = pages.iter().filter(|page| page.path != PAGE);
    let prose =
        prose.flat_map(|page| page.text.lines().enumerate().map(move |(i, l)| (page, i, l)));
    let mut cited = BTreeMap::new();
    for (text, i, line) in comments.chain(prose) {
        for key in bracketed(line).filter(|key| is_key(key)) {
            cited.entry(key).or_insert_with(|| format!("{}:{}", text.path, i + 1));
        }
    }
    cited
}

/// Texts in square brackets on a line, except those that begin a link: `[x](y)`, `[x]: y`.
fn bracketed(line: &str) -> impl Iterator<Item = &str> {
    line.split('[').skip(1).filter_map(|rest| {
        let (inside, after) = rest.split_once(']')?;
        let link = after.starts_with('(') || (after.starts_with(':') && after.contains("://"));
        (!link).then_some(inside)
    })
}

/// Returns true for two or more letters of the authors, the first a capital, two digits of the year,
/// and an optional lower-case letter.
fn is_key(text: &str) -> bool {
    let text = text.strip_suffix(|c: char| c.is_ascii_lowercase()).unwrap_or(text);
    let authors = text.trim_end_matches(|c: char| c.is_ascii_digit());
    text.len() == authors.len() + 2
        && authors.len() >= 2
        && authors.starts_with(|c: char| c.is_ascii_uppercase())
        && authors.chars().all(|c| c.is_ascii_alphabetic())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(path: &str, text: &str) -> Text {
        Text { path: path.into(), text: text.into() }
    }

    #[test]
    fn keys_look_like_keys() {
        for key in ["GH97", "DEGN99", "Hop99", "Sch70", "Gar99b"] {
            assert!(is_key(key), "{key}");
        }
        for other in ["f64", "F32", "97", "u8; 32", "gh97", "GH1997", "V3x99", ""] {
            assert!(!is_key(other), "{other}");
        }
    }

    #[test]
    fn a_key_cited_and_defined_is_fine() {
        let code = text("b.rs", "let x = y[AB12];");
        let sources = [text("a.rs", "/// [GH97] eq. 2."), code];
        let pages = [text(PAGE, "- **[GH97]** Garland and Heckbert.")];
        assert_eq!(check(&sources, &pages), [""; 0]);
    }

    #[test]
    fn a_key_without_an_entry_is_named_with_its_place() {
        let sources = [text("a.rs", "fn f() {}\n/// See [GH97].")];
        assert_eq!(
            check(&sources, &[text(PAGE, "")]),
            [format!("a.rs:2: [GH97] is not in {PAGE}")]
        );
    }

    #[test]
    fn an_uncited_entry_is_named() {
        let page = text(PAGE, "# References\n- **[GH97]** Garland and Heckbert.");
        assert_eq!(check(&[], &[page]), [format!("{PAGE}:2: [GH97] is never cited")]);
    }

    #[test]
    fn an_entry_twice_is_named() {
        let page = text(PAGE, "- **[GH97]** One.\n- **[GH97]** Two.");
        let errors = check(&[text("a.rs", "// [GH97]")], &[page]);
        assert_eq!(errors, [format!("{PAGE}:2: [GH97] is defined twice")]);
    }

    #[test]
    fn pages_cite_too_but_links_do_not() {
        let pages = [text(PAGE, ""), text("docs/notes/a.md", "As [GH97], [CI23](https://x).")];
        assert_eq!(check(&[], &pages).len(), 1);
    }
}
