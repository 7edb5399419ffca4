//! Figures on the page: as people read them, with the exact values for machines.

use maud::{Markup, html};

use crate::demo::chain::{Chain, Level};
use crate::demo::exhibit::Exhibit;
use crate::numbers;

/// All figures of an exhibit's levels.
pub fn table(exhibit: &Exhibit) -> Markup {
    html! {
        table {
            caption {
                "Mean, RMS, max: measured both ways, in percent of the input’s diagonal. "
                "Volume: its change in percent. Shape: 1 where all triangles are equilateral."
            }
            thead {
                tr {
                    th scope="col" { "Level" }
                    th scope="col" { "Faces" }
                    th scope="col" { "Mean" }
                    th scope="col" { "RMS" }
                    th scope="col" { "Max" }
                    th scope="col" { "Volume" }
                    th scope="col" { "Shape" }
                    th scope="col" { "Refused" }
                    th scope="col" { "Time" }
                }
            }
            @for (i, chain) in exhibit.chains.iter().enumerate() {
                tbody {
                    tr.method { th colspan="9" scope="rowgroup" { (key(i)) (chain.method.name()) (refusals(chain)) } }
                    @for level in &chain.levels { (row(exhibit, chain, level)) }
                }
            }
        }
    }
}

/// Why contractions were refused on the way to the last level.
fn refusals(chain: &Chain) -> Markup {
    let last = chain.levels.last().map(|level| level.report.refusals);
    html! { @if let Some(refusals) = last { small { "refused in all: " (refusals) } } }
}

fn row(exhibit: &Exhibit, chain: &Chain, level: &Level) -> Markup {
    let distance = &level.distance;
    let refused: u64 = level.report.refusals.iter().map(|(_, count)| count).sum();
    html! {
        tr {
            th scope="row" {
                a href=(exhibit.level_file(chain.method, level)) { (wanted(level)) }
            }
            td { (whole(level.report.output_faces)) }
            td { (percent(distance.percent(distance.mean()))) }
            td { (percent(distance.percent(distance.rms()))) }
            td { (percent(distance.percent(distance.max()))) }
            td { (signed(level.volume_change(&exhibit.input.counts))) }
            td { (figure(level.quality.mean, &format!("{:.2}", level.quality.mean))) }
            td { (whole(refused as usize)) }
            td { (seconds(level.time.as_secs_f64())) }
        }
    }
}

/// The mark of a method in charts and tables, by its place among all.
pub fn key(method: usize) -> Markup {
    html! { span class=(format!("key m{}", method % COLORS)) {} }
}

/// Colours for methods in the style sheet.
pub const COLORS: usize = 8;

/// What part of the input a level was to be: 10%.
pub fn wanted(level: &Level) -> String {
    format!("{}%", 100.0 * level.ratio)
}

/// A figure: `text` is seen, `exact` is what it stands for, as in the JSON.
pub fn figure(exact: f64, text: &str) -> Markup {
    html! { data value=(exact) { (text) } }
}

/// A whole number.
pub fn whole(number: usize) -> Markup {
    html! { data value=(number) { (numbers::count(number)) } }
}

/// A percentage, without its sign.
pub fn percent(percent: f64) -> Markup {
    figure(percent, &digits(percent))
}

fn signed(percent: f64) -> Markup {
    let text = digits(percent);
    // A real minus is as wide as a plus.
    let text = match text.strip_prefix('-') {
        Some(size) => format!("−{size}"),
        None if text == "0" => text,
        None => format!("+{text}"),
    };
    figure(percent, &text)
}

fn seconds(seconds: f64) -> Markup {
    figure(seconds, &format!("{:.0} ms", 1000.0 * seconds))
}

/// Below this many percent there is nothing but rounding.
pub const ROUNDING_PERCENT: f64 = 5e-6;

/// Three digits that matter, but never more than five places.
fn digits(percent: f64) -> String {
    match percent.abs() {
        size if size < ROUNDING_PERCENT => "0".into(),
        size if size < 0.01 => format!("{percent:.5}"),
        size if size < 0.1 => format!("{percent:.4}"),
        size if size < 1.0 => format!("{percent:.3}"),
        _ => format!("{percent:.2}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_carry_their_exact_values() {
        let text = percent(0.012345678).into_string();
        assert_eq!(text, r#"<data value="0.012345678">0.0123</data>"#);
        assert_eq!(signed(-1.5).into_string(), r#"<data value="-1.5">−1.50</data>"#);
        assert_eq!(whole(20_000).into_string(), r#"<data value="20000">20,000</data>"#);
    }

    #[test]
    fn rounding_is_shown_as_nothing() {
        assert_eq!([1e-14, -1e-14, 0.000_012].map(digits), ["0", "0", "0.00001"]);
    }
}
