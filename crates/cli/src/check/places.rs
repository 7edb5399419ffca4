//! Places of findings in words: ids, objects and coordinates.

use meshlod::check::Finding;
use meshlod::jobs::ListedFinding;

use crate::check::inspection::Inspection;
use crate::check::sites::Sites;
use crate::text::numbers::{count, value};

/// Describes the vertices and faces of a finding by their ids.
pub fn ids(finding: &Finding, sites: &Sites) -> String {
    match finding {
        Finding::BadAttributes { error } => error.to_string(),
        Finding::Crowded { found } => {
            format!("stopped after {} pairs of faces that meet", count(*found))
        }
        Finding::NonFiniteVertex { vertex }
        | Finding::UnusedVertex { vertex }
        | Finding::NonManifoldVertex { vertex, .. } => sites.vertex(*vertex),
        Finding::BadIndex { face, .. }
        | Finding::DegenerateFace { face, .. }
        | Finding::InsideOut { face, .. } => sites.face(*face),
        Finding::CoincidentVertices { vertices } => {
            let two: Vec<String> = vertices.iter().take(2).map(|v| sites.vertex(*v)).collect();
            match vertices.len() {
                ..=2 => two.join(" and "),
                more => format!("{} and {} more", two.join(", "), count(more - 2)),
            }
        }
        Finding::BoundaryLoop { vertices, .. } => {
            format!("{} vertices from {}", count(vertices.len()), sites.vertex(vertices[0]))
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
    }
}

/// Formats coordinates in model units.
pub fn coordinates(place: [f64; 3]) -> String {
    place.map(value).join(" ")
}

/// Names the objects of a finding; empty if the mesh is a single object, or the finding has none.
pub fn objects(found: &ListedFinding<'_>, inspection: &Inspection) -> String {
    if inspection.report.owners.objects.names.len() < 2 {
        return String::new();
    }
    /// Objects named before the others are counted.
    const MOST: usize = 3;
    let objects = found.objects;
    let names = objects.iter().take(MOST).map(|&object| short(inspection.report.name(object)));
    let more = objects.len().saturating_sub(MOST);
    let more = (more > 0).then(|| format!("{} more", count(more)));
    names.chain(more).collect::<Vec<_>>().join(" – ")
}

/// Length at which names of objects are cut.
const LONGEST_NAME: usize = 28;

/// Cuts a long name, and replaces control characters.
pub fn short(name: &str) -> String {
    let name: String = name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    if name.chars().count() <= LONGEST_NAME {
        return name;
    }
    name.chars().take(LONGEST_NAME - 1).chain(['…']).collect()
}
