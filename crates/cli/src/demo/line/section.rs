//! Section of the demo page about the line: a card for each step.

use maud::{Markup, html};

use crate::demo::line::{Line, StepDone, shown};
use crate::page::figures::figure;

/// Builds the section: a picture, a figure and the commands of each step.
pub fn section(line: &Line) -> Markup {
    html! {
        section id="line" {
            h2 { "The whole line" }
            p {
                "What happens to a model between the tool that made it and the screen. The commands are \
                 those that wrote the files next to this page; they can be run again in its folder."
            }
            ol.steps.line { @for done in &line.done { (card(done)) } }
        }
    }
}

fn card(StepDone { step, figure: number, picture }: &StepDone) -> Markup {
    html! {
        li {
            h3 { (step.name) }
            p.number { b { (figure(number.exact, &number.number)) } " " (number.of) }
            (picture.zoomable())
            p { (step.about) }
            div.commands { @for words in step.commands { pre { code { (shown(words)) } } } }
        }
    }
}
