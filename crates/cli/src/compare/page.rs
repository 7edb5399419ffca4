//! The page of a comparison.

use maud::{Markup, html};
use meshlod::measure::Distance;

use crate::compare::contest::{Contest, Entry, Outcome};
use crate::compare::section::{anchor, section};
use crate::numbers::{count, plural};
use crate::page::chart::{Across, Chart, Series, chart};
use crate::page::descent::Level;
use crate::page::document::{Document, document};
use crate::page::facts::facts;

/// The whole document.
pub fn page(contest: &Contest<'_>, outcome: &Outcome) -> Markup {
    let sizes = || (0..contest.sizes.len()).filter(|&size| outcome.at(size).next().is_some());
    let links = sizes().map(|size| (anchor(size), contest.sizes[size].to_string()));
    document(Document {
        title: &format!("meshlod compare: {}", contest.subject.title),
        links: links.chain([("files".into(), "Files".into())]).collect(),
        header: header(contest),
        main: html! {
            (overview(contest, outcome))
            @for size in sizes() { (section(contest, outcome, size)) }
            (files(contest, outcome))
        },
    })
}

fn header(contest: &Contest<'_>) -> Markup {
    let threads = rayon::current_num_threads();
    html! {
        h1 id="top" { (contest.subject.title) }
        p.lead {
            "Simplified by " (contest.methods.len()) " method" (plural(contest.methods.len()))
            ", independently of each other. Each level is measured against the original: from every "
            "vertex and " (count(contest.options.samples)) " samples each way to the exact closest "
            "point. Times are for one run on " (threads) " thread" (plural(threads))
            ", without reading and writing."
        }
    }
}

/// The input, and how errors grow where there is more than one size.
fn overview(contest: &Contest<'_>, outcome: &Outcome) -> Markup {
    html! {
        section id="input" {
            h2 { "Input" }
            div.intro {
                (facts(&contest.subject.counts))
                @if contest.sizes.len() > 1 { (chart(&errors(outcome))) }
            }
        }
    }
}

fn errors(outcome: &Outcome) -> Chart {
    let point = |level: &Level| {
        level.percent(Distance::rms).map(|rms| [level.report.output_faces as f64, rms])
    };
    let series = |entry: &Entry| Series {
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

/// What lies beside the page, and how to measure it again.
fn files(contest: &Contest<'_>, outcome: &Outcome) -> Markup {
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
                pre { code { "meshlod measure " (contest.subject.title) " " (level.file) } }
            }
        }
    }
}
