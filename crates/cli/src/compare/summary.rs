//! Output of `compare`: all measurements as JSON and text.

use serde_json::{Value, json};

use crate::compare::comparison::{COMPARED_SIDE, Comparison, ComparisonResult, MethodResult};
use crate::compare::output::Output;
use crate::compare::verdict;
use crate::page::chain::{Chain, Level};
use crate::page::columns::{Column, legend};
use crate::page::level_figures::LevelFigures;
use crate::session::files;
use crate::text::numbers;
use crate::text::table::aligned;

/// Returns all measurements as JSON, with file names relative to the output folder.
pub fn json(comparison: &Comparison<'_>, outcome: &ComparisonResult, output: &Output) -> Value {
    let input = &comparison.subject.counts;
    let level = |method, level: &Level| LevelFigures::of(method, level, input, level.file.clone());
    let entry = |entry: &MethodResult| {
        let Chain { method, levels } = &entry.chain;
        json!({
            "method": method,
            "levels": levels.iter().map(|made| level(*method, made)).collect::<Vec<_>>(),
            "failed": entry.failure.as_ref().map(ToString::to_string),
        })
    };
    let verdicts = outcome.verdicts(&comparison.sizes).map(|(_, verdict)| verdict.json());
    json!({
        "input": comparison.subject.name,
        "counts": input,
        "samples_each_way": comparison.options.samples,
        "seed": comparison.options.seed,
        "flip_picture_side": comparison.pictures.then_some(COMPARED_SIDE),
        "threads": rayon::current_num_threads(),
        "folder": files::name(&output.folder),
        "page": "index.html",
        "verdicts": verdicts.collect::<Vec<_>>(),
        "methods": outcome.entries.iter().map(entry).collect::<Vec<_>>(),
    })
}

/// Formats the measurements as a table for each size, and the path of the page.
pub fn text(comparison: &Comparison<'_>, outcome: &ComparisonResult, output: &Output) -> String {
    let input = &comparison.subject.counts;
    let mut text = format!("{}: {}\n", comparison.subject.name, numbers::faces(input.faces));
    for (i, verdict) in outcome.verdicts(&comparison.sizes) {
        text += &format!("\n{}\n{}", verdict.sentence(), table(comparison, outcome, i));
    }
    let levels = outcome.entries.iter().flat_map(|entry| &entry.chain.levels);
    text.push('\n');
    for about in legend(input, &Column::of(input, levels)) {
        text += &format!("{about}\n");
    }
    text += "* the best of the levels that reached their size\n";
    text + &format!("{}\n", files::name(&output.folder.join("index.html")))
}

fn table(comparison: &Comparison<'_>, outcome: &ComparisonResult, size: usize) -> String {
    let input = &comparison.subject.counts;
    let levels: Vec<&Level> = outcome.at(size).map(|(_, level)| level).collect();
    let columns = Column::of(input, levels.iter().copied());
    let heads = columns.iter().map(|column| format!("{} ", column.head.to_lowercase()));
    let mut rows = vec![std::iter::once(String::new()).chain(heads).collect::<Vec<_>>()];
    rows.extend(outcome.at(size).map(|(entry, _)| vec![verdict::named(entry.chain.method)]));
    for column in columns {
        let wins = column.winners(input, &levels);
        for ((row, level), won) in rows[1..].iter_mut().zip(&levels).zip(wins) {
            let text = column.cell(input, level).map_or("-".into(), |(_, text)| text);
            row.push(format!("{text}{}", if won { '*' } else { ' ' }));
        }
    }
    aligned(&rows)
}
