//! Repair: removes defects that can be removed safely, step by step.
//!
//! | files, in reading order | hold |
//! |---|---|
//! | `edit`, `report` | a mesh being repaired, and what was done |
//! | `invalid`, `duplicate`, `degenerate`, `attributes` | what is dropped |
//! | `split`, `pair_sides`, `orient`, `reverse` | non-manifold edges, and orientation |
//! | `stitch`, `holes`, `triangulate`, `intersecting` | borders and holes |
//! | `outward` | closed shells |

mod attributes;
mod degenerate;
mod duplicate;
mod edit;
mod holes;
mod intersecting;
mod invalid;
mod orient;
mod outward;
mod pair_sides;
mod report;
mod reverse;
mod split;
mod stitch;
mod triangulate;

use meshlod_mesh::{Mesh, weld};

pub(crate) use edit::{drop_unused, retain_faces};
pub use holes::HoleLimits;
pub use report::{RepairReport, RepairStep};
pub(crate) use stitch::stitch;

/// Selection of repair steps; see [`repair`](repair()).
///
/// The steps on by default preserve the visible surface: they neither remove nor add any of it.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct RepairOptions {
    /// Largest distance at which vertices are welded, in model units; 0 welds vertices at the same
    /// position. `None`, the default, welds nothing, as parts that only touch would be joined.
    pub weld: Option<f64>,
    /// True to remove faces of zero area; on by default.
    pub degenerate: bool,
    /// True to remove duplicate faces of the same orientation; on by default.
    pub duplicates: bool,
    /// True to split non-manifold edges and non-manifold vertices; on by default.
    pub split: bool,
    /// Choice of the boundary edges to stitch; by default those at the same positions.
    pub stitch: Stitch,
    /// True to reverse faces until neighbours agree, and closed shells that point inwards; on by
    /// default.
    pub orient: bool,
    /// Limits on the size of holes to fill; `None`, the default, fills no hole, since that adds
    /// surface.
    pub holes: Option<HoleLimits>,
    /// True to remove vertices that no face uses; on by default.
    pub unused: bool,
}

impl Default for RepairOptions {
    fn default() -> Self {
        Self {
            weld: None,
            degenerate: true,
            duplicates: true,
            split: true,
            stitch: Stitch::default(),
            orient: true,
            holes: None,
            unused: true,
        }
    }
}

/// Policy for stitching boundary edges, which is done only where the result is manifold.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Stitch {
    /// Leaves boundary edges as they are.
    Off,
    /// Stitches boundary edges at the same positions.
    #[default]
    Exact,
    /// Stitches boundary edges within this distance of each other, in model units; 0 is as good as
    /// [`Stitch::Exact`].
    Within(f64),
}

impl Stitch {
    fn epsilon(self) -> Option<f64> {
        match self {
            Self::Off => None,
            Self::Exact => Some(0.0),
            Self::Within(epsilon) => Some(epsilon),
        }
    }
}

/// Repairs a mesh by the steps that `options` selects, and reports the changes.
///
/// Accepts any mesh, even one that [`Mesh::validate`] refuses; the result passes. Faces with
/// missing or non-finite vertices are always removed. Steps run in the order of
/// [`RepairStep::ALL`], each preparing the next. Faces and vertices keep their order; a vertex that
/// is split keeps its id for its first faces.
///
/// With the default options the only findings of [`Severity::Error`](crate::Severity) left are
/// inconsistent edges of shells that cannot be oriented, which the report counts; repairing again
/// changes nothing.
///
/// Cost: linear, apart from sorting what is repaired.
pub fn repair(mesh: &Mesh, options: &RepairOptions) -> (Mesh, RepairReport) {
    let mut mesh = mesh.clone();
    let mut report = RepairReport::default();
    let mut add = |step, count| report.add(step, count);
    add(RepairStep::BadAttributes, attributes::repair(&mut mesh));
    let invalid::Dropped { faces, vertices } = invalid::drop_invalid(&mut mesh);
    add(RepairStep::BadFaces, faces);
    add(RepairStep::BadVertices, vertices);
    if let Some(epsilon) = options.weld {
        add(RepairStep::Welded, weld(&mut mesh, epsilon));
    }
    if options.duplicates {
        add(RepairStep::Duplicates, duplicate::drop_duplicates(&mut mesh));
    }
    if options.degenerate {
        let degenerate::Removed { flipped, dropped } = degenerate::remove(&mut mesh);
        add(RepairStep::FlippedEdges, flipped);
        add(RepairStep::Degenerate, dropped);
    }
    if options.split {
        let split::Split { edges, vertices } = split::split(&mut mesh);
        add(RepairStep::SplitEdges, edges);
        add(RepairStep::SplitVertices, vertices);
    }
    if options.orient {
        let orient::Oriented { turned, impossible } = orient::agree(&mut mesh);
        add(RepairStep::TurnedFaces, turned);
        add(RepairStep::NotOrientable, impossible);
    }
    if let Some(epsilon) = options.stitch.epsilon() {
        add(RepairStep::Stitched, stitch::stitch(&mut mesh, epsilon));
    }
    if let Some(limits) = &options.holes {
        let holes::Filled { holes, faces, left, untried } =
            holes::fill(&mut mesh, limits, HoleLimits::MOST_WEIGHED);
        add(RepairStep::FilledHoles, holes);
        add(RepairStep::FillingFaces, faces);
        add(RepairStep::HolesLeft, left);
        add(RepairStep::HolesUntried, untried);
    }
    if options.orient {
        add(RepairStep::TurnedShells, outward::turn_outward(&mut mesh));
    }
    if options.unused {
        add(RepairStep::Unused, edit::drop_unused(&mut mesh));
    }
    (mesh, report)
}

#[cfg(test)]
mod tests;
