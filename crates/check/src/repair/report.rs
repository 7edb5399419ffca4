//! Report of a repair: one count for each step.

/// A step of a repair or a defect it left, with a count in the report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum RepairStep {
    /// Mismatched layers, labels and corners removed, and wedges of several vertices split.
    BadAttributes,
    /// Faces removed that had a missing or non-finite vertex.
    BadFaces,
    /// Non-finite vertices removed.
    BadVertices,
    /// Vertices welded to another.
    Welded,
    /// Duplicate faces of the same orientation removed.
    Duplicates,
    /// Edges flipped to give a face of zero area some of its neighbour's.
    FlippedEdges,
    /// Faces of zero area removed.
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
    /// Holes within the limits left open because no filling is valid.
    HolesLeft,
    /// Largest holes within the limits left open because the work budget was used up.
    HolesUntried,
    /// Closed shells reversed to point outwards.
    TurnedShells,
    /// Unused vertices removed.
    Unused,
}

impl RepairStep {
    /// All steps, in the order in which they run.
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

    /// Returns the name used in reports.
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

    /// Returns true if the step counts defects that were left rather than repairs.
    pub fn is_unresolved(self) -> bool {
        matches!(self, Self::NotOrientable | Self::HolesLeft | Self::HolesUntried)
    }
}

/// Counts of what a repair did, one for each step.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RepairReport {
    counts: [usize; RepairStep::ALL.len()],
}

impl RepairReport {
    /// Adds to the count of a step.
    pub fn add(&mut self, step: RepairStep, count: usize) {
        self.counts[step as usize] += count;
    }

    /// Combines this report with that of a second repair of the same mesh: repairs are summed,
    /// defects left are those that the second left.
    pub fn then(mut self, other: &Self) -> Self {
        for step in RepairStep::ALL {
            match step.is_unresolved() {
                true => self.counts[step as usize] = other.count(step),
                false => self.add(step, other.count(step)),
            }
        }
        self
    }

    /// Returns the count of a step.
    pub fn count(&self, step: RepairStep) -> usize {
        self.counts[step as usize]
    }

    /// Iterates over the steps with a nonzero count, in order, with their counts.
    pub fn nonzero(&self) -> impl Iterator<Item = (RepairStep, usize)> + '_ {
        RepairStep::ALL
            .into_iter()
            .map(|step| (step, self.count(step)))
            .filter(|&(_, count)| count > 0)
    }

    /// Returns true if the repair changed nothing.
    pub fn is_unchanged(&self) -> bool {
        self.nonzero().all(|(step, _)| step.is_unresolved())
    }
}
