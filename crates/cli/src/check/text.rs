//! Text report of a mesh check.

use meshlod::check::{Finding, Kind};

use crate::check::contacts::{KINDS, ObjectPair};
use crate::check::inspection::Inspection;
use crate::check::report::severity;
use crate::check::sites::Sites;
use crate::numbers::{count, faces, plural, value};
use crate::table::aligned;

/// Limit of object pairs on a terminal; JSON and page have more.
const MOST_PAIRS: usize = 12;
/// Length at which names of objects are cut.
const LONGEST_NAME: usize = 28;

/// Formats the report: a table of kinds with the first finding of each, a table of contacts, and
/// totals.
pub fn text(inspection: &Inspection, sites: &Sites) -> String {
    let objects = inspection.objects.names.len();
    let components = inspection.objects.components;
    let mut text = format!(
        "{}, {} object{}, {} component{}\n",
        faces(inspection.mesh.faces.len()),
        count(objects),
        plural(objects),
        count(components),
        plural(components),
    );
    text += &kinds(inspection, sites);
    text += &contacts(inspection);
    text + &format!("{}\n", verdict(inspection))
}

/// Formats the numbers of errors and warnings in words.
pub fn verdict(inspection: &Inspection) -> String {
    let (errors, warnings) = (inspection.errors(), inspection.warnings());
    match (errors, warnings) {
        (0, 0) => "clean".into(),
        _ => format!(
            "{} error{}, {} warning{}",
            count(errors),
            plural(errors),
            count(warnings),
            plural(warnings)
        ),
    }
}

fn kinds(inspection: &Inspection, sites: &Sites) -> String {
    let found: Vec<(Kind, usize)> = inspection.summary.found().collect();
    let row = |&(kind, number): &(Kind, usize)| {
        let name = format!("{:<7}  {}", severity(kind), kind.name());
        [name, count(number)]
    };
    let rows: Vec<[String; 2]> = found.iter().map(row).collect();
    let table = aligned(&rows);
    let first = |kind| inspection.first(kind).map(|finding| first(inspection, sites, finding));
    let lines = table.lines().zip(&found).map(|(line, &(kind, _))| {
        format!("  {line}  {}", first(kind).unwrap_or_default()).trim_end().to_owned() + "\n"
    });
    lines.collect()
}

/// Describes the place of a finding, by ids and position.
pub fn first(inspection: &Inspection, sites: &Sites, finding: &Finding) -> String {
    let ids = match finding {
        Finding::BadAttributes { error } => return error.to_string(),
        Finding::Crowded { found } => {
            return format!("stopped after {} pairs of faces that meet", count(*found));
        }
        Finding::NonFiniteVertex { vertex }
        | Finding::UnusedVertex { vertex }
        | Finding::NonManifoldVertex { vertex, .. } => sites.vertex(*vertex),
        Finding::BadIndex { face, .. }
        | Finding::DegenerateFace { face, .. }
        | Finding::InsideOut { face, .. } => sites.face(*face),
        Finding::CoincidentVertices { vertices } => {
            let [a, b] = [vertices.first(), vertices.get(1)];
            [a, b].into_iter().flatten().map(|v| sites.vertex(*v)).collect::<Vec<_>>().join(" and ")
        }
        Finding::BoundaryLoop { vertices, .. } => {
            let number = vertices.len();
            format!("{} vertices from {}", count(number), sites.vertex(vertices[0]))
        }
        Finding::InconsistentEdge { edge, .. } | Finding::NonManifoldEdge { edge, .. } => {
            edge.map(|v| sites.vertex(v)).join(" to ")
        }
        Finding::DuplicateFace { face, of } => {
            format!("{} duplicates {}", sites.face(*face), sites.face(*of))
        }
        Finding::SelfIntersection { faces, .. } | Finding::Contact { faces, .. } => {
            faces.map(|f| sites.face(f)).join(" and ")
        }
    };
    match finding.place(&inspection.mesh) {
        Some(place) => format!("first: {ids} at {}", place.map(value).join(" ")),
        None => format!("first: {ids}"),
    }
}

/// Formats the table of object pairs, those with the most face pairs first.
fn contacts(inspection: &Inspection) -> String {
    let pairs = inspection.contacts.by_size();
    if pairs.is_empty() {
        return String::new();
    }
    let names =
        ["", "face pairs"].into_iter().chain(KINDS.map(|(_, name)| name)).chain(["deepest"]);
    let mut rows = vec![names.map(str::to_owned).collect::<Vec<String>>()];
    rows.extend(pairs.iter().take(MOST_PAIRS).map(|(objects, pair)| {
        let [a, b] = objects.map(|object| short(inspection.name(object)));
        row(format!("  {a} – {b}"), pair)
    }));
    let table = aligned(&rows);
    let more = pairs.len().saturating_sub(MOST_PAIRS);
    let more = if more > 0 { format!("  and {} more\n", count(more)) } else { String::new() };
    format!(
        "contacts between {} pair{} of objects\n{table}{more}",
        count(pairs.len()),
        plural(pairs.len())
    )
}

fn row(name: String, pair: &ObjectPair) -> Vec<String> {
    let some = |number: usize| if number == 0 { "-".into() } else { count(number) };
    let depth = if pair.deepest.depth > 0.0 { value(pair.deepest.depth) } else { "-".into() };
    let counts = [pair.faces()].into_iter().chain(pair.counts).map(some);
    [name].into_iter().chain(counts).chain([depth]).collect()
}

fn short(name: &str) -> String {
    let name: String = name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    if name.chars().count() <= LONGEST_NAME {
        return name;
    }
    name.chars().take(LONGEST_NAME - 1).chain(['…']).collect()
}
