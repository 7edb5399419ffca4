//! The mesh check: searches a mesh for each kind of defect in turn and passes what it finds to a
//! visitor.

pub(crate) mod boundary;
pub(crate) mod edges;
pub(crate) mod faces;
mod fans;
mod intersections;
pub(crate) mod shells;
pub(crate) mod subject;
mod validity;
mod vertices;

use std::ops::ControlFlow;

use meshlod_mesh::Mesh;

use crate::finding::{Finding, Kind};
use crate::intersect::BroadPhase;
use crate::kinds::Kinds;
use crate::objects::ObjectsBy;
use subject::Subject;

/// Options of a mesh check.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct CheckOptions {
    /// Kinds of findings to search for; kinds left out take no time.
    pub kinds: Kinds,
    /// Definition of an object: intersecting faces of two objects are contacts, those of one object
    /// are self-intersections.
    pub objects: ObjectsBy,
    /// Method that finds candidate pairs of intersecting faces; the findings do not depend on it.
    pub broad_phase: BroadPhase,
}

/// Visitor of findings, which may stop the check by breaking.
pub(crate) type Visit<'a> = dyn FnMut(&Finding) -> ControlFlow<()> + 'a;

/// Checks `mesh` and passes every finding to `visit` until it breaks, in the order of [`Kind::ALL`]
/// and within a kind by lowest ids.
///
/// Accepts any mesh, even one that [`Mesh::validate`] refuses: the first kinds report that. A face
/// with a missing or non-finite vertex is excluded from the kinds that follow.
///
/// Returns `Break` if `visit` broke. Cost: linear, apart from the search for intersecting faces;
/// kinds that are not requested or not reached cost nothing.
pub fn check(
    mesh: &Mesh,
    options: &CheckOptions,
    visit: &mut dyn FnMut(&Finding) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let subject = Subject::of(mesh, options);
    for kind in Kind::ALL.into_iter().filter(|&kind| options.kinds.contains(kind)) {
        find(kind, &subject, visit)?;
    }
    ControlFlow::Continue(())
}

/// Returns true if the mesh has no finding of the requested kinds; stops at the first one.
///
/// With `kinds: Kinds::errors()` this corresponds to the exit code of `meshlod check`.
pub fn is_clean(mesh: &Mesh, options: &CheckOptions) -> bool {
    check(mesh, options, &mut |_| ControlFlow::Break(())).is_continue()
}

/// Returns the first finding in the order of [`check`], without searching for more.
pub fn first_finding(mesh: &Mesh, options: &CheckOptions) -> Option<Finding> {
    let mut found = None;
    let _ = check(mesh, options, &mut |finding| {
        found = Some(finding.clone());
        ControlFlow::Break(())
    });
    found
}

/// Returns all findings of a mesh, in the order of [`check`].
pub fn findings(mesh: &Mesh, options: &CheckOptions) -> Vec<Finding> {
    let mut found = Vec::new();
    let _ = check(mesh, options, &mut |finding| {
        found.push(finding.clone());
        ControlFlow::Continue(())
    });
    found
}

/// Dispatches a kind to the function that finds it.
fn find(kind: Kind, subject: &Subject, visit: &mut Visit) -> ControlFlow<()> {
    match kind {
        Kind::NonFiniteVertex => validity::non_finite_vertices(subject, visit),
        Kind::BadIndex => validity::bad_indices(subject, visit),
        Kind::BadAttributes => validity::bad_attributes(subject, visit),
        Kind::UnusedVertex => vertices::unused(subject, visit),
        Kind::CoincidentVertices => vertices::coincident(subject, visit),
        Kind::DegenerateFace => faces::degenerate(subject, visit),
        Kind::DuplicateFace => faces::duplicate(subject, visit),
        Kind::InconsistentEdge => edges::inconsistent(subject, visit),
        Kind::BoundaryLoop => boundary::loops(subject, visit),
        Kind::NonManifoldEdge => edges::non_manifold(subject, visit),
        Kind::NonManifoldVertex => fans::non_manifold_vertices(subject, visit),
        Kind::InsideOut => shells::inside_out(subject, visit),
        Kind::SelfIntersection => intersections::self_intersections(subject, visit),
        Kind::Contact => intersections::contacts(subject, visit),
        Kind::Crowded => intersections::crowded(subject, visit),
    }
}

#[cfg(test)]
mod tests;
