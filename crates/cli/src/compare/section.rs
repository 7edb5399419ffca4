//! Section of the comparison page about one size.

use maud::{Markup, html};
use meshlod::Method;
use meshlod::measure::Distance;
use meshlod::simplify::Refusal;

use crate::compare::comparison::{Comparison, ComparisonResult, MethodResult};
use crate::compare::verdict::is_default;
use crate::page::chain::Level;
use crate::page::chart::{Across, Chart, Series, chart};
use crate::page::columns::{self, Column};
use crate::page::figures::{percent, whole};
use crate::page::key::key;
use crate::page::picture_row::{Layout, PictureColumn, picture_row};
use crate::page::table;

/// Builds the section about one size: pictures, measurements and refused contractions.
pub fn section(comparison: &Comparison<'_>, outcome: &ComparisonResult, size: usize) -> Markup {
    html! {
        section id=(anchor(size)) {
            h2 { "At " (comparison.sizes[size]) }
            (pictures(comparison, outcome, size))
            (figures(comparison, outcome, size))
            div.measured {
                (chart(&trade(outcome, size)))
                div.scroll tabindex="0" role="region" aria-label="Refusals" {
                    (refusals(outcome, size))
                }
            }
        }
    }
}

/// Returns the HTML anchor of the section about one size.
pub fn anchor(size: usize) -> String {
    format!("size-{}", size + 1)
}

fn pictures(comparison: &Comparison<'_>, outcome: &ComparisonResult, size: usize) -> Markup {
    let columns: Vec<PictureColumn> = outcome
        .at(size)
        .filter_map(|(entry, level)| {
            Some(PictureColumn {
                caption: caption(entry, level),
                pictures: entry.pictures.get(size)?,
            })
        })
        .collect();
    match &outcome.input {
        Some(input) => picture_row(comparison.subject, input, &columns, Layout::Wrap),
        None => html! {},
    }
}

fn caption(entry: &MethodResult, level: &Level) -> Markup {
    html! {
        b { (key(entry.chain.method)) (entry.chain.method.name()) (default(entry.chain.method)) }
        span { (whole(level.report.output_faces)) " faces" }
        @if let Some(rms) = level.percent(Distance::rms) { span { "RMS " (percent(rms)) "%" } }
        (not_reached(level))
    }
}

/// Marks the method that `simplify` uses unless told otherwise.
fn default(method: Method) -> Markup {
    html! { @if is_default(method) { " " span.chip { "default" } } }
}

fn not_reached(level: &Level) -> Markup {
    html! { @if !level.report.reached { span.mark { "not reached" } } }
}

/// Charts error against time, one mark per method.
fn trade(outcome: &ComparisonResult, size: usize) -> Chart {
    let series = |(entry, level): (&MethodResult, &Level)| {
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

fn figures(comparison: &Comparison<'_>, outcome: &ComparisonResult, size: usize) -> Markup {
    let input = &comparison.subject.counts;
    let levels: Vec<&Level> = outcome.at(size).map(|(_, level)| level).collect();
    let columns = Column::of(input, levels.iter().copied());
    let wins: Vec<Vec<bool>> =
        columns.iter().map(|column| column.winners(input, &levels)).collect();
    html! {
        // Placed before the table, because a caption would scroll with it.
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

fn name(entry: &MethodResult, level: &Level) -> Markup {
    let method = entry.chain.method;
    html! {
        (key(method)) a href=(level.file) { (method.name()) }
        (default(method)) " " (not_reached(level))
        @if let Err(reason) = &level.measured { " " span.mark { "not measured: " (reason) } }
    }
}

fn failed(entry: &MethodResult, columns: usize) -> Markup {
    let method = entry.chain.method;
    let failure = entry.failure.as_ref().map(ToString::to_string).unwrap_or_default();
    html! {
        tr {
            th scope="row" { (key(method)) (method.name()) (default(method)) }
            td.mark colspan=(columns) { (failure) }
        }
    }
}

/// Tabulates refused contractions by the reasons that any method met.
fn refusals(outcome: &ComparisonResult, size: usize) -> Markup {
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

fn reasons_of(entry: &MethodResult, level: &Level, reasons: &[Refusal]) -> Markup {
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
