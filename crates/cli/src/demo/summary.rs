//! Output of `demo`: all measurements as JSON, the main ones as text.

use std::path::Path;

use meshlod::Method;
use meshlod::measure::Distance;
use serde::Serialize;
use serde_json::{Value, json};

use crate::demo::DemoResult;
use crate::demo::sample_report::{SAMPLES, SampleReport};
use crate::page::chain::{Chain, Level};
use crate::page::counts::Counts;
use crate::page::level_figures::LevelFigures;
use crate::session::files;
use crate::text::numbers::{count, percent, value};
use crate::text::table::aligned;

/// Returns all measurements and file paths as JSON.
pub fn json(result: &DemoResult) -> Value {
    json!({
        "page": files::name(&result.page),
        "page_bytes": result.page_bytes,
        "picture": files::name(&result.title_picture.file),
        "seconds": result.seconds,
        "samples_each_way": SAMPLES,
        "pipeline": result.pipeline.json(result.folder()),
        "samples": result.reports.iter().map(|report| of_report(report, result.folder())).collect::<Vec<_>>(),
    })
}

/// Counts, files and levels of a sample for programs.
#[derive(Serialize)]
struct SampleFigures<'r> {
    #[serde(flatten)]
    counts: &'r Counts,
    sample: &'static str,
    file: String,
    lods: String,
    chains: Vec<ChainFigures>,
}

#[derive(Serialize)]
struct ChainFigures {
    method: Method,
    levels: Vec<LevelFigures>,
}

fn of_report<'r>(report: &'r SampleReport, folder: &Path) -> SampleFigures<'r> {
    let counts = &report.subject.counts;
    let name = |file: &str| files::name(&folder.join(file));
    let chain = |&Chain { method, ref levels }: &Chain| {
        let level = |level| LevelFigures::of(method, level, counts, name(&level.file));
        ChainFigures { method, levels: levels.iter().map(level).collect() }
    };
    SampleFigures {
        counts,
        sample: report.sample.name,
        file: name(&report.sample.input_file()),
        lods: name(&report.sample.lods_file()),
        chains: report.chains.iter().map(chain).collect(),
    }
}

/// Formats a line about each level, and the path of the page.
pub fn text(result: &DemoResult) -> String {
    let head = ["", "level", "faces", "RMS", "max", "seconds"].map(String::from);
    let mut rows = vec![head];
    for report in &result.reports {
        let faces = count(report.subject.counts.faces);
        rows.push([report.sample.name, "", &faces, "", "", ""].map(String::from));
        for chain in &report.chains {
            rows.extend(chain.levels.iter().map(|level| row(chain, level)));
        }
    }
    format!(
        "from a broken mesh to a compressed one\n{}{}RMS, max: measured distance from the input, in % of the diagonal\n\
         done in {:.1} s, page of {:.1} MB\n{}\n",
        result.pipeline.text(),
        aligned(&rows),
        result.seconds,
        result.page_bytes as f64 / 1e6,
        files::name(&result.page),
    )
}

fn row(chain: &Chain, level: &Level) -> [String; 6] {
    let cell = |length| level.percent(length).map_or("-".into(), percent);
    [
        format!("  {}", chain.method.name()),
        level.size.to_string(),
        count(level.report.output_faces),
        cell(Distance::rms),
        cell(Distance::max),
        value((1000.0 * level.time.as_secs_f64()).round() / 1000.0),
    ]
}
