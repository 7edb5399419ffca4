//! Pictures side by side: the input first, then levels, a column for each.

use maud::{Markup, html};

use crate::page::figures::whole;
use crate::page::heat;
use crate::page::studio::{Plate, SIZE, Shots};
use crate::page::subject::Subject;

/// A column: what is said of it, and its pictures.
pub struct Stand<'p> {
    pub caption: Markup,
    pub shots: &'p Shots,
}

/// How columns that find no room are reached.
#[derive(Clone, Copy)]
pub enum Layout {
    /// By moving them sideways: the order tells something.
    Scroll,
    /// In the next row.
    Wrap,
}

/// The pictures of a subject and of what was made of it.
pub fn strip(subject: &Subject, input: &Shots, stands: &[Stand<'_>], layout: Layout) -> Markup {
    let label = format!("{}: the input and its levels", subject.title);
    let (class, columns) = match layout {
        Layout::Scroll => ("strip", None),
        Layout::Wrap => ("strip wrap", Some(format!("--columns: {}", columns(stands.len() + 1)))),
    };
    html! {
        div class=(class) style=[columns] tabindex="0" role="region" aria-label=(label) {
            figure {
                figcaption {
                    b { "Input" }
                    span { (whole(subject.counts.faces)) " faces" }
                }
                (image(&input.shaded))
                (image(&input.wired))
                (legend())
            }
            @for Stand { caption, shots } in stands {
                figure {
                    figcaption { (caption) }
                    (image(&shots.shaded))
                    (image(&shots.wired))
                    @if let Some(heat) = &shots.heat { (image(heat)) }
                }
            }
        }
    }
}

/// Columns on a wide page: rows of about one length, neither too small nor too large to see.
fn columns(pictures: usize) -> usize {
    let rows = pictures.div_ceil(MOST_COLUMNS);
    pictures.div_ceil(rows).clamp(4, MOST_COLUMNS)
}

const MOST_COLUMNS: usize = 6;

fn image(plate: &Plate) -> Markup {
    html! { img src=(plate.uri) alt=(plate.alt) width=(SIZE[0]) height=(SIZE[1]) loading="lazy"; }
}

/// The scale of the heat maps, in the place where the input’s would be.
fn legend() -> Markup {
    html! {
        div.legend {
            p { b { "Error" } " Distance of the level from the input, in percent of the diagonal." }
            div.bar style=(format!("background: {}", heat::gradient())) {}
            div.ticks { @for tick in heat::ticks() { span { (tick) } } }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_about_as_long_as_each_other() {
        assert_eq!([1, 3, 6, 7, 9, 12].map(columns), [4, 4, 6, 4, 5, 6]);
    }
}
