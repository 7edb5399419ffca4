//! The page: one file, nothing else needed.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::demo::chain::SAMPLES;
use crate::demo::exhibit::Exhibit;
use crate::demo::hero::Hero;
use crate::demo::{own, section};
use crate::numbers::count;

const STYLE: &str = include_str!("style.css");

/// The whole document.
pub fn page(exhibits: &[Exhibit], hero: &Hero) -> Markup {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                meta name="generator" content=(version());
                title { "meshlod demo: coarser, and by how much" }
                style { (PreEscaped(STYLE)) }
            }
            body {
                (header(exhibits, hero))
                main {
                    @for exhibit in exhibits { (section::section(exhibit)) }
                    (own::commands())
                    (own::files(exhibits))
                }
                footer { p { (version()) " · MIT or Apache-2.0" } }
            }
        }
    }
}

fn header(exhibits: &[Exhibit], hero: &Hero) -> Markup {
    let levels: usize =
        exhibits.iter().flat_map(|exhibit| &exhibit.chains).map(|chain| chain.levels.len()).sum();
    let methods: Vec<&str> = exhibits[0].chains.iter().map(|chain| chain.method.name()).collect();
    html! {
        header {
            nav {
                a.brand href="#top" { "meshlod" }
                @for exhibit in exhibits {
                    a href=(format!("#{}", exhibit.subject.name)) { (exhibit.subject.title) }
                }
                a href="#own" { "Your mesh" }
                a href="#files" { "Files" }
            }
            h1 id="top" { "Fewer triangles, and how far off they are" }
            p.lead {
                (levels) " coarser levels of " (exhibits.len()) " meshes, by "
                (methods.join(" and ")) ", each held against its original: every vertex and " (count(SAMPLES))
                " samples each way, to the exact closest point. Every picture and every figure "
                "here was made by the command that wrote this page."
            }
            figure.hero {
                img src=(hero.plate.uri) alt=(hero.plate.alt)
                    width=(hero.size[0]) height=(hero.size[1]);
                figcaption {
                    @for faces in &hero.faces { span { b { (count(*faces)) } " faces" } }
                }
            }
        }
    }
}

fn version() -> String {
    format!("meshlod {}", env!("CARGO_PKG_VERSION"))
}
