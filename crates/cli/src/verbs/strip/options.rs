//! Choices of how strips are made and shortened.

use clap::ValueEnum;
use meshlod::jobs::StripFilter;
use meshlod::strip::StripEffort;

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FilterArg {
    /// No shortening: each vertex is sent as the vertex it was contracted to
    None,
    /// Simple triangle strip scanner
    Stss,
    /// Degenerate-triangle-free filter
    Dtff,
    /// The strips of dtff, improved where the level changed
    Repair,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum QualityArg {
    /// One pass
    Fast,
    /// As few vertices as the search finds
    Best,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum EffortArg {
    /// Fast enough for levels that change often
    Quick,
    /// For levels that are made once and kept
    Thorough,
}

impl From<EffortArg> for StripEffort {
    fn from(tried: EffortArg) -> Self {
        match tried {
            EffortArg::Quick => Self::Quick,
            EffortArg::Thorough => Self::Thorough,
        }
    }
}

impl From<FilterArg> for StripFilter {
    fn from(filter: FilterArg) -> Self {
        match filter {
            FilterArg::None => Self::None,
            FilterArg::Stss => Self::Stss,
            FilterArg::Dtff => Self::Dtff,
            FilterArg::Repair => Self::Repair,
        }
    }
}
