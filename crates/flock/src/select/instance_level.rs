//! Level of one member in one frame.

/// Level that a member is drawn with, or none; two bytes, as an instance buffer wants them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(transparent)]
pub struct InstanceLevel(u16);

impl InstanceLevel {
    /// The member is not drawn.
    pub const HIDDEN: Self = Self(u16::MAX);

    /// Most levels that a table can have.
    pub(crate) const MOST: usize = u16::MAX as usize;

    /// Returns the value for a level of the table, which must be below 65,535.
    #[inline]
    pub fn drawn(level: usize) -> Self {
        debug_assert!(level < Self::MOST);
        Self(level as u16)
    }

    /// Returns the level, an index into [`LevelTable::levels`](crate::levels::LevelTable::levels);
    /// `None` if the member is not drawn.
    #[inline]
    pub fn level(self) -> Option<usize> {
        (self != Self::HIDDEN).then_some(usize::from(self.0))
    }

    /// Returns the value as it is stored: the level, or 65,535 for a member that is not drawn.
    pub fn to_bits(self) -> u16 {
        self.0
    }
}
