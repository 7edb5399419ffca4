//! Levels chosen for every member in every frame, as `selection.npy`.

use meshlod::flock::select::InstanceLevel;

use crate::recording::{RecordingError, Source, npy};

/// Name of the file.
const FILE: &str = "selection.npy";

/// Level of every member in every frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Selection {
    members: usize,
    levels: Vec<InstanceLevel>,
}

impl Selection {
    /// Creates a selection without frames for a number of members.
    pub fn new(members: usize) -> Self {
        Self { members, levels: Vec::new() }
    }

    /// Adds a frame.
    ///
    /// # Panics
    /// If there is not one level for every member.
    pub fn push(&mut self, levels: &[InstanceLevel]) {
        assert_eq!(levels.len(), self.members, "levels of all members");
        self.levels.extend_from_slice(levels);
    }

    /// Returns the number of frames.
    pub fn frames(&self) -> usize {
        self.levels.len() / self.members.max(1)
    }

    /// Returns the levels of a frame.
    ///
    /// # Panics
    /// If there is no such frame.
    pub fn frame(&self, frame: usize) -> &[InstanceLevel] {
        &self.levels[frame * self.members..(frame + 1) * self.members]
    }

    /// Writes `selection.npy`.
    ///
    /// # Errors
    /// Those of `put`.
    pub fn write<E>(&self, mut put: impl FnMut(&str, &[u8]) -> Result<(), E>) -> Result<(), E> {
        let bits = self.levels.iter().map(|level| level.to_bits());
        put(FILE, &npy::write(&[self.frames(), self.members], bits))
    }

    /// Reads `selection.npy` for a recording of this many frames and members, and a table of this
    /// many levels.
    ///
    /// # Errors
    /// A file that is missing or damaged, another shape, or a level that is not in the table.
    pub fn read(
        source: &mut Source<'_>,
        [frames, members]: [usize; 2],
        levels: usize,
    ) -> Result<Self, RecordingError> {
        let array = source.array::<u16>(FILE, &[Some(frames), Some(members)])?;
        let level = |(at, bits): (usize, &u16)| match usize::from(*bits) {
            HIDDEN => Ok(InstanceLevel::HIDDEN),
            IMPOSTOR => Ok(InstanceLevel::IMPOSTOR),
            level if level < levels => Ok(InstanceLevel::drawn(level)),
            level => {
                let place = format!("frame {}, member {}", at / members, at % members);
                let reason = format!("level {level} is not one of the {levels} in levels.json");
                Err(RecordingError::value(FILE, place, reason))
            }
        };
        let levels = array.values.iter().enumerate().map(level).collect::<Result<_, _>>()?;
        Ok(Self { members, levels })
    }
}

/// Stored value of an impostor.
const IMPOSTOR: usize = u16::MAX as usize - 1;

/// Stored value of a hidden member.
const HIDDEN: usize = u16::MAX as usize;
