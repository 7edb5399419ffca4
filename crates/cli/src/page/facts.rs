//! List of the counts and measures of an input mesh.

use maud::{Markup, html};

use crate::page::counts::Counts;
use crate::page::figures::{figure, whole};

/// Lists the counts and measures of an input mesh, each with its name.
pub fn facts(counts: &Counts) -> Markup {
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
            @let volume = if counts.closed { "volume" } else { "volume (not closed)" };
            (number(volume, figure(counts.volume, &short(counts.volume))))
        }
    }
}

/// Describes whether a mesh is closed, and its number of components.
pub fn shape(counts: &Counts) -> String {
    let closed = if counts.closed { "closed" } else { "open" };
    match counts.components {
        1 => format!("{closed}, in one piece"),
        pieces => format!("{closed}, in {pieces} pieces"),
    }
}

/// Formats about five digits, enough to recognise a mesh.
fn short(number: f64) -> String {
    match number.abs() {
        size if (0.01..1000.0).contains(&size) || size == 0.0 => format!("{number:.4}"),
        size if (1000.0..1e9).contains(&size) => format!("{number:.0}"),
        _ => format!("{number:.4e}"),
    }
}
