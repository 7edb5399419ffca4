//! Conversion of a scene to another format: its counts, and its losses.

use meshlod_io::{Format, Note, Precision, Scene};
use meshlod_mesh::Mesh;

use crate::files::limits;
use crate::scene::place::shown_faces;

/// Request of [`convert`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct ConvertRequest {
    /// Format of the file.
    pub format: Format,
    /// Precision of coordinates, where the format leaves a choice.
    #[cfg_attr(feature = "serde", serde(default))]
    pub precision: Precision,
    /// True if the file comes without others beside it, as through a pipe.
    #[cfg_attr(feature = "serde", serde(default))]
    pub alone: bool,
}

/// Report of [`convert`]. Meshes are counted once, however many nodes show them.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ConvertReport {
    /// Number of meshes.
    pub meshes: usize,
    /// Number of vertices that are written, before seams split any.
    pub vertices: usize,
    /// Number of faces.
    pub faces: usize,
    /// Number of faces over all instances of meshes.
    pub shown_faces: usize,
    /// Notes on what the file lacks of the scene. Not part of what serde writes.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub notes: Vec<Note>,
}

/// Returns what a file of another format has of a scene, and what it lacks, before it is written by
/// [`Output::write`](crate::Output::write).
///
/// Cost: linear.
///
/// ```
/// use meshlod::jobs::{ConvertRequest, convert};
/// use meshlod::{Format, Scene, samples};
///
/// let fish = Scene::from_mesh("fish", samples::fish(1_000));
/// let request = ConvertRequest::new(Format::Stl);
/// let lost = convert(&fish, &request).notes;
/// assert!(lost.iter().any(|note| note.to_string().contains("texture coordinates")));
/// ```
pub fn convert(scene: &Scene, request: &ConvertRequest) -> ConvertReport {
    let keeps_unused = scene.keeps_unused_vertices(request.format);
    let is_written = |&&is_used: &&bool| is_used || keeps_unused;
    let written = |mesh: &Mesh| mesh.used_vertices().iter().filter(is_written).count();
    ConvertReport {
        meshes: scene.meshes.len(),
        vertices: scene.meshes.iter().map(|mesh| written(&mesh.mesh)).sum(),
        faces: scene.meshes.iter().map(|mesh| mesh.mesh.faces.len()).sum(),
        shown_faces: shown_faces(scene),
        notes: limits(scene, request),
    }
}

impl ConvertRequest {
    /// Creates the request for a format, with the precision that a scene needs.
    pub fn new(format: Format) -> Self {
        Self { format, precision: Precision::default(), alone: false }
    }
}
