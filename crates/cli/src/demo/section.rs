//! One exhibit on the page.

use maud::{Markup, html};
use meshlod::measure::Distance;

use crate::demo::exhibit::Exhibit;
use crate::page::chart::{Across, Chart, Series, chart};
use crate::page::columns::{self, Column};
use crate::page::descent::{Chain, Level};
use crate::page::facts::{facts, shape};
use crate::page::figures::{percent, whole};
use crate::page::key::key;
use crate::page::strip::{Layout, Stand, strip};
use crate::page::table;

/// What it is, how it looks, what was measured.
pub fn section(exhibit: &Exhibit) -> Markup {
    html! {
        section id=(exhibit.sample.name) {
            div.intro {
                div {
                    h2 { (exhibit.subject.title) }
                    p { (exhibit.sample.about) }
                }
                (facts(&exhibit.subject.counts))
            }
            (pictures(exhibit))
            div.measured {
                (chart(&errors(exhibit)))
                (figures(exhibit))
            }
            p.verdict { (verdict(exhibit)) }
        }
    }
}

/// A column for the input and for each level of the main chain.
fn pictures(exhibit: &Exhibit) -> Markup {
    let stands: Vec<Stand> = exhibit
        .main_chain()
        .levels
        .iter()
        .zip(&exhibit.shots)
        .map(|(level, shots)| Stand { caption: caption(level), shots })
        .collect();
    strip(&exhibit.subject, &exhibit.input, &stands, Layout::Scroll)
}

fn caption(level: &Level) -> Markup {
    html! {
        b { (level.size) }
        span { (whole(level.report.output_faces)) " faces" }
        @if let Some(rms) = level.percent(Distance::rms) { span { "RMS " (percent(rms)) "%" } }
    }
}

/// One line a method: faces and RMS error in percent of the diagonal.
fn errors(exhibit: &Exhibit) -> Chart {
    let point = |level: &Level| {
        level.percent(Distance::rms).map(|rms| [level.report.output_faces as f64, rms])
    };
    let series = |chain: &Chain| Series {
        method: chain.method,
        points: chain.levels.iter().filter_map(point).collect(),
    };
    Chart {
        alt: format!("RMS error against faces, {}: one line per method", exhibit.subject.title),
        caption: "RMS error in percent of the diagonal, against faces.",
        across: Across::Faces,
        series: exhibit.chains.iter().map(series).collect(),
    }
}

/// All figures of an exhibit's levels.
fn figures(exhibit: &Exhibit) -> Markup {
    let input = &exhibit.subject.counts;
    let columns = Column::of(input, exhibit.chains.iter().flat_map(|chain| &chain.levels));
    html! {
        div {
            p.about { (columns::legend(input, &columns).join(" ")) }
            div.scroll tabindex="0" role="region" aria-label="Figures" { table {
                (table::heads("Level", &columns))
                @for chain in &exhibit.chains {
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
}

/// Why contractions were refused on the way to the last level.
fn refusals(chain: &Chain) -> Markup {
    let last = chain.levels.last().map(|level| level.report.refusals);
    html! { @if let Some(refusals) = last { small { "refused: " (refusals) } } }
}

/// Whether the levels hang together as the input does, and are as small as asked for.
fn verdict(exhibit: &Exhibit) -> String {
    let input = &exhibit.subject.counts;
    let levels = || exhibit.chains.iter().flat_map(|chain| &chain.levels);
    let all = levels().count();
    let share = |part: usize| {
        if part == all { format!("All {all} levels") } else { format!("{part} of {all} levels") }
    };
    let whole = share(levels().filter(|level| level.is_as_whole_as(input)).count());
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
