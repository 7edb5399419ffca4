//! One size on the page: what every method made of it.

use maud::{Markup, html};
use meshlod::measure::Distance;
use meshlod::simplify::Refusal;

use crate::compare::contest::{Contest, Entry, Outcome};
use crate::page::chart::{Across, Chart, Series, chart};
use crate::page::columns::{self, Column};
use crate::page::descent::Level;
use crate::page::figures::{percent, whole};
use crate::page::key::key;
use crate::page::strip::{Layout, Stand, strip};
use crate::page::table;

/// Pictures, figures and refusals.
pub fn section(contest: &Contest<'_>, outcome: &Outcome, size: usize) -> Markup {
    html! {
        section id=(anchor(size)) {
            h2 { "At " (contest.sizes[size]) }
            (pictures(contest, outcome, size))
            (figures(contest, outcome, size))
            (unconserved(outcome, size))
            div.measured {
                (chart(&trade(outcome, size)))
                div.scroll tabindex="0" role="region" aria-label="Refusals" {
                    (refusals(outcome, size))
                }
            }
        }
    }
}

/// Where a size is on the page.
pub fn anchor(size: usize) -> String {
    format!("size-{}", size + 1)
}

fn pictures(contest: &Contest<'_>, outcome: &Outcome, size: usize) -> Markup {
    let stands: Vec<Stand> = outcome
        .at(size)
        .filter_map(|(entry, level)| {
            Some(Stand { caption: caption(entry, level), shots: entry.shots.get(size)? })
        })
        .collect();
    match &outcome.input {
        Some(input) => strip(contest.subject, input, &stands, Layout::Wrap),
        None => html! {},
    }
}

fn caption(entry: &Entry, level: &Level) -> Markup {
    html! {
        b { (key(entry.chain.method)) (entry.chain.method.name()) }
        span { (whole(level.report.output_faces)) " faces" }
        @if let Some(rms) = level.percent(Distance::rms) { span { "RMS " (percent(rms)) "%" } }
        (not_reached(level))
    }
}

fn not_reached(level: &Level) -> Markup {
    html! { @if !level.report.reached { span.mark { "not reached" } } }
}

/// What a method takes and what it gives: time and error.
fn trade(outcome: &Outcome, size: usize) -> Chart {
    let series = |(entry, level): (&Entry, &Level)| {
        let point = level.percent(Distance::rms).map(|rms| [level.time.as_secs_f64(), rms]);
        Series { method: entry.chain.method, points: point.into_iter().collect() }
    };
    Chart {
        alt: "RMS error against time: one mark per method".into(),
        caption: "RMS error in percent of the diagonal, against time. Lower left is better.",
        across: Across::Seconds,
        series: outcome.at(size).map(series).collect(),
    }
}

fn figures(contest: &Contest<'_>, outcome: &Outcome, size: usize) -> Markup {
    let input = &contest.subject.counts;
    let levels: Vec<&Level> = outcome.at(size).map(|(_, level)| level).collect();
    let columns = Column::of(input, levels.iter().copied());
    let wins: Vec<Vec<bool>> =
        columns.iter().map(|column| column.winners(input, &levels)).collect();
    html! {
        // Before the table and not its caption: that would scroll with it.
        p.about { (columns::legend(input, &columns).join(" ")) " The best value of each column is marked." }
        div.scroll tabindex="0" role="region" aria-label="Figures" { table {
            (table::heads("Method", &columns))
            tbody {
                @for (i, (entry, level)) in outcome.at(size).enumerate() {
                    @let wins: Vec<bool> = wins.iter().map(|column| column[i]).collect();
                    (table::row(&name(entry, level), level, input, &columns, &wins))
                }
                @for entry in outcome.entries.iter().filter(|e| e.chain.levels.len() <= size) {
                    (failed(entry, columns.len()))
                }
            }
        } }
    }
}

/// What methods that conserve the volume could not conserve, and where.
fn unconserved(outcome: &Outcome, size: usize) -> Markup {
    let lines = outcome.unconserved(size);
    html! {
        @if !lines.is_empty() {
            ul.verdict {
                @for (method, line) in lines { li { (key(method)) (method.name()) ": " (line) } }
            }
        }
    }
}

fn name(entry: &Entry, level: &Level) -> Markup {
    let method = entry.chain.method;
    html! {
        (key(method)) a href=(level.file) { (method.name()) }
        " " (not_reached(level))
        @if let Err(reason) = &level.measured { " " span.mark { "not measured: " (reason) } }
    }
}

fn failed(entry: &Entry, columns: usize) -> Markup {
    let method = entry.chain.method;
    let trouble = entry.trouble.as_ref().map(ToString::to_string).unwrap_or_default();
    html! {
        tr {
            th scope="row" { (key(method)) (method.name()) }
            td.mark colspan=(columns) { (trouble) }
        }
    }
}

/// Why contractions were refused on the way here: the reasons that any method met.
fn refusals(outcome: &Outcome, size: usize) -> Markup {
    let met = |refusal: &Refusal| {
        outcome.at(size).any(|(_, level)| level.report.refusals.count(*refusal) > 0)
    };
    let reasons: Vec<Refusal> = Refusal::ALL.into_iter().filter(met).collect();
    html! {
        table {
            caption { "Refused contractions by reason; every retry counts again." }
            thead { tr {
                th scope="col" { "Method" }
                @for reason in &reasons { th scope="col" { (words(*reason)) } }
                th scope="col" { "total" }
            } }
            tbody { @for (entry, level) in outcome.at(size) { (reasons_of(entry, level, &reasons)) } }
        }
    }
}

fn reasons_of(entry: &Entry, level: &Level, reasons: &[Refusal]) -> Markup {
    let method = entry.chain.method;
    html! {
        tr {
            th scope="row" { (key(method)) (method.name()) }
            @for reason in reasons {
                td { (whole(level.report.refusals.count(*reason) as usize)) }
            }
            td { (whole(columns::refused(level) as usize)) }
        }
    }
}

fn words(refusal: Refusal) -> String {
    refusal.name().replace('_', " ")
}
