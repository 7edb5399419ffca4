//! What the command itself says: the figures of the page for programs, a few for people.

use std::path::Path;

use meshlod::measure::Distance;
use serde_json::{Value, json};

use crate::demo::Show;
use crate::demo::exhibit::{Exhibit, SAMPLES};
use crate::files;
use crate::numbers::{count, percent, value};
use crate::page::descent::{Chain, Level};
use crate::page::level_json::level_json;
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
    let mut json = exhibit.subject.counts.json();
    json["sample"] = exhibit.sample.name.into();
    json["file"] = files::name(&folder.join(exhibit.sample.input_file())).into();
    json["lods"] = files::name(&folder.join(exhibit.sample.lods_file())).into();
    let chain = |chain: &Chain| {
        let method = chain.method;
        let level = |level: &Level| {
            let mut json = level_json(method, level, &exhibit.subject.counts);
            json["file"] = files::name(&folder.join(&level.file)).into();
            json
        };
        json!({
            "method": method.name(),
            "levels": chain.levels.iter().map(level).collect::<Vec<_>>(),
        })
    };
    json["chains"] = exhibit.chains.iter().map(chain).collect();
    json
}

/// A line a level, and the path of the page last.
pub fn text(show: &Show) -> String {
    let head = ["", "level", "faces", "RMS", "max", "seconds"].map(String::from);
    let mut rows = vec![head];
    for exhibit in &show.exhibits {
        let faces = count(exhibit.subject.counts.faces);
        rows.push([exhibit.sample.name, "", &faces, "", "", ""].map(String::from));
        for chain in &exhibit.chains {
            rows.extend(chain.levels.iter().map(|level| row(chain, level)));
        }
    }
    format!(
        "{}RMS, max: measured distance from the input, in % of the diagonal\n\
         done in {:.1} s, page of {:.1} MB\n{}\n",
        aligned(&rows),
        show.seconds,
        show.page_bytes as f64 / 1e6,
        files::name(&show.page),
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
