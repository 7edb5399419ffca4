//! Row of pictures: a column for the original mesh, then one for each level.

use maud::{Markup, html};

use crate::page::figures::whole;
use crate::page::heat;
use crate::page::renderer::LevelPictures;
use crate::page::subject::Subject;

/// Column of pictures of one mesh, with a caption.
pub struct PictureColumn<'p> {
    pub caption: Markup,
    pub pictures: &'p LevelPictures,
}

/// Layout of columns that do not fit in one row.
#[derive(Clone, Copy)]
pub enum Layout {
    /// The row scrolls sideways, which keeps the order visible.
    Scroll,
    /// Columns continue in the next row.
    Wrap,
}

/// Shows pictures of the original mesh and of its levels side by side.
pub fn picture_row(
    subject: &Subject,
    input: &LevelPictures,
    levels: &[PictureColumn<'_>],
    layout: Layout,
) -> Markup {
    let label = format!("{}: the input and its levels", subject.title);
    let (class, columns) = match layout {
        Layout::Scroll => ("strip", None),
        Layout::Wrap => ("strip wrap", Some(format!("--columns: {}", columns(levels.len() + 1)))),
    };
    html! {
        div class=(class) style=[columns] tabindex="0" role="region" aria-label=(label) {
            figure {
                figcaption {
                    b { "Input" }
                    span { (whole(subject.counts.faces)) " faces" }
                }
                (input.shaded.zoomable())
                (input.wired.zoomable())
                (legend())
            }
            @for PictureColumn { caption, pictures } in levels {
                figure {
                    figcaption { (caption) }
                    (pictures.shaded.zoomable())
                    (pictures.wired.zoomable())
                    @if let Some(heat) = &pictures.heat { (heat.zoomable()) }
                }
            }
        }
    }
}

/// Returns the number of columns on a wide page, so that rows are of about equal length and
/// pictures of readable size.
fn columns(pictures: usize) -> usize {
    let rows = pictures.div_ceil(MOST_COLUMNS);
    pictures.div_ceil(rows).clamp(4, MOST_COLUMNS)
}

const MOST_COLUMNS: usize = 6;

/// Shows the scale of the heat maps, in place of one for the input.
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
