//! What the command itself says: the figures of the page for programs, a few for people.

use std::path::Path;

use serde_json::{Value, json};

use crate::demo::Show;
use crate::demo::chain::{Chain, Level, SAMPLES};
use crate::demo::exhibit::Exhibit;
use crate::demo::figures::wanted;
use crate::distance;
use crate::files;
use crate::numbers::{count, percent, value};
use crate::reduce::refusals_json;
use crate::table::aligned;

/// All figures and the paths of all files.
pub fn json(show: &Show) -> Value {
    json!({
        "page": files::name(&show.page),
        "page_bytes": show.page_bytes,
        "picture": files::name(&show.hero.file),
        "seconds": show.seconds,
        "samples_each_way": SAMPLES,
        "samples": show.exhibits.iter().map(|exhibit| of_exhibit(exhibit, show.folder())).collect::<Vec<_>>(),
    })
}

fn of_exhibit(exhibit: &Exhibit, folder: &Path) -> Value {
    let mut json = exhibit.input.counts.json();
    json["sample"] = exhibit.subject.name.into();
    json["file"] = files::name(&folder.join(exhibit.input_file())).into();
    json["lods"] = files::name(&folder.join(exhibit.lods_file())).into();
    let chain = |chain: &Chain| {
        let level = |level: &Level| of_level(exhibit, chain, level, folder);
        json!({
            "method": chain.method.name(),
            "levels": chain.levels.iter().map(level).collect::<Vec<_>>(),
        })
    };
    json["chains"] = exhibit.chains.iter().map(chain).collect();
    json
}

fn of_level(exhibit: &Exhibit, chain: &Chain, level: &Level, folder: &Path) -> Value {
    let report = &level.report;
    json!({
        "ratio": level.ratio,
        "faces": report.output_faces,
        "reached": report.reached,
        "closed": level.counts.closed,
        "genus": level.counts.genus,
        "components": level.counts.components,
        "volume": level.counts.volume,
        "volume_change_percent": level.volume_change(&exhibit.input.counts),
        "quality_mean": level.quality.mean,
        "quality_min": level.quality.min,
        "error_estimate": report.error_estimate,
        "error_measured": distance::to_json(&level.distance),
        "simplify_seconds": level.time.as_secs_f64(),
        "refusals": refusals_json(report),
        "file": files::name(&folder.join(exhibit.level_file(chain.method, level))),
    })
}

/// A line a level, and the path of the page last.
pub fn text(show: &Show) -> String {
    let head = ["", "level", "faces", "RMS", "max", "seconds"].map(String::from);
    let mut rows = vec![head];
    for exhibit in &show.exhibits {
        let faces = count(exhibit.input.counts.faces);
        rows.push([exhibit.subject.name, "", &faces, "", "", ""].map(String::from));
        for chain in &exhibit.chains {
            rows.extend(chain.levels.iter().map(|level| row(chain, level)));
        }
    }
    format!(
        "{}RMS, max: measured, of the diagonal\nin {:.1} s, {:.1} MB\n{}\n",
        aligned(&rows),
        show.seconds,
        show.page_bytes as f64 / 1e6,
        files::name(&show.page),
    )
}

fn row(chain: &Chain, level: &Level) -> [String; 6] {
    let Level { distance, report, time, .. } = level;
    [
        format!("  {}", chain.method.name()),
        wanted(level),
        count(report.output_faces),
        percent(distance.percent(distance.rms())),
        percent(distance.percent(distance.max())),
        value((1000.0 * time.as_secs_f64()).round() / 1000.0),
    ]
}
