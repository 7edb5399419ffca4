//! Numbers of the candidates for contraction, and their states.

use meshlod_mesh::FaceId;

/// Number of a candidate for contraction: side k of face f, from corner k to corner k + 1, is 4f +
/// k; the face itself is 4f + 3.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CandidateId(pub(crate) u32);

impl CandidateId {
    #[inline]
    pub(crate) fn side(face: FaceId, k: usize) -> Self {
        Self(face.0 * 4 + k as u32)
    }

    #[inline]
    pub(crate) fn whole(face: FaceId) -> Self {
        Self(face.0 * 4 + 3)
    }

    #[inline]
    pub(crate) fn face(self) -> FaceId {
        FaceId(self.0 / 4)
    }

    /// Returns the index of a candidate among the four of its face: 0 to 2 for a side, 3 for the
    /// face.
    #[inline]
    pub(crate) fn slot(self) -> usize {
        (self.0 % 4) as usize
    }
}

/// State of a candidate for contraction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum State {
    /// Not open for contraction at present.
    #[default]
    Closed,
    /// Waiting in the queue.
    Queued,
    /// Refused, and out of the queue until its neighbourhood changes.
    Parked,
    /// No longer open, but its queue entry remains and is dropped when it comes up.
    Ghost,
}

/// States of a face's four candidates, two bits each.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct States(u8);

impl States {
    #[inline]
    pub(crate) fn get(self, slot: usize) -> State {
        match self.0 >> (2 * slot) & 3 {
            0 => State::Closed,
            1 => State::Queued,
            2 => State::Parked,
            _ => State::Ghost,
        }
    }

    #[inline]
    pub(crate) fn set(&mut self, slot: usize, state: State) {
        self.0 = self.0 & !(3 << (2 * slot)) | (state as u8) << (2 * slot);
    }
}
