//! Output of `demo`: all measurements as JSON, the main ones as text.

use std::path::Path;

use meshlod::measure::Distance;
use serde_json::{Value, json};

use crate::demo::DemoResult;
use crate::demo::sample_report::{SAMPLES, SampleReport};
use crate::files;
use crate::numbers::{count, percent, value};
use crate::page::chain::{Chain, Level};
use crate::page::level_json::level_json;
use crate::table::aligned;

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

fn of_report(report: &SampleReport, folder: &Path) -> Value {
    let mut json = report.subject.counts.json();
    json["sample"] = report.sample.name.into();
    json["file"] = files::name(&folder.join(report.sample.input_file())).into();
    json["lods"] = files::name(&folder.join(report.sample.lods_file())).into();
    let chain = |chain: &Chain| {
        let method = chain.method;
        let level = |level: &Level| {
            let mut json = level_json(method, level, &report.subject.counts);
            json["file"] = files::name(&folder.join(&level.file)).into();
            json
        };
        json!({
            "method": method.name(),
            "levels": chain.levels.iter().map(level).collect::<Vec<_>>(),
        })
    };
    json["chains"] = report.chains.iter().map(chain).collect();
    json
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
