//! Repair: what can be mended safely, step by step, each counted.

mod attributes;
mod degenerate;
mod duplicate;
mod edit;
mod holes;
mod meeting;
mod orient;
mod outward;
mod patch;
mod report;
mod sound;
mod split;
mod split_pairs;
mod stitch;
mod turn;

use meshlod_mesh::{Mesh, weld};

pub(crate) use edit::{drop_unused, labels, retain_faces};
pub use holes::HoleLimits;
pub use report::{RepairReport, RepairStep};
pub(crate) use stitch::stitch;

/// What is mended.
///
/// What is on by default leaves the surface where it is: nothing that was seen goes, nothing that
/// was not there comes.
#[derive(Clone, Debug, PartialEq)]
pub struct RepairOptions {
    /// Make one vertex of those within this of each other, in model units, wherever they are; 0
    /// for those at one place. Off by default: what only touches would grow together.
    pub weld: Option<f64>,
    /// Leave out faces without an area; on by default.
    pub degenerate: bool,
    /// Leave out faces that are there twice, the same way round; on by default.
    pub duplicates: bool,
    /// Take apart edges of three faces or more, and vertices of several fans; on by default.
    pub split: bool,
    /// Join borders whose edges lie within this of each other, in model units, where that makes a
    /// manifold; 0, the default, for those at one place.
    pub stitch: Option<f64>,
    /// Turn faces until neighbours agree, and closed shells until they look outwards; on by
    /// default.
    pub orient: bool,
    /// Close holes; off by default, since what closes them was not there.
    pub holes: Option<HoleLimits>,
    /// Leave out vertices that no face uses; on by default.
    pub unused: bool,
}

impl Default for RepairOptions {
    fn default() -> Self {
        Self {
            weld: None,
            degenerate: true,
            duplicates: true,
            split: true,
            stitch: Some(0.0),
            orient: true,
            holes: None,
            unused: true,
        }
    }
}

/// Mends what `options` say, and tells what was done.
///
/// Takes any value, also one that [`Mesh::validate`] refuses; what it gives back passes. Faces that
/// name a vertex that is not there, or not finite, are always left out. Steps follow each other in the
/// order of [`RepairStep::ALL`]; each gives the next what it needs. Faces and vertices keep their
/// order; a vertex that is taken apart keeps its id for its first faces.
///
/// With the default options no finding of [`Severity::Error`](crate::Severity) is left, but the
/// inconsistent edges of shells that cannot be oriented, which the report counts; and repairing
/// again changes nothing.
///
/// Cost: linear, but for the sorting of what is mended.
pub fn repair(mesh: &Mesh, options: &RepairOptions) -> (Mesh, RepairReport) {
    let mut mesh = mesh.clone();
    let mut report = RepairReport::default();
    let mut add = |step, count| report.add(step, count);
    add(RepairStep::BadAttributes, attributes::mend(&mut mesh));
    let sound::Dropped { faces, vertices } = sound::drop_bad(&mut mesh);
    add(RepairStep::BadFaces, faces);
    add(RepairStep::BadVertices, vertices);
    if let Some(epsilon) = options.weld {
        add(RepairStep::Welded, weld(&mut mesh, epsilon));
    }
    if options.duplicates {
        add(RepairStep::Duplicates, duplicate::drop_duplicates(&mut mesh));
    }
    if options.degenerate {
        let degenerate::Mended { flipped, dropped } = degenerate::mend(&mut mesh);
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
    if let Some(epsilon) = options.stitch {
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
