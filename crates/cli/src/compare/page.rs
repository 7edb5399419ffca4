//! Report page of a comparison of methods, in HTML.

use maud::{Markup, html};
use meshlod::measure::Distance;

use crate::compare::comparison::{Comparison, ComparisonResult, MethodResult};
use crate::compare::section::{anchor, section};
use crate::page::chain::Level;
use crate::page::chart::{Across, Chart, Series, chart};
use crate::page::document::{Document, document};
use crate::page::facts::facts;
use crate::text::numbers::{count, plural};

/// Builds the HTML page of a comparison.
pub fn page(comparison: &Comparison<'_>, outcome: &ComparisonResult) -> Markup {
    let sizes = || outcome.sizes(&comparison.sizes);
    let links = sizes().map(|(index, size)| (anchor(index), size.to_string()));
    document(Document {
        title: &format!("meshlod compare: {}", comparison.subject.title),
        links: links.chain([("files".into(), "Files".into())]).collect(),
        header: header(comparison, outcome),
        main: html! {
            (overview(comparison, outcome))
            @for (index, _) in sizes() { (section(comparison, outcome, index)) }
            (files(comparison, outcome))
        },
    })
}

/// Opens with a sentence for each size: which method came closest, and which was fastest.
fn header(comparison: &Comparison<'_>, outcome: &ComparisonResult) -> Markup {
    let threads = rayon::current_num_threads();
    html! {
        h1 id="top" { (comparison.subject.title) }
        @for (_, verdict) in outcome.verdicts(&comparison.sizes) {
            p.lead.opening { (verdict.sentence()) }
        }
        p.lead {
            "Simplified by " (comparison.methods.len()) " method" (plural(comparison.methods.len()))
            ", independently of each other. Each level is measured against the original: from every "
            "vertex and " (count(comparison.options.samples)) " samples each way to the exact closest "
            "point. Times are for one run on " (threads) " thread" (plural(threads))
            ", without reading and writing."
            @if comparison.pictures { " A click enlarges a picture." }
        }
    }
}

/// Shows the input, and a chart of the errors if there are several sizes.
fn overview(comparison: &Comparison<'_>, outcome: &ComparisonResult) -> Markup {
    html! {
        section id="input" {
            h2 { "Input" }
            div.intro {
                (facts(&comparison.subject.counts))
                @if comparison.sizes.len() > 1 { (chart(&errors(outcome))) }
            }
        }
    }
}

fn errors(outcome: &ComparisonResult) -> Chart {
    let point = |level: &Level| {
        level.percent(Distance::rms).map(|rms| [level.report.output_faces as f64, rms])
    };
    let series = |entry: &MethodResult| Series {
        method: entry.chain.method,
        points: entry.chain.levels.iter().filter_map(point).collect(),
    };
    Chart {
        alt: "RMS error against faces: one line per method".into(),
        caption: "RMS error in percent of the diagonal, against faces.",
        across: Across::Faces,
        series: outcome.entries.iter().map(series).collect(),
    }
}

/// Lists the files next to the page, and the command that measures them again.
fn files(comparison: &Comparison<'_>, outcome: &ComparisonResult) -> Markup {
    let levels = || outcome.entries.iter().flat_map(|entry| &entry.chain.levels);
    html! {
        section id="files" {
            h2 { "Files next to this page" }
            p { a href="compare.json" { "compare.json" } " holds all figures. The levels:" }
            ul.names { @for level in levels() { li { a href=(level.file) { (level.file) } } } }
            @if let Some(level) = levels().next() {
                @if level.file.ends_with(".glb") {
                    p { "glTF stores coordinates in 32 bits, so the last digits differ when measured again." }
                }
                pre { code { "meshlod measure " (comparison.subject.title) " " (level.file) } }
            }
        }
    }
}
