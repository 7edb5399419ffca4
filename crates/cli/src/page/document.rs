//! Self-contained HTML document.

use maud::{DOCTYPE, Markup, PreEscaped, html};

const STYLE: &str = include_str!("style.css");

/// Parts of an HTML page.
pub struct Document<'a> {
    pub title: &'a str,
    /// Navigation links, as pairs of anchor and text.
    pub links: Vec<(String, String)>,
    pub header: Markup,
    pub main: Markup,
}

/// Builds the whole HTML document.
pub fn document(document: Document<'_>) -> Markup {
    let Document { title, links, header, main } = document;
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                meta name="generator" content=(version());
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                header {
                    nav {
                        a.brand href="#top" { "meshlod" }
                        @for (anchor, name) in links { a href=(format!("#{anchor}")) { (name) } }
                    }
                    (header)
                }
                main { (main) }
                footer { p { (version()) " · MIT or Apache-2.0" } }
            }
        }
    }
}

fn version() -> String {
    format!("meshlod {}", env!("CARGO_PKG_VERSION"))
}
