//! Rows of a table of levels.

use maud::{Markup, html};

use crate::page::columns::Column;
use crate::page::counts::Counts;
use crate::page::descent::Level;
use crate::page::figures::figure;

/// The row of heads; `first` is over the names.
pub fn heads(first: &str, columns: &[&Column]) -> Markup {
    html! {
        thead { tr {
            th scope="col" { (first) }
            @for column in columns { th scope="col" { (column.head) } }
        } }
    }
}

/// The figures of a level; `wins` marks the best of their columns and may be shorter.
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
