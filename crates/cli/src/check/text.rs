//! Text report of a mesh check.

use crate::check::advice::advice;
use crate::check::inspection::Inspection;
use crate::check::places::{coordinates, ids, objects, short};
use crate::check::sites::Sites;
use crate::text::numbers::{count, faces, plural, value};
use crate::text::table::aligned;
use meshlod::jobs::{CONTACT_KINDS, ObjectPair};
use meshlod::jobs::{Grade, Group};

/// Limit of object pairs on a terminal; JSON and page have more.
const MOST_PAIRS: usize = 12;

/// Cell without a figure.
const NONE: &str = "-";

/// Formats the report: totals, a table of groups with the first finding of each, what to do about
/// them, and a table of contacts, which may be long.
pub fn text(inspection: &Inspection, sites: &Sites) -> String {
    let objects = inspection.report.owners.objects.names.len();
    let components = inspection.report.owners.objects.components;
    let mut text = format!(
        "{}, {} object{}, {} component{}\n",
        faces(inspection.report.faces),
        count(objects),
        plural(objects),
        count(components),
        plural(components),
    );
    text += &format!("{}\n", verdict(inspection));
    text += &groups(inspection, sites);
    text += &remedies(inspection);
    text + &contacts(inspection)
}

/// Formats the numbers of errors, warnings and touches in words.
pub fn verdict(inspection: &Inspection) -> String {
    let [errors, warnings, touches] =
        [Grade::Error, Grade::Warning, Grade::Touch].map(|grade| inspection.report.count(grade));
    let defects = format!(
        "{} error{}, {} warning{}",
        count(errors),
        plural(errors),
        count(warnings),
        plural(warnings)
    );
    match (errors + warnings, touches) {
        (0, 0) if inspection.report.is_clean() => "clean".into(),
        (0, 0) => "nothing found, but not all was compared".into(),
        (_, 0) => defects,
        (_, 1) => format!("{defects}; 1 place where objects touch"),
        _ => format!("{defects}; {} places where objects touch", count(touches)),
    }
}

fn groups(inspection: &Inspection, sites: &Sites) -> String {
    let found: Vec<(Group, usize)> = inspection.report.groups().collect();
    let row = |&(group, number): &(Group, usize)| {
        let name = format!("{:<7}  {}", group.grade.name(), group.kind.name());
        [name, count(number)]
    };
    let rows: Vec<[String; 2]> = found.iter().map(row).collect();
    let table = aligned(&rows);
    let lines = table.lines().zip(&found).map(|(line, &(group, _))| {
        format!("  {line}  {}", first(inspection, sites, group)).trim_end().to_owned() + "\n"
    });
    lines.collect()
}

/// Describes the place of the first finding of a group, by ids, objects and position.
fn first(inspection: &Inspection, sites: &Sites, group: Group) -> String {
    let Some(found) = inspection.report.of_group(group).next() else { return String::new() };
    let mut text = ids(found.finding, sites);
    let Some(place) = found.place else { return text };
    let objects = objects(&found, inspection);
    // Ids of a scene name its nodes already.
    if !objects.is_empty() && !sites.are_several() {
        text += &format!(" in {objects}");
    }
    format!("first: {text} at {}", coordinates(place))
}

/// Formats a line for each group of findings that says what to do about it.
fn remedies(inspection: &Inspection) -> String {
    let line = |(group, _): (Group, usize)| {
        let name = format!("{} ({})", group.kind.name(), group.grade.name());
        format!("  {name}: {}\n", advice(group).remedy.replace('`', ""))
    };
    let lines: String = inspection.report.groups().map(line).collect();
    if lines.is_empty() { lines } else { format!("what to do\n{lines}") }
}

/// Formats the table of object pairs, those with the most face pairs first. Columns without a
/// figure are left out.
fn contacts(inspection: &Inspection) -> String {
    let pairs = inspection.report.contacts.by_size();
    if pairs.is_empty() {
        return String::new();
    }
    let names = ["", "face pairs"]
        .into_iter()
        .chain(CONTACT_KINDS.map(|(_, name)| name))
        .chain(["deepest"]);
    let mut rows = vec![names.map(str::to_owned).collect::<Vec<String>>()];
    rows.extend(pairs.iter().take(MOST_PAIRS).map(|(objects, pair)| {
        let [a, b] = objects.map(|object| short(inspection.report.name(object)));
        row(format!("  {a} – {b}"), pair)
    }));
    let table = aligned(&without_empty_columns(rows));
    let more = inspection.report.contacts.len().saturating_sub(MOST_PAIRS);
    let more = if more > 0 { format!("  and {} more\n", count(more)) } else { String::new() };
    format!("{}\n{table}{more}", meetings(inspection))
}

/// Says how many pairs of objects meet, and how many of them only touch.
pub fn meetings(inspection: &Inspection) -> String {
    let pairs = &inspection.report.contacts;
    let touching = pairs.touching();
    let all = format!("{} pair{} of objects", count(pairs.len()), plural(pairs.len()));
    match pairs.len() - touching {
        0 => format!("{all} that only touch"),
        _ if touching == 0 => format!("{all} that pass through each other"),
        crossing => format!(
            "{all} that meet: {} only touch, {} pass through each other",
            count(touching),
            count(crossing)
        ),
    }
}

/// Leaves out the columns that have nothing below their heads.
fn without_empty_columns(rows: Vec<Vec<String>>) -> Vec<Vec<String>> {
    let columns = 0..rows.first().map_or(0, Vec::len);
    let filled: Vec<bool> =
        columns.map(|column| rows[1..].iter().any(|row| row[column] != NONE)).collect();
    let kept = |row: Vec<String>| {
        row.into_iter().zip(&filled).filter(|(_, filled)| **filled).map(|(cell, _)| cell).collect()
    };
    rows.into_iter().map(kept).collect()
}

fn row(name: String, pair: &ObjectPair) -> Vec<String> {
    let some = |number: usize| if number == 0 { NONE.into() } else { count(number) };
    let depth = if pair.deepest.depth > 0.0 { value(pair.deepest.depth) } else { NONE.into() };
    let counts = [pair.faces()].into_iter().chain(pair.counts).map(some);
    [name].into_iter().chain(counts).chain([depth]).collect()
}
