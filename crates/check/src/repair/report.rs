//! What a repair did: one count for each step.

/// A count of what was done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum RepairStep {
    /// Layers, labels and corners left out that do not fit, and wedges that stood at two vertices.
    BadAttributes,
    /// Faces left out that name a vertex that is not there, or not finite.
    BadFaces,
    /// Vertices left out that are not finite.
    BadVertices,
    /// Vertices that became one with another.
    Welded,
    /// Faces left out that were there twice, the same way round.
    Duplicates,
    /// Edges flipped to give a face without area some of its neighbour's.
    FlippedEdges,
    /// Faces left out that had no area.
    Degenerate,
    /// Edges of three faces or more that were taken apart.
    SplitEdges,
    /// Vertices that came from taking edges and vertices apart.
    SplitVertices,
    /// Faces turned to agree with their neighbours.
    TurnedFaces,
    /// Shells left as they are, since their faces cannot all agree.
    NotOrientable,
    /// Pairs of border edges that became one edge each.
    Stitched,
    /// Holes closed.
    FilledHoles,
    /// Faces that close them.
    FillingFaces,
    /// Holes within the limits left open, since no filling fits.
    HolesLeft,
    /// Holes within the limits left open, since there are so many: the largest.
    HolesUntried,
    /// Closed shells turned to look outwards.
    TurnedShells,
    /// Vertices left out that no face uses.
    Unused,
}

impl RepairStep {
    /// Every step, in the order in which they are done.
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

    /// Its name in reports.
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

    /// Whether it counts what was left as it was, rather than what was done.
    pub fn is_left(self) -> bool {
        matches!(self, Self::NotOrientable | Self::HolesLeft | Self::HolesUntried)
    }
}

/// What a repair did: one count for each step.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RepairReport {
    counts: [usize; RepairStep::ALL.len()],
}

impl RepairReport {
    /// Counts more of a step; so reports of several meshes become one.
    pub fn add(&mut self, step: RepairStep, count: usize) {
        self.counts[step as usize] += count;
    }

    /// This and then another: what was done is summed, what is left is what the other left.
    pub fn then(mut self, other: &Self) -> Self {
        for step in RepairStep::ALL {
            match step.is_left() {
                true => self.counts[step as usize] = other.count(step),
                false => self.add(step, other.count(step)),
            }
        }
        self
    }

    /// The count of a step.
    pub fn count(&self, step: RepairStep) -> usize {
        self.counts[step as usize]
    }

    /// The steps with something to tell, in their order, and their counts.
    pub fn told(&self) -> impl Iterator<Item = (RepairStep, usize)> + '_ {
        RepairStep::ALL
            .into_iter()
            .map(|step| (step, self.count(step)))
            .filter(|&(_, count)| count > 0)
    }

    /// Whether nothing was changed.
    pub fn is_nothing(&self) -> bool {
        self.told().all(|(step, _)| step.is_left())
    }
}
