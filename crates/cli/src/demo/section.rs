//! Section of the demo page about one sample mesh.

use maud::{Markup, html};
use meshlod::measure::Distance;

use crate::demo::sample_report::SampleReport;
use crate::page::chain::{Chain, Level};
use crate::page::chart::{Across, Chart, Series, chart};
use crate::page::columns::{self, Column};
use crate::page::facts::{facts, shape};
use crate::page::figures::{percent, whole};
use crate::page::key::key;
use crate::page::picture_row::{Layout, PictureColumn, picture_row};
use crate::page::table;

/// Builds the section about a sample: description, pictures and measurements.
pub fn section(report: &SampleReport) -> Markup {
    html! {
        section id=(report.sample.name) {
            div.intro {
                div {
                    h2 { (report.subject.title) }
                    p { (report.sample.about) }
                }
                (facts(&report.subject.counts))
            }
            (pictures(report))
            // As wide as the page, so that no column is cut off on a common screen.
            (figures(report))
            div.measured {
                (chart(&errors(report)))
                div {
                    p.about { (legend(report)) }
                    p.verdict { (verdict(report)) }
                }
            }
        }
    }
}

/// Shows a column for the input and for each level of the main chain.
fn pictures(report: &SampleReport) -> Markup {
    let columns: Vec<PictureColumn> = report
        .main_chain()
        .levels
        .iter()
        .zip(&report.pictures)
        .map(|(level, pictures)| PictureColumn { caption: caption(level), pictures })
        .collect();
    picture_row(&report.subject, &report.input, &columns, Layout::Scroll)
}

fn caption(level: &Level) -> Markup {
    html! {
        b { (level.size) }
        span { (whole(level.report.output_faces)) " faces" }
        @if let Some(rms) = level.percent(Distance::rms) { span { "RMS " (percent(rms)) "%" } }
    }
}

/// Charts RMS error in percent of the diagonal against faces, one line per method.
fn errors(report: &SampleReport) -> Chart {
    let point = |level: &Level| {
        level.percent(Distance::rms).map(|rms| [level.report.output_faces as f64, rms])
    };
    let series = |chain: &Chain| Series {
        method: chain.method,
        points: chain.levels.iter().filter_map(point).collect(),
    };
    Chart {
        alt: format!("RMS error against faces, {}: one line per method", report.subject.title),
        caption: "RMS error in percent of the diagonal, against faces.",
        across: Across::Faces,
        series: report.chains.iter().map(series).collect(),
    }
}

/// Tabulates all figures of the levels.
fn figures(report: &SampleReport) -> Markup {
    let input = &report.subject.counts;
    let columns = Column::of(input, report.chains.iter().flat_map(|chain| &chain.levels));
    html! {
        div.scroll tabindex="0" role="region" aria-label="Figures" { table {
            (table::heads("Level", &columns))
            @for chain in &report.chains {
                tbody {
                    tr.method {
                        th colspan=(columns.len() + 1) scope="rowgroup" {
                            (key(chain.method)) (chain.method.name()) (refusals(chain))
                        }
                    }
                    @for level in &chain.levels {
                        @let name = html! { a href=(level.file) { (level.size) } };
                        (table::row(&name, level, input, &columns, &[]))
                    }
                }
            }
        } }
    }
}

/// Explains the columns of the table.
fn legend(report: &SampleReport) -> String {
    let input = &report.subject.counts;
    let columns = Column::of(input, report.chains.iter().flat_map(|chain| &chain.levels));
    columns::legend(input, &columns).join(" ")
}

/// Shows the refused contractions on the way to the last level.
fn refusals(chain: &Chain) -> Markup {
    let last = chain.levels.last().map(|level| level.report.refusals);
    html! { @if let Some(refusals) = last { small { "refused: " (refusals) } } }
}

/// Counts the levels that kept the input's topology and that reached their target.
fn verdict(report: &SampleReport) -> String {
    let input = &report.subject.counts;
    let levels = || report.chains.iter().flat_map(|chain| &chain.levels);
    let all = levels().count();
    let share = |part: usize| {
        if part == all { format!("All {all} levels") } else { format!("{part} of {all} levels") }
    };
    let whole = share(levels().filter(|level| level.has_topology_of(input)).count());
    let reached = share(levels().filter(|level| level.report.reached).count());
    let tunnels = match input.genus {
        Some(1) => ", with one tunnel",
        Some(2..) => ", with as many tunnels",
        _ => "",
    };
    format!(
        "{whole} have the topology of the input: {}{tunnels}. {reached} reached their size.",
        shape(input)
    )
}
