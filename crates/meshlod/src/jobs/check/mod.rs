//! Checking a mesh: every finding, by urgency and place, and the contacts between objects.

mod contacts;
mod group;
mod report;

use std::ops::ControlFlow;

use meshlod_check::{CheckOptions, Finding};
use meshlod_mesh::Mesh;

use crate::jobs::{JobError, Watch};

pub use contacts::{CONTACT_KINDS, Contacts, ObjectPair};
pub use group::{Grade, Group, Ownership, is_touch};
pub use report::CheckReport;

/// Request to check a mesh.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct CheckRequest {
    /// Kinds of findings to look for, and the definition of an object.
    pub options: CheckOptions,
    /// Maximum number of findings that are listed of each kind and urgency; all are counted.
    pub limit: usize,
}

/// The first hundred findings of each kind and urgency.
impl Default for CheckRequest {
    fn default() -> Self {
        Self { options: CheckOptions::default(), limit: 100 }
    }
}

/// Checks a mesh, and returns what was found and where.
///
/// # Errors
/// [`JobError::Cancelled`].
pub fn check(
    mesh: &Mesh,
    request: &CheckRequest,
    watch: &dyn Watch,
) -> Result<CheckReport, JobError> {
    check_each(mesh, request, watch, &mut |_, _| {})
}

/// Checks a mesh as [`check`] does, and shows `visit` every finding, with the owners of vertices
/// and faces, as it is found.
///
/// # Errors
/// [`JobError::Cancelled`].
pub fn check_each(
    mesh: &Mesh,
    request: &CheckRequest,
    watch: &dyn Watch,
    visit: &mut dyn FnMut(&Ownership, &Finding),
) -> Result<CheckReport, JobError> {
    watch.stage("checking");
    let mut report = CheckReport::new(mesh, request);
    let flow = meshlod_check::check(mesh, &request.options, &mut |finding| {
        report.add(finding);
        visit(&report.owners, finding);
        match watch.is_cancelled() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    });
    match flow.is_break() {
        true => Err(JobError::Cancelled),
        false => Ok(report),
    }
}

#[cfg(test)]
mod tests;
