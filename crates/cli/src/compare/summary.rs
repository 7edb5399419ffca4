//! What the command itself says: the figures of the page, for programs and for people.

use serde_json::{Value, json};

use crate::compare::contest::{COMPARED_SIDE, Contest, Entry, Outcome};
use crate::compare::output::Output;
use crate::files;
use crate::numbers;
use crate::page::columns::{Column, legend};
use crate::page::descent::{Chain, Level};
use crate::page::level_json::level_json;
use crate::table::aligned;

/// All figures; files are named by where they are in the folder.
pub fn json(contest: &Contest<'_>, outcome: &Outcome, output: &Output) -> Value {
    let input = &contest.subject.counts;
    let level = |method, level: &Level| {
        let mut json = level_json(method, level, input);
        json["file"] = level.file.clone().into();
        json
    };
    let entry = |entry: &Entry| {
        let Chain { method, levels } = &entry.chain;
        json!({
            "method": method.name(),
            "levels": levels.iter().map(|made| level(*method, made)).collect::<Vec<_>>(),
            "failed": entry.trouble.as_ref().map(ToString::to_string),
        })
    };
    json!({
        "input": contest.subject.name,
        "counts": input.json(),
        "samples_each_way": contest.options.samples,
        "seed": contest.options.seed,
        "flip_picture_side": contest.pictures.then_some(COMPARED_SIDE),
        "threads": rayon::current_num_threads(),
        "folder": files::name(&output.folder),
        "page": "index.html",
        "methods": outcome.entries.iter().map(entry).collect::<Vec<_>>(),
    })
}

/// A table for each size, and the path of the page last.
pub fn text(contest: &Contest<'_>, outcome: &Outcome, output: &Output) -> String {
    let input = &contest.subject.counts;
    let mut text = format!("{}: {}\n", contest.subject.name, numbers::faces(input.faces));
    for (i, size) in contest.sizes.iter().enumerate() {
        text += &format!("\n{size}\n{}", table(contest, outcome, i));
        for (method, line) in outcome.unconserved(i) {
            text += &format!("{}: {line}\n", method.name());
        }
    }
    let levels = outcome.entries.iter().flat_map(|entry| &entry.chain.levels);
    text.push('\n');
    for about in legend(input, &Column::of(input, levels)) {
        text += &format!("{about}\n");
    }
    text += "* the best of the levels that reached their size\n";
    text + &format!("{}\n", files::name(&output.folder.join("index.html")))
}

fn table(contest: &Contest<'_>, outcome: &Outcome, size: usize) -> String {
    let input = &contest.subject.counts;
    let levels: Vec<&Level> = outcome.at(size).map(|(_, level)| level).collect();
    let columns = Column::of(input, levels.iter().copied());
    let heads = columns.iter().map(|column| format!("{} ", column.head.to_lowercase()));
    let mut rows = vec![std::iter::once(String::new()).chain(heads).collect::<Vec<_>>()];
    rows.extend(outcome.at(size).map(|(entry, _)| vec![entry.chain.method.name().into()]));
    for column in columns {
        let wins = column.winners(input, &levels);
        for ((row, level), won) in rows[1..].iter_mut().zip(&levels).zip(wins) {
            let text = column.cell(input, level).map_or("-".into(), |(_, text)| text);
            row.push(format!("{text}{}", if won { '*' } else { ' ' }));
        }
    }
    aligned(&rows)
}
