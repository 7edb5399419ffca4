//! Report of a mesh repair: one count for each step.

/// A step of a mesh repair, or a defect it left; the report has a count for each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum RepairStep {
    /// Mismatched layers, labels and corners that were removed, and wedges of several vertices that
    /// were split.
    BadAttributes,
    /// Faces removed because they had a missing or non-finite vertex.
    BadFaces,
    /// Vertices removed because they had a NaN or infinite coordinate.
    BadVertices,
    /// Vertices welded to another vertex.
    Welded,
    /// Faces removed because they duplicated an earlier face of the same orientation.
    Duplicates,
    /// Edges flipped to give a face of zero area part of its neighbour's area.
    FlippedEdges,
    /// Faces removed because their area was zero.
    Degenerate,
    /// Non-manifold edges split.
    SplitEdges,
    /// Vertices added by splitting edges and vertices.
    SplitVertices,
    /// Faces reversed to agree with their neighbours.
    TurnedFaces,
    /// Shells left unchanged because they cannot be oriented.
    NotOrientable,
    /// Pairs of boundary edges stitched.
    Stitched,
    /// Holes filled.
    FilledHoles,
    /// Faces added to fill holes.
    FillingFaces,
    /// Holes within the size limits that were left open because no triangulation is valid.
    HolesLeft,
    /// Holes within the size limits that were left open because the work allowed for the mesh was
    /// used up; the largest ones.
    HolesUntried,
    /// Closed shells reversed to point outwards.
    TurnedShells,
    /// Vertices removed because no face used them.
    Unused,
}

impl RepairStep {
    /// All repair steps, in the order in which they run.
    pub const ALL: [Self; 18] = [
        Self::BadAttributes,
        Self::BadFaces,
        Self::BadVertices,
        Self::Welded,
        Self::Duplicates,
        Self::FlippedEdges,
        Self::Degenerate,
        Self::SplitEdges,
        Self::SplitVertices,
        Self::TurnedFaces,
        Self::NotOrientable,
        Self::Stitched,
        Self::FilledHoles,
        Self::FillingFaces,
        Self::HolesLeft,
        Self::HolesUntried,
        Self::TurnedShells,
        Self::Unused,
    ];

    /// Returns the name of the step as used in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::BadFaces => "bad-faces",
            Self::BadAttributes => "bad-attributes",
            Self::BadVertices => "bad-vertices",
            Self::Welded => "welded-vertices",
            Self::Duplicates => "duplicate-faces",
            Self::FlippedEdges => "flipped-edges",
            Self::Degenerate => "degenerate-faces",
            Self::SplitEdges => "split-edges",
            Self::SplitVertices => "split-vertices",
            Self::TurnedFaces => "turned-faces",
            Self::NotOrientable => "not-orientable",
            Self::Stitched => "stitched-edges",
            Self::FilledHoles => "filled-holes",
            Self::FillingFaces => "filling-faces",
            Self::HolesLeft => "holes-left",
            Self::HolesUntried => "holes-untried",
            Self::TurnedShells => "turned-shells",
            Self::Unused => "unused-vertices",
        }
    }

    /// Returns true if the step counts defects left in the mesh rather than repairs.
    pub fn is_unresolved(self) -> bool {
        matches!(self, Self::NotOrientable | Self::HolesLeft | Self::HolesUntried)
    }
}

/// Counts of the changes a mesh repair made, one for each step.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RepairReport {
    counts: [usize; RepairStep::ALL.len()],
}

/// Writes the count of every step under its name.
#[cfg(feature = "serde")]
impl serde::Serialize for RepairReport {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(RepairStep::ALL.map(|step| (step.name(), self.count(step))))
    }
}

impl RepairReport {
    /// Adds to the count of a repair step.
    pub fn add(&mut self, step: RepairStep, count: usize) {
        self.counts[step as usize] += count;
    }

    /// Combines the reports of two successive repairs of a mesh: repairs are summed, and the
    /// defects left are those of the second report.
    pub fn then(mut self, other: &Self) -> Self {
        for step in RepairStep::ALL {
            match step.is_unresolved() {
                true => self.counts[step as usize] = other.count(step),
                false => self.add(step, other.count(step)),
            }
        }
        self
    }

    /// Returns the count of a repair step.
    pub fn count(&self, step: RepairStep) -> usize {
        self.counts[step as usize]
    }

    /// Iterates over the repair steps with a nonzero count, in the order of [`RepairStep::ALL`],
    /// with their counts.
    pub fn nonzero(&self) -> impl Iterator<Item = (RepairStep, usize)> + '_ {
        RepairStep::ALL
            .into_iter()
            .map(|step| (step, self.count(step)))
            .filter(|&(_, count)| count > 0)
    }

    /// Returns true if the repair did not change the mesh.
    pub fn is_unchanged(&self) -> bool {
        self.nonzero().all(|(step, _)| step.is_unresolved())
    }
}
