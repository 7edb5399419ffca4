//! Section of the demo page about the pipeline: a card for each step.

use maud::{Markup, html};

use crate::demo::pipeline::{Pipeline, StepDone, shown};
use crate::page::figures::figure;

/// Builds the section: a picture, a figure and the commands of each step.
pub fn section(pipeline: &Pipeline) -> Markup {
    html! {
        section id="pipeline" {
            h2 { "The whole pipeline" }
            p {
                "What happens to a model between the tool that made it and the screen. The commands are \
                 those that wrote the files next to this page; they can be run again in its folder."
            }
            ol.steps.pipeline { @for done in &pipeline.done { (card(done)) } }
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
