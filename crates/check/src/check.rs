//! The check: every kind of finding in turn, told to a visitor.

pub(crate) mod boundary;
pub(crate) mod edges;
pub(crate) mod faces;
mod fans;
mod meets;
pub(crate) mod shells;
mod sound;
pub(crate) mod subject;
mod vertices;

use std::ops::ControlFlow;

use meshlod_mesh::Mesh;

use crate::finding::{Finding, Kind};
use crate::intersect::Net;
use crate::kinds::Kinds;
use crate::objects::ObjectsBy;
use subject::Subject;

/// What to look for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CheckOptions {
    /// The kinds to find; others cost nothing.
    pub kinds: Kinds,
    /// What an object is, where contacts are told from self-intersections.
    pub objects: ObjectsBy,
    /// What finds the faces that may meet; the findings are the same.
    pub net: Net,
}

/// What is told of findings, one at a time; it may end the check.
pub(crate) type Visit<'a> = dyn FnMut(&Finding) -> ControlFlow<()> + 'a;

/// Tells `visit` all that is found in `mesh`, kind by kind in the order of [`Kind::ALL`], within a
/// kind by the lowest ids, until it breaks.
///
/// Takes any value, also one that [`Mesh::validate`] refuses: that is what the first kinds say.
/// A face that names a vertex that is not there, or not finite, has no part in the kinds that follow.
///
/// Breaks where `visit` did. Cost: linear, beside what meets; a kind that is not asked for, or not
/// reached, costs nothing of its own.
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

/// Whether none of the kinds asked for is found; stops at the first.
///
/// With `kinds: Kinds::errors()` this is what the exit code of `meshlod check` says.
pub fn is_clean(mesh: &Mesh, options: &CheckOptions) -> bool {
    check(mesh, options, &mut |_| ControlFlow::Break(())).is_continue()
}

/// The first finding, in the order of [`check`]; stops there.
pub fn first(mesh: &Mesh, options: &CheckOptions) -> Option<Finding> {
    let mut found = None;
    let _ = check(mesh, options, &mut |finding| {
        found = Some(finding.clone());
        ControlFlow::Break(())
    });
    found
}

/// All findings, in the order of [`check`].
pub fn findings(mesh: &Mesh, options: &CheckOptions) -> Vec<Finding> {
    let mut found = Vec::new();
    let _ = check(mesh, options, &mut |finding| {
        found.push(finding.clone());
        ControlFlow::Continue(())
    });
    found
}

/// Which code finds which kind.
fn find(kind: Kind, subject: &Subject, visit: &mut Visit) -> ControlFlow<()> {
    match kind {
        Kind::NonFiniteVertex => sound::non_finite_vertices(subject, visit),
        Kind::BadIndex => sound::bad_indices(subject, visit),
        Kind::BadAttributes => sound::bad_attributes(subject, visit),
        Kind::UnusedVertex => vertices::unused(subject, visit),
        Kind::CoincidentVertices => vertices::coincident(subject, visit),
        Kind::DegenerateFace => faces::degenerate(subject, visit),
        Kind::DuplicateFace => faces::duplicate(subject, visit),
        Kind::InconsistentEdge => edges::inconsistent(subject, visit),
        Kind::BoundaryLoop => boundary::loops(subject, visit),
        Kind::NonManifoldEdge => edges::non_manifold(subject, visit),
        Kind::NonManifoldVertex => fans::non_manifold_vertices(subject, visit),
        Kind::InsideOut => shells::inside_out(subject, visit),
        Kind::SelfIntersection => meets::self_intersections(subject, visit),
        Kind::Contact => meets::contacts(subject, visit),
        Kind::Crowded => meets::crowded(subject, visit),
    }
}

#[cfg(test)]
mod tests;
