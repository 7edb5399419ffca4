//! Report page of `demo`, in HTML.

use maud::{Markup, html};

use crate::demo::pipeline::{self, Pipeline};
use crate::demo::sample_report::{SAMPLES, SampleReport};
use crate::demo::title_picture::TitlePicture;
use crate::demo::{next_steps, section};
use crate::page::document::{Document, document};
use crate::text::numbers::count;

/// Builds the HTML page of the demo.
pub fn page(reports: &[SampleReport], pipeline: &Pipeline, title_picture: &TitlePicture) -> Markup {
    let samples =
        reports.iter().map(|report| (report.sample.name.into(), report.subject.title.clone()));
    let rest = [("own", "Your mesh"), ("files", "Files")].map(|(a, b)| (a.into(), b.into()));
    document(Document {
        title: "meshlod demo: fewer triangles, measured",
        links: std::iter::once(("pipeline".into(), "All steps".into()))
            .chain(samples)
            .chain(rest)
            .collect(),
        header: header(reports, title_picture),
        main: html! {
            (pipeline::section::section(pipeline))
            @for report in reports { (section::section(report)) }
            (next_steps::commands())
            (next_steps::files(reports, pipeline))
        },
    })
}

fn header(reports: &[SampleReport], title_picture: &TitlePicture) -> Markup {
    let levels: usize =
        reports.iter().flat_map(|report| &report.chains).map(|chain| chain.levels.len()).sum();
    let methods: Vec<&str> = reports[0].chains.iter().map(|chain| chain.method.name()).collect();
    html! {
        h1 id="top" { "Fewer triangles, measurably close" }
        p.lead {
            (levels) " coarser levels of " (reports.len()) " meshes, by "
            (listed(&methods)) ", each measured against its original: from every vertex and "
            (count(SAMPLES)) " samples each way to the exact closest point. Every picture and every "
            "figure here was made by the command that wrote this page."
        }
        figure.hero {
            (title_picture.picture.image())
            figcaption {
                @for faces in &title_picture.faces { span { b { (count(*faces)) } " faces" } }
            }
        }
    }
}

/// Joins names: `a`, `a and b`, `a, b and c`.
fn listed(names: &[&str]) -> String {
    match names {
        [first @ .., last] if !first.is_empty() => format!("{} and {last}", first.join(", ")),
        _ => names.concat(),
    }
}
