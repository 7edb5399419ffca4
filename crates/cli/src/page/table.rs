//! Rows of the table of measurements on an HTML page.

use maud::{Markup, html};

use crate::page::chain::Level;
use crate::page::columns::Column;
use crate::page::counts::Counts;
use crate::page::figures::figure;

/// Builds the heading row of a table; `first` is the heading of the first column.
pub fn heads(first: &str, columns: &[&Column]) -> Markup {
    html! {
        thead { tr {
            th scope="col" { (first) }
            @for column in columns { th scope="col" { (column.head) } }
        } }
    }
}

/// Builds the table row of a level; `wins` marks the best values and may be shorter than `columns`.
pub fn row(
    name: &Markup,
    level: &Level,
    input: &Counts,
    columns: &[&Column],
    wins: &[bool],
) -> Markup {
    html! {
        tr {
            th scope="row" { (name) }
            @for (i, column) in columns.iter().enumerate() {
                td.best[wins.get(i) == Some(&true)] {
                    @match column.cell(input, level) {
                        Some((exact, text)) => (figure(exact, &text)),
                        None => "–",
                    }
                }
            }
        }
    }
}
