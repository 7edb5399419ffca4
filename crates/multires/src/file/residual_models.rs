//! Models of the residuals of attribute values, each by two contexts.

use super::lineage::Role;
use super::range_coder::{BitCoder, BitModel};

const ROLES: usize = 3;
/// Classes of residuals: numbers of bits without the sign.
const CLASSES: usize = 33;
/// Classes of the children's distance.
const SIZES: usize = 48;
/// Classes of residuals close by.
const NEAR: usize = 16;

/// Models of all columns of a chunk.
pub(super) struct ResidualModels {
    models: Vec<ColumnModels>,
    columns: Vec<ColumnState>,
}

/// State of a column.
struct ColumnState {
    /// Number of its models, which columns share that are alike.
    models: usize,
    /// Class of the residual coded last in each role.
    last: [usize; ROLES],
}

type ClassModels = [BitModel; CLASSES];

/// Models of numbers that are alike.
pub(super) struct ColumnModels {
    /// Models of the bits that a class takes in unary, by role and context.
    by_size: Vec<ClassModels>,
    by_near: Vec<ClassModels>,
    /// Signs, and the highest two bits below the first, by role and class.
    below: Vec<[[BitModel; 2]; 4]>,
}

impl ResidualModels {
    /// Creates the models of columns, given for each the number of those that it takes.
    pub(super) fn new(columns: impl Iterator<Item = usize>) -> Self {
        let columns: Vec<_> =
            columns.map(|models| ColumnState { models, last: [0; ROLES] }).collect();
        let count = columns.iter().map(|column| column.models + 1).max().unwrap_or(0);
        Self { models: (0..count).map(|_| ColumnModels::new()).collect(), columns }
    }

    /// Codes the residuals of a wedge, a number for each column. A decoder overwrites them.
    ///
    /// The difference of a pair comes just before how much its parent is off: both are as large as
    /// the surface is rough.
    pub(super) fn code(
        &mut self,
        coder: &mut impl BitCoder,
        role: Role,
        size: u8,
        numbers: &mut [i32],
    ) {
        let (mut beside, size) = (None, usize::from(size).min(SIZES - 1));
        for (ColumnState { models, last }, number) in self.columns.iter_mut().zip(numbers) {
            let before = match role {
                Role::Parent => last[Role::Difference as usize],
                _ => last[role as usize],
            };
            let near = beside.map_or(before, |beside: usize| (before + 2 * beside + 1) / 3);
            let contexts = [size, near.min(NEAR - 1)];
            *number = self.models[*models].code(coder, role as usize, contexts, *number);
            last[role as usize] = class_of(*number);
            beside = Some(last[role as usize]);
        }
    }
}

/// Returns the number of bits of a residual without its sign.
fn class_of(number: i32) -> usize {
    (u32::BITS - number.unsigned_abs().leading_zeros()) as usize
}

impl ColumnModels {
    pub(super) fn new() -> Self {
        let classes = |count: usize| vec![[BitModel::default(); CLASSES]; ROLES * count];
        Self {
            by_size: classes(SIZES),
            by_near: classes(NEAR),
            below: vec![[[BitModel::default(); 2]; 4]; ROLES * CLASSES],
        }
    }

    /// Codes a number, which a decoder ignores, and returns it, given its role and two contexts.
    pub(super) fn code(
        &mut self,
        coder: &mut impl BitCoder,
        role: usize,
        [size, near]: [usize; 2],
        number: i32,
    ) -> i32 {
        let magnitude = number.unsigned_abs();
        let wanted = class_of(number);
        let by_size = &mut self.by_size[role * SIZES + size];
        let by_near = &mut self.by_near[role * NEAR + near];
        let mut class = 0;
        while class < CLASSES - 1
            && coder.bit(wanted > class, [&mut by_size[class], &mut by_near[class]])
        {
            class += 1;
        }
        if class == 0 {
            return 0;
        }
        let below = &mut self.below[role * CLASSES + class];
        let mut coded = 1u32;
        for bit in (0..class - 1).rev() {
            // The first bit has a model, the second one for each value of the first.
            let model = match coded {
                1 => 1,
                2 | 3 => coded as usize,
                _ => {
                    let bits = bit as u32 + 1;
                    let rest = coder.plain(magnitude & ((1 << bits) - 1), bits);
                    coded = coded << bits | rest;
                    break;
                }
            };
            let [a, b] = &mut below[model];
            coded = coded << 1 | u32::from(coder.bit(magnitude >> bit & 1 == 1, [a, b]));
        }
        let [a, b] = &mut below[0];
        let is_negative = coder.bit(number < 0, [a, b]);
        if is_negative { (coded as i32).wrapping_neg() } else { coded as i32 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::file::range_coder::{Decoder, Encoder};

    #[test]
    fn residuals_come_back() {
        let some = [0, 1, -1, 5, -1000, i32::MAX, i32::MIN, i32::MIN + 1, 77, -3, 2, 0];
        let rows: Vec<[i32; 2]> =
            some.iter().zip(some.iter().rev()).map(|(a, b)| [*a, *b]).collect();
        let roles = [Role::Parent, Role::Difference, Role::Single];
        let context = |i: usize| (roles[i % 3], (i * 37) as u8);
        let (mut encoder, mut models) = (Encoder::new(), ResidualModels::new([0, 0].into_iter()));
        for (i, row) in rows.iter().enumerate() {
            let (role, size) = context(i);
            models.code(&mut encoder, role, size, &mut row.clone());
        }
        let bytes = encoder.finish();
        let (mut decoder, mut models) =
            (Decoder::new(&bytes), ResidualModels::new([0, 0].into_iter()));
        for (i, row) in rows.iter().enumerate() {
            let (role, size) = context(i);
            let mut read = [0; 2];
            models.code(&mut decoder, role, size, &mut read);
            assert_eq!(read, *row, "{i}");
        }
        assert!(decoder.is_at_end());
    }
}
