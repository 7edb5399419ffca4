//! Level of one member in one frame.

use crate::levels::{ChainKind, LevelTable};

/// Level that a member is drawn with, or an impostor, or none; two bytes, as an instance buffer
/// wants them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(transparent)]
pub struct InstanceLevel(u16);

/// Look of a member in the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Appearance {
    /// Chain and depth of its level; a facing level looks like that of the whole chain.
    Level(ChainKind, usize),
    /// It is an impostor.
    Impostor,
}

impl InstanceLevel {
    /// The member is not drawn.
    pub const HIDDEN: Self = Self(u16::MAX);

    /// The member is drawn as an [`Impostor`](crate::levels::Impostor).
    pub const IMPOSTOR: Self = Self(u16::MAX - 1);

    /// Triangles of an impostor.
    pub const IMPOSTOR_TRIANGLES: usize = 2;

    /// Returns the value for a level of the table, which must be below 65,534.
    #[inline]
    pub fn drawn(level: usize) -> Self {
        debug_assert!(level < LevelTable::MAX_LEVELS);
        Self(level as u16)
    }

    /// Returns the level, an index into [`LevelTable::levels`]; `None` if the member is not drawn or
    /// is an impostor.
    #[inline]
    pub fn level(self) -> Option<usize> {
        (self.0 < Self::IMPOSTOR.0).then_some(usize::from(self.0))
    }

    /// Returns true if the member is drawn as an impostor.
    #[inline]
    pub fn is_impostor(self) -> bool {
        self == Self::IMPOSTOR
    }

    /// Returns the number of triangles that are drawn for the member.
    #[inline]
    pub fn triangles(self, table: &LevelTable) -> usize {
        match self {
            Self::HIDDEN => 0,
            Self::IMPOSTOR => Self::IMPOSTOR_TRIANGLES,
            Self(level) => table.triangle_count(level.into()),
        }
    }

    /// Returns how the member looks; `None` if it is not drawn.
    pub fn appearance(self, table: &LevelTable) -> Option<Appearance> {
        if self.is_impostor() {
            return Some(Appearance::Impostor);
        }
        let (chain, depth) = table.appearance(self.level()?);
        Some(Appearance::Level(chain, depth))
    }

    /// Returns the value as it is stored: the level, 65,534 for an impostor, or 65,535 for a member
    /// that is not drawn.
    pub fn to_bits(self) -> u16 {
        self.0
    }
}
