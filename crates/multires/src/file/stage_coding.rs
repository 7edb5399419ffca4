//! Coding of stages, which mostly rise with errors.

use std::io;

use super::range_coder::{BitCoder, Decoder, Encoder};
use super::residual_models::ColumnModels;
use super::streams::{Packer, Unpacker};
use crate::forest::Stage;

/// Encodes stages relative to the least one, given the errors of their updates.
pub(super) fn write(stages: &[Stage], errors: &[u32], packer: &mut Packer) -> io::Result<()> {
    let numbers = || stages.iter().map(|stage| i32::from(stage.number()));
    let least = numbers().min().unwrap_or(0);
    packer.numbers(&[least as u32])?;
    let (mut encoder, mut models) = (Encoder::new(), StageModels::new());
    for (number, &error) in numbers().zip(errors) {
        models.code(&mut encoder, error, number - least);
    }
    packer.encoded(stages.len(), &encoder.finish())
}

/// Decodes stages.
pub(super) fn read(errors: &[u32], input: &mut Unpacker<'_>) -> io::Result<Vec<Stage>> {
    let least = input.numbers::<u32>(1)?[0];
    let bytes = input.encoded(errors.len())?;
    let (mut decoder, mut models) = (Decoder::new(&bytes), StageModels::new());
    let stage = |&error: &u32| {
        let above = u32::try_from(models.code(&mut decoder, error, 0)).ok();
        above.and_then(|above| Stage::new(above.checked_add(least)?))
    };
    let stages: Option<Vec<Stage>> = errors.iter().map(stage).collect();
    stages.filter(|_| decoder.is_at_end()).ok_or(io::ErrorKind::InvalidData.into())
}

/// Classes of errors: of each octave two, from the least error of a chunk on.
const CLASSES: usize = 48;

/// Models of the stages of a chunk, by errors.
struct StageModels {
    models: ColumnModels,
    /// Mean stage of each class of errors, in sixteenths; `None` before the first.
    means: [Option<i32>; CLASSES],
    last: i32,
    /// Size of the residual before.
    near: usize,
}

impl StageModels {
    fn new() -> Self {
        let models = ColumnModels::new();
        Self { models, means: [None; CLASSES], last: 0, near: 0 }
    }

    /// Codes a stage, which a decoder ignores, and returns it.
    fn code(&mut self, coder: &mut impl BitCoder, error: u32, number: i32) -> i32 {
        let class = (error as usize / 4).min(CLASSES - 1);
        let mean = self.means[class].unwrap_or(self.last);
        let predicted = (mean + 8) >> 4;
        let residual = self.models.code(coder, 0, [class, self.near], number - predicted);
        // Only damaged data is out of range.
        let number = predicted.wrapping_add(residual).clamp(0, i32::from(Stage::COUNT));
        self.near = residual.unsigned_abs().min(15) as usize;
        self.means[class] = Some(mean + ((number << 4) - mean) / 4);
        self.last = number << 4;
        number
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_come_back() {
        let stages: Vec<Stage> = (0..500).map(|i| Stage::before(i * i % 7919)).collect();
        let errors: Vec<u32> = (0..500).map(|i| i * 37 % 300).collect();
        for count in [0, 1, 500] {
            let (stages, errors) = (&stages[..count], &errors[..count]);
            let mut packer = Packer::new().unwrap();
            write(stages, errors, &mut packer).unwrap();
            let bytes = packer.finish().unwrap();
            let mut input = Unpacker::new(&bytes).unwrap();
            assert_eq!(read(errors, &mut input).unwrap(), stages);
            assert!(input.is_at_end().unwrap());
        }
    }

    #[test]
    fn stages_beyond_the_last_are_refused() {
        let mut packer = Packer::new().unwrap();
        packer.numbers(&[u32::from(Stage::COUNT)]).unwrap();
        packer.encoded(1, &[]).unwrap();
        let bytes = packer.finish().unwrap();
        assert!(read(&[0], &mut Unpacker::new(&bytes).unwrap()).is_err());
    }
}
