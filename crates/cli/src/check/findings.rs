//! Section of the report page about the findings: a table of groups, then their places.

use maud::{Markup, html};
use meshlod::check::Finding;

use crate::check::advice::{Advice, advice};
use crate::check::inspection::Inspection;
use crate::check::places::{coordinates, ids, objects};
use crate::check::sites::Sites;
use crate::page::counts::Counts;
use crate::page::facts::facts;
use crate::page::figures::whole;
use crate::text::numbers::{count, value};
use meshlod::jobs::CONTACT_KINDS;
use meshlod::jobs::{Group, ListedFinding};

/// Limit of places listed of a group; the JSON has more.
const MOST_PLACES: usize = 25;

/// Builds the section: what is found, what to do about it, and where it is.
pub fn findings(inspection: &Inspection, sites: &Sites) -> Markup {
    html! {
        section id="findings" {
            h2 { "Findings" }
            @if let Some(drawn) = &inspection.drawn {
                div.intro { (facts(&Counts::of(&drawn.mesh))) }
            }
            @if inspection.report.groups().next().is_some() {
                (overview(inspection))
                @for (group, number) in inspection.report.groups() { (places(inspection, sites, group, number)) }
            }
        }
    }
}

fn overview(inspection: &Inspection) -> Markup {
    html! {
        div.scroll tabindex="0" role="region" aria-label="Findings" { table.words {
            thead { tr {
                th scope="col" { "Kind" } th scope="col" { "Count" } th scope="col" { "What to do" }
            } }
            tbody { @for (group, number) in inspection.report.groups() { tr {
                th scope="row" {
                    (badge(group)) " " a href=(format!("#{}", anchor(group))) { (group.kind.name()) }
                }
                td { (whole(number)) }
                td.text { (commands(advice(group).remedy)) }
            } } }
        } }
    }
}

/// Lists the first places of a group: ids, objects and coordinates.
fn places(inspection: &Inspection, sites: &Sites, group: Group, number: usize) -> Markup {
    let Advice { about, .. } = advice(group);
    let listed: Vec<ListedFinding<'_>> =
        inspection.report.of_group(group).take(MOST_PLACES).collect();
    let more = number - listed.len();
    let several = inspection.report.owners.objects.names.len() > 1;
    let label = format!("Places: {}", group.kind.name());
    html! {
        h3.places id=(anchor(group)) { (group.kind.name()) " " (badge(group)) }
        p.about { (about) }
        div.scroll tabindex="0" role="region" aria-label=(label) { table.words {
            thead { tr {
                th scope="col" { "Vertices or faces" }
                @if several { th scope="col" { "Objects" } }
                th scope="col" { "At x y z" } th scope="col" {}
            } }
            tbody { @for found in &listed { tr {
                th scope="row" { (ids(found.finding, sites)) }
                @if several { td { (objects(found, inspection)) } }
                td { (found.place.map(coordinates).unwrap_or_default()) }
                td { (detail(found.finding)) }
            } } }
        } }
        @if more > 0 {
            p.about { "And " (count(more)) " more, which " code { "check --json --limit N" } " lists." }
        }
    }
}

/// Describes how two faces meet, what a shell encloses, or how many faces share an edge.
fn detail(finding: &Finding) -> String {
    match finding {
        Finding::SelfIntersection { intersection, .. } | Finding::Contact { intersection, .. } => {
            let kind = CONTACT_KINDS.iter().find(|(kind, _)| *kind == intersection.kind);
            let kind = kind.map_or("", |(_, name)| name);
            match intersection.depth > 0.0 {
                true => format!("{kind}, {} deep", value(intersection.depth)),
                false => kind.to_owned(),
            }
        }
        Finding::InsideOut { volume, .. } => format!("volume {}", value(*volume)),
        Finding::NonManifoldEdge { faces, .. } => format!("{} faces", count(faces.len())),
        Finding::NonManifoldVertex { fans, .. } => format!("{} parts", count(*fans)),
        Finding::BoundaryLoop { closed: false, .. } => "not a loop".into(),
        _ => String::new(),
    }
}

/// Shows the grade of a group in its colour.
fn badge(group: Group) -> Markup {
    let grade = group.grade.name();
    html! { span class=(format!("chip {grade}")) { (grade) } }
}

fn anchor(group: Group) -> String {
    format!("{}-{}", group.grade.name(), group.kind.name())
}

/// Shows the words between backticks as code.
fn commands(text: &str) -> Markup {
    html! {
        @for (i, part) in text.split('`').enumerate() {
            @if i % 2 == 1 { code { (part) } } @else { (part) }
        }
    }
}
