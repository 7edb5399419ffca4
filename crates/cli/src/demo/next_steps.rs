//! End of the demo page: commands to try on other meshes, and the files written.

use maud::{Markup, html};

use crate::demo::pipeline::Pipeline;
use crate::demo::sample_report::SampleReport;

/// Steps with their commands.
const STEPS: [(&str, &str); 7] = [
    ("Look inside", "meshlod info your.ply"),
    ("Simplify it", "meshlod simplify your.ply small.ply --ratio 10%"),
    ("Bound the error", "meshlod simplify your.ply small.ply --error 0.1%"),
    ("Measure the result", "meshlod measure your.ply small.ply"),
    ("Compare the methods", "meshlod compare your.ply --ratio 10% --out compared"),
    ("Put all levels in one file", "meshlod lods your.ply your.glb --levels 50%,25%,10%,3%"),
    ("Render the error", "meshlod render your.ply error.png --heat-against small.ply"),
];

/// Lists commands for readers to try on their own meshes.
pub fn commands() -> Markup {
    html! {
        section id="own" {
            h2 { "On your own mesh" }
            p {
                "Reads and writes PLY, OBJ, STL, OFF, SMF, glTF and GLB. With " code { "--json" }
                ", every verb prints its figures for programs; " code { "meshlod help" }
                " lists the rest."
            }
            ol.steps {
                @for (what, line) in STEPS {
                    li { h3 { (what) } pre { code { (line) } } }
                }
            }
        }
    }
}

/// Lists the mesh files written next to the page.
pub fn files(reports: &[SampleReport], pipeline: &Pipeline) -> Markup {
    html! {
        section id="files" {
            h2 { "Files next to this page" }
            div.files {
                div {
                    h3 { "All steps" }
                    ul { @for (name, step) in pipeline.files() { (file(name, step)) } }
                }
                @for report in reports {
                    div {
                        h3 { (report.subject.title) }
                        ul {
                            (file(&report.sample.input_file(), "the input"))
                            (file(&report.sample.lods_file(), "input and levels, linked by MSFT_lod"))
                            @for chain in &report.chains {
                                @for level in &chain.levels {
                                    (file(&level.file, ""))
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn file(name: &str, what: &str) -> Markup {
    html! { li { a href=(name) { (name) } @if !what.is_empty() { " " small { (what) } } } }
}
