//! The request for strips.

use meshlod_simplify::Target;
use meshlod_strip::{StripEffort, StripOptions, StripQuality};

use crate::Constraints;
use crate::jobs::JobError;
use crate::numbers::plural;

/// Request of [`strip`](super::strip).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct StripRequest {
    /// Sizes of the levels, in numbers of faces or parts of them; those of the mesh before fusing.
    pub levels: Vec<Target>,
    /// Filter that shortens the strips of the whole mesh, carried down to each level; `None` to give
    /// each level strips of its own.
    pub filter: Option<StripFilter>,
    /// Quality of the strips of the mesh or of a level.
    pub quality: StripQuality,
    /// Effort of [`StripFilter::Repair`].
    pub effort: StripEffort,
    /// True to compare what the strips draw with the levels, which are simplified a second time for
    /// that.
    pub verify: bool,
    /// Constraints on every level. The topology is always kept, whatever these say, since all levels
    /// share the vertices of the mesh.
    pub constraints: Constraints,
}

impl Default for StripRequest {
    fn default() -> Self {
        Self {
            levels: vec![Target::Ratio(1.0)],
            filter: None,
            quality: StripQuality::Fast,
            effort: StripEffort::Thorough,
            verify: false,
            constraints: Constraints::default(),
        }
    }
}

/// Filter that shortens the strips of a whole mesh at a level of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum StripFilter {
    /// No shortening: each vertex is sent as the vertex it was contracted to.
    None,
    /// Simple triangle strip scanner.
    Stss,
    /// Degenerate-triangle-free filter.
    Dtff,
    /// The strips of dtff, improved where the level changed.
    Repair,
}

/// Returns options for strips of a quality.
pub(super) fn options(quality: StripQuality) -> StripOptions<'static> {
    StripOptions { quality, ..StripOptions::default() }
}

/// Returns the name of a quality in reports.
pub(super) fn quality_name(quality: StripQuality) -> &'static str {
    match quality {
        StripQuality::Fast => "fast",
        StripQuality::Best { .. } => "best",
    }
}

/// Formats the size of a level: `10%` or `500 faces`.
pub(super) fn size_text(size: Target) -> String {
    match size {
        Target::Faces(faces) => format!("{faces} face{}", plural(faces)),
        // Rounded so that 12.5% does not print as 12.500000000000002%.
        Target::Ratio(ratio) => format!("{}%", (ratio * 1e8).round() / 1e6),
        Target::Error(error) => format!("an error of {error}"),
    }
}

/// Refuses level sizes that are out of range for a mesh of this many faces.
pub(super) fn check_sizes(sizes: &[Target], faces: usize) -> Result<(), JobError> {
    let is_level = |size: &&Target| match size {
        Target::Faces(count) => (1..=faces).contains(count),
        Target::Ratio(ratio) => *ratio > 0.0 && *ratio <= 1.0,
        Target::Error(_) => false,
    };
    match sizes.iter().find(|size| !is_level(size)) {
        None => Ok(()),
        Some(&size) => Err(JobError::request(
            "levels",
            format_args!(
                "{} is out of range; use more than 0% and up to 100%, or 1 to {faces} faces",
                size_text(size)
            ),
        )),
    }
}
