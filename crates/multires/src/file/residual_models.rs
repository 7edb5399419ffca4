//! Models of the residuals of attribute values, each by two contexts.

use super::range_coder::{BitCoder, BitModel};

/// Role of a wedge in the values of an update's children.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// First of a pair: its parent is off the place between both by so many steps.
    Parent,
    /// Second of a pair: the difference of both is off the predicted one.
    Difference,
    /// Any other wedge: it is off its prediction.
    Single,
}

const ROLES: usize = 3;
/// Classes of residuals: numbers of bits without the sign.
const CLASSES: usize = 33;
/// Classes of the children's distance.
const SIZES: usize = 48;
/// Classes of residuals close by.
const NEAR: usize = 16;

/// Models of all columns of a chunk.
pub(super) struct ResidualModels {
    columns: Vec<ColumnModels>,
    /// Class of the residual coded last.
    last: usize,
}

type ClassModels = [BitModel; CLASSES];

/// Models of the numbers of one column.
pub(super) struct ColumnModels {
    /// Models of the bits that a class takes in unary, by role and context.
    by_size: Vec<ClassModels>,
    by_near: Vec<ClassModels>,
    /// Signs, and the highest two bits below the first, by role and class.
    below: Vec<[[BitModel; 2]; 4]>,
    /// Class of the residual coded last in each role.
    last: [usize; ROLES],
}

impl ResidualModels {
    pub(super) fn new(columns: usize) -> Self {
        Self { columns: (0..columns).map(|_| ColumnModels::new()).collect(), last: 0 }
    }

    /// Codes the residuals of a wedge, a number for each column. A decoder overwrites them.
    pub(super) fn code(
        &mut self,
        coder: &mut impl BitCoder,
        role: Role,
        size: u8,
        numbers: &mut [i32],
    ) {
        self.last = 0;
        for (at, number) in numbers.iter_mut().enumerate() {
            let models = &mut self.columns[at];
            let before = models.last[role as usize];
            let near = if at == 0 { before } else { (before + 2 * self.last + 1) / 3 };
            let size = usize::from(size).min(SIZES - 1);
            *number = models.code(coder, role as usize, [size, near.min(NEAR - 1)], *number);
            self.last = models.last[role as usize];
        }
    }
}

impl ColumnModels {
    pub(super) fn new() -> Self {
        let classes = |count: usize| vec![[BitModel::default(); CLASSES]; ROLES * count];
        Self {
            by_size: classes(SIZES),
            by_near: classes(NEAR),
            below: vec![[[BitModel::default(); 2]; 4]; ROLES * CLASSES],
            last: [0; ROLES],
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
        let wanted = (u32::BITS - magnitude.leading_zeros()) as usize;
        let by_size = &mut self.by_size[role * SIZES + size];
        let by_near = &mut self.by_near[role * NEAR + near];
        let mut class = 0;
        while class < CLASSES - 1
            && coder.bit(wanted > class, [&mut by_size[class], &mut by_near[class]])
        {
            class += 1;
        }
        self.last[role] = class;
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
        let (mut encoder, mut models) = (Encoder::new(), ResidualModels::new(2));
        for (i, row) in rows.iter().enumerate() {
            let (role, size) = context(i);
            models.code(&mut encoder, role, size, &mut row.clone());
        }
        let bytes = encoder.finish();
        let (mut decoder, mut models) = (Decoder::new(&bytes), ResidualModels::new(2));
        for (i, row) in rows.iter().enumerate() {
            let (role, size) = context(i);
            let mut read = [0; 2];
            models.code(&mut decoder, role, size, &mut read);
            assert_eq!(read, *row, "{i}");
        }
        assert!(decoder.is_at_end());
    }
}
