//! Checking a mesh: every finding, by urgency and place, and the contacts between objects.

mod contacts;
mod copies;
mod group;
mod report;

use std::ops::ControlFlow;

use meshlod_check::{CheckOptions, Finding, Objects};
use meshlod_io::Scene;
use meshlod_mesh::Mesh;

use crate::jobs::{JobError, Watch};

pub use contacts::{CONTACT_KINDS, Contacts, ObjectPair};
pub use group::{Grade, Group, Ownership, is_touch};
pub use report::{CheckReport, ListedFinding};

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
    look_through(mesh, request, watch, visit)
}

/// Most faces of a scene of copies that is merged: that takes half a second and 150 MB. Where small
/// meshes overlap, a search among instances takes longer: 1,000 crates at one place 100 s instead of 7.
const MERGED: usize = 1 << 20;

/// Checks all that a scene shows, as [`check`] does the mesh that it is [merged](Scene::flatten) into,
/// with the ids of that.
///
/// A scene of more than a million faces that shows its meshes many times, in similar shapes, is not
/// merged. Each mesh is checked
/// once, in its own place: its findings count for every instance, and are listed for the first.
/// Contacts of instances are found where their bounding boxes meet. Where too many do, a scene of up to
/// eight million faces is merged after all; of a larger one, the report has a finding of the kind `crowded`, and `watch` hears how many instances were not compared.
///
/// # Errors
/// [`JobError::Cancelled`], and copies with more than 2^32 faces or vertices in all.
pub fn check_scene(
    scene: Scene,
    request: &CheckRequest,
    watch: &dyn Watch,
) -> Result<CheckReport, JobError> {
    watch.stage("checking");
    if let Some(placed) = copies::PlacedInstances::of(&scene)?
        && placed.faces > MERGED
        && let Some(report) = copies::check(&scene, &placed, request, watch)?
    {
        return Ok(report);
    }
    look_through(&scene.into_mesh(), request, watch, &mut |_, _| {})
}

/// Checks a mesh, and shows `visit` every finding.
fn look_through(
    mesh: &Mesh,
    request: &CheckRequest,
    watch: &dyn Watch,
    visit: &mut dyn FnMut(&Ownership, &Finding),
) -> Result<CheckReport, JobError> {
    let owners = Ownership::new(mesh, Objects::of(mesh, request.options.objects));
    let mut report = CheckReport::new([mesh.positions.len(), mesh.faces.len()], owners, request);
    let flow = meshlod_check::check(mesh, &request.options, &mut |finding| {
        report.add(mesh, finding);
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
