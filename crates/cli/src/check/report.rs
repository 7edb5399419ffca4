//! JSON report of a mesh check.

use meshlod::check::{Finding, Intersection, Kind, ObjectId};
use serde_json::{Value, json};

use crate::check::inspection::Inspection;
use crate::check::sites::Sites;
use meshlod::jobs::CONTACT_KINDS;
use meshlod::jobs::{CheckReport, Grade, ListedFinding};

/// Returns the report of a mesh check as JSON: counts by kind, findings, contacts by pair of
/// objects.
pub fn json(inspection: &Inspection, sites: &Sites) -> Value {
    let report = &inspection.report;
    let CheckReport { owners, summary, limit, .. } = report;
    let objects = &owners.objects;
    let looked_for =
        || Kind::ALL.into_iter().filter(|&kind| inspection.report.kinds.contains(kind));
    let counts = looked_for().map(|kind| (kind.name().to_owned(), summary.count(kind).into()));
    let left_out = looked_for().map(|kind| (kind, inspection.report.left_out(kind)));
    let left_out = left_out.filter(|&(_, count)| count > 0);
    let pairs = inspection.report.contacts.by_size();
    json!({
        "vertices": report.vertices,
        "faces": report.faces,
        "objects": objects.names.len(),
        "components": objects.components,
        "clean": report.is_clean(),
        "not_compared": report.not_compared,
        "errors": inspection.report.count(Grade::Error),
        "warnings": inspection.report.count(Grade::Warning),
        "touches": inspection.report.count(Grade::Touch),
        "counts": Value::Object(counts.collect()),
        "findings": listed(report).map(|finding| of(inspection, finding)).collect::<Vec<_>>(),
        "findings_left_out": Value::Object(
            left_out.map(|(kind, count)| (kind.name().to_owned(), count.into())).collect()
        ),
        "contacts": pairs.iter().take(*limit).map(|(objects, pair)| {
            let mut json = json!({
                "objects": objects,
                "names": objects.map(|object| inspection.report.name(object)),
                "face_pairs": pair.faces(),
                "deepest": touch(&pair.deepest),
                "deepest_faces": pair.faces,
            });
            for ((_, name), count) in CONTACT_KINDS.into_iter().zip(pair.counts) {
                json[name] = count.into();
            }
            json
        }).collect::<Vec<_>>(),
        "contacts_left_out": report.contacts.len().saturating_sub(*limit),
        "sites": sites.several(),
    })
}

/// Iterates over the findings to list: none, if their limit is 0.
fn listed(report: &CheckReport) -> impl Iterator<Item = ListedFinding<'_>> {
    report.listed().filter(|_| report.limit > 0)
}

/// Returns the JSON of a finding with its kind, position and ids.
fn of(inspection: &Inspection, found: ListedFinding<'_>) -> Value {
    let mut json = ids(inspection, found.finding);
    json["kind"] = json!(found.group.kind);
    json["severity"] = found.group.grade.name().into();
    json["place"] = json!(found.place);
    json
}

fn ids(inspection: &Inspection, finding: &Finding) -> Value {
    let name = |object: &ObjectId| inspection.report.name(*object);
    match finding {
        Finding::NonFiniteVertex { vertex } | Finding::UnusedVertex { vertex } => {
            json!({ "vertices": [vertex] })
        }
        Finding::BadIndex { face, vertex } => json!({ "faces": [face], "vertices": [vertex] }),
        Finding::BadAttributes { error } => json!({ "reason": error.to_string() }),
        Finding::CoincidentVertices { vertices } => json!({ "vertices": vertices }),
        Finding::DegenerateFace { face, shape } => json!({ "faces": [face], "shape": shape }),
        Finding::DuplicateFace { face, of } => json!({ "faces": [face, of] }),
        Finding::InconsistentEdge { edge, faces } => json!({ "vertices": edge, "faces": faces }),
        Finding::BoundaryLoop { vertices, closed } => {
            json!({ "vertices": vertices, "closed": closed })
        }
        Finding::NonManifoldEdge { edge, faces } => json!({ "vertices": edge, "faces": faces }),
        Finding::NonManifoldVertex { vertex, fans } => {
            json!({ "vertices": [vertex], "fans": fans })
        }
        Finding::InsideOut { face, volume } => json!({ "faces": [face], "volume": volume }),
        Finding::SelfIntersection { object, faces, intersection } => json!({
            "objects": [object], "names": [name(object)],
            "faces": faces, "touch": touch(intersection),
        }),
        Finding::Contact { objects, faces, intersection } => json!({
            "objects": objects, "names": objects.each_ref().map(name),
            "faces": faces, "touch": touch(intersection),
        }),
        Finding::Crowded { found } => json!({ "found": found }),
    }
}

fn touch(touch: &Intersection) -> Value {
    let name = CONTACT_KINDS.iter().find(|(kind, _)| *kind == touch.kind).map(|(_, name)| name);
    json!({ "kind": name, "depth": touch.depth, "place": touch.point })
}
