//! The page of the demo.

use maud::{Markup, html};

use crate::demo::exhibit::{Exhibit, SAMPLES};
use crate::demo::hero::Hero;
use crate::demo::{own, section};
use crate::numbers::count;
use crate::page::document::{Document, document};

/// The whole document.
pub fn page(exhibits: &[Exhibit], hero: &Hero) -> Markup {
    let samples =
        exhibits.iter().map(|exhibit| (exhibit.sample.name.into(), exhibit.subject.title.clone()));
    let rest = [("own", "Your mesh"), ("files", "Files")].map(|(a, b)| (a.into(), b.into()));
    document(Document {
        title: "meshlod demo: fewer triangles, measured",
        links: samples.chain(rest).collect(),
        header: header(exhibits, hero),
        main: html! {
            @for exhibit in exhibits { (section::section(exhibit)) }
            (own::commands())
            (own::files(exhibits))
        },
    })
}

fn header(exhibits: &[Exhibit], hero: &Hero) -> Markup {
    let levels: usize =
        exhibits.iter().flat_map(|exhibit| &exhibit.chains).map(|chain| chain.levels.len()).sum();
    let methods: Vec<&str> = exhibits[0].chains.iter().map(|chain| chain.method.name()).collect();
    html! {
        h1 id="top" { "Fewer triangles, measurably close" }
        p.lead {
            (levels) " coarser levels of " (exhibits.len()) " meshes, by "
            (listed(&methods)) ", each measured against its original: from every vertex and "
            (count(SAMPLES)) " samples each way to the exact closest point. Every picture and every "
            "figure here was made by the command that wrote this page."
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

/// `a`, `a and b`, `a, b and c`.
fn listed(names: &[&str]) -> String {
    match names {
        [first @ .., last] if !first.is_empty() => format!("{} and {last}", first.join(", ")),
        _ => names.concat(),
    }
}
