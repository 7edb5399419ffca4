//! The place of an update in the sequence of contractions, in few bits.

use crate::forest::Forest;

/// When a run made an update, counted from its end: 0 for the last contraction, more for earlier
/// ones, in steps of an eighth of an octave.
///
/// An update never has a greater stage than one it depends on. So the updates up to any stage are
/// a cut: the level that the run passed through.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Stage(u16);

/// Bits of a place below its leading one that a stage keeps.
const STEP_BITS: u32 = 3;

impl Stage {
    /// Number of stages, which those of 2³¹ contractions do not exceed.
    pub(crate) const COUNT: u16 = 32 << STEP_BITS;

    /// Returns the stage of the contraction that `after` others follow.
    pub(crate) fn before(after: usize) -> Self {
        let place = (after as u64).saturating_add(1).min(u64::from(u32::MAX));
        let octave = place.ilog2();
        let step = ((place << STEP_BITS) >> octave) & ((1 << STEP_BITS) - 1);
        Self((octave << STEP_BITS) as u16 + step as u16)
    }

    /// Returns the stage of a number, or `None` beyond the last.
    pub(crate) fn new(number: u32) -> Option<Self> {
        u16::try_from(number).ok().filter(|&number| number < Self::COUNT).map(Self)
    }

    pub(crate) fn number(self) -> u16 {
        self.0
    }
}

impl Forest {
    /// Notes the stage of each update, if the mesh has wedges, whose looks errors do not tell.
    pub(super) fn with_stages(mut self) -> Self {
        let count = if self.wedges.is_some() { self.updates.len() } else { 0 };
        for u in 0..count {
            self.updates[u].stage = Stage::before(count - 1 - u);
            if self.updates[u].fused_with_child {
                self.updates[u - 1].stage = self.updates[u].stage;
            }
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_rise_from_the_last_contraction_to_the_first() {
        let stages: Vec<u16> = (0..5000).map(|after| Stage::before(after).number()).collect();
        assert!(stages.is_sorted() && stages[0] == 0 && stages[1] == 8 && stages[4999] == 97);
        assert!(stages.windows(2).skip(8).all(|pair| pair[1] - pair[0] <= 1));
        assert!(Stage::before(usize::MAX).number() < Stage::COUNT);
        assert_eq!(Stage::new(Stage::COUNT.into()), None);
    }
}
