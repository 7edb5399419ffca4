//! One exhibit on the page.

use maud::{Markup, html};

use crate::demo::chain::Level;
use crate::demo::counts::Counts;
use crate::demo::exhibit::Exhibit;
use crate::demo::figures::{self, figure, percent, wanted, whole};
use crate::demo::studio::{Plate, SIZE};
use crate::demo::{chart, heat};

/// What it is, how it looks, what was measured.
pub fn section(exhibit: &Exhibit) -> Markup {
    let subject = exhibit.subject;
    html! {
        section id=(subject.name) {
            div.intro {
                div {
                    h2 { (subject.title) }
                    p { (subject.about) }
                }
                (facts(exhibit))
            }
            (strip(exhibit))
            div.measured {
                (chart::chart(exhibit))
                div.scroll tabindex="0" role="region" aria-label="Figures" {
                    (figures::table(exhibit))
                }
            }
            p.verdict { (verdict(exhibit)) }
        }
    }
}

/// The counts of the input.
fn facts(exhibit: &Exhibit) -> Markup {
    let counts = &exhibit.input.counts;
    let number = |name: &str, markup: Markup| html! { div { dt { (name) } dd { (markup) } } };
    html! {
        dl.facts {
            (number("vertices", whole(counts.vertices)))
            (number("faces", whole(counts.faces)))
            (number("boundary edges", whole(counts.boundary_edges)))
            (number("non-manifold edges", whole(counts.non_manifold_edges)))
            (number("components", whole(counts.components)))
            (number("closed", html! { @if counts.closed { "yes" } @else { "no" } }))
            @if let Some(genus) = counts.genus { (number("tunnels (genus)", whole(genus))) }
            (number("area", figure(counts.area, &short(counts.area))))
            (number("volume", figure(counts.volume, &short(counts.volume))))
        }
    }
}

/// Pictures: a column for the input and for each level of the main chain.
fn strip(exhibit: &Exhibit) -> Markup {
    let pictures = &exhibit.pictures;
    let label = format!("{}: the input and its levels", exhibit.subject.title);
    html! {
        div.strip tabindex="0" role="region" aria-label=(label) {
            figure {
                figcaption {
                    b { "Input" }
                    span { (whole(exhibit.input.counts.faces)) " faces" }
                }
                (image(&pictures.shaded[0]))
                (image(&pictures.wired[0]))
                (legend())
            }
            @for (i, level) in exhibit.main_chain().levels.iter().enumerate() {
                figure {
                    (caption(level))
                    (image(&pictures.shaded[i + 1]))
                    (image(&pictures.wired[i + 1]))
                    (image(&pictures.heat[i]))
                }
            }
        }
    }
}

fn caption(level: &Level) -> Markup {
    let rms = level.distance.percent(level.distance.rms());
    html! {
        figcaption {
            b { (wanted(level)) }
            span { (whole(level.report.output_faces)) " faces" }
            span { "RMS " (percent(rms)) "%" }
        }
    }
}

fn image(plate: &Plate) -> Markup {
    html! { img src=(plate.uri) alt=(plate.alt) width=(SIZE[0]) height=(SIZE[1]) loading="lazy"; }
}

/// The scale of the heat maps, in the place where the input’s would be.
fn legend() -> Markup {
    html! {
        div.legend {
            p { b { "Error" } " How far the level is from the input, in percent of the diagonal." }
            div.bar style=(format!("background: {}", heat::gradient())) {}
            div.ticks { @for tick in heat::ticks() { span { (tick) } } }
        }
    }
}

/// Whether the levels hang together as the input does, and are as small as asked for.
fn verdict(exhibit: &Exhibit) -> String {
    let input = &exhibit.input.counts;
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
        "{whole} are as whole as the input: {}{tunnels}. {reached} reached their size.",
        shape(input)
    )
}

fn shape(counts: &Counts) -> String {
    let closed = if counts.closed { "closed" } else { "open" };
    match counts.components {
        1 => format!("{closed}, in one piece"),
        pieces => format!("{closed}, in {pieces} pieces"),
    }
}

/// Four places: enough to know a sample by.
fn short(number: f64) -> String {
    format!("{number:.4}")
}
