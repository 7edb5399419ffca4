//! Coding of the records of updates next to seams.

use std::io;

use super::range_coder::{BitCoder, Decoder, Encoder};
use super::residual_models::ColumnModels;
use super::streams::{Packer, Unpacker};

/// Length of a record, and the numbers of wedges of the two children.
#[derive(Clone, Copy, Debug)]
pub(super) struct RecordShape {
    pub(super) length: usize,
    pub(super) counts: [u32; 2],
}

/// Greatest number of faces that a split creates.
const CREATED: usize = 2;

/// Encodes records.
pub(super) fn write<'r>(
    records: impl Iterator<Item = (RecordShape, &'r [u16])>,
    packer: &mut Packer,
) -> io::Result<()> {
    let (mut encoder, mut models, mut all) = (Encoder::new(), ColumnModels::new(), 0);
    for (shape, record) in records {
        code(&mut encoder, &mut models, shape, |at| record[at].into());
        all += record.len();
    }
    packer.encoded(all, &encoder.finish())
}

/// Decodes records; the caller checks that their numbers have 16 bits.
pub(super) fn read(
    shapes: impl Iterator<Item = RecordShape> + Clone,
    input: &mut Unpacker<'_>,
) -> io::Result<Vec<Vec<i32>>> {
    let all = shapes.clone().fold(0usize, |sum, shape| sum.saturating_add(shape.length));
    let bytes = input.encoded(all)?;
    let (mut decoder, mut models) = (Decoder::new(&bytes), ColumnModels::new());
    let records = shapes.map(|shape| code(&mut decoder, &mut models, shape, |_| 0)).collect();
    if decoder.is_at_end() { Ok(records) } else { Err(io::ErrorKind::InvalidData.into()) }
}

/// Codes a record, whose numbers a decoder does not need, and returns it.
///
/// Contexts are the part of the record, how many wedges the children have, and the two numbers
/// before.
fn code(
    coder: &mut impl BitCoder,
    models: &mut ColumnModels,
    shape: RecordShape,
    number: impl Fn(usize) -> i32,
) -> Vec<i32> {
    let parents = shape.counts[0].saturating_add(shape.counts[1]) as usize;
    let [first, second] = shape.counts.map(|count| count.clamp(1, 4) as usize - 1);
    let (mut before, mut all) = ([0usize; 2], Vec::with_capacity(shape.length));
    for at in 0..shape.length {
        let part = match at {
            _ if at < parents => 0,
            _ if shape.length > parents.saturating_add(CREATED) => 1,
            // Only the faces that these continue.
            _ => 2,
        };
        let [last, other] = before.map(|number| number.min(3));
        let size = 16 * last.min(2) + 4 * first + second;
        let number = models.code(coder, part, [size, 4 * last + other], number(at));
        before = [number.unsigned_abs() as usize, before[0]];
        all.push(number);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_come_back() {
        let records: Vec<Vec<u16>> =
            vec![vec![0, 1, u16::MAX, 0, 0, 2, 3, 1], vec![], vec![7; 30], vec![0; 2000]];
        let shape = |record: &Vec<u16>| RecordShape { length: record.len(), counts: [2, 1] };
        let mut packer = Packer::new().unwrap();
        write(records.iter().map(|record| (shape(record), &record[..])), &mut packer).unwrap();
        let bytes = packer.finish().unwrap();
        assert!(bytes.len() < 100, "{}", bytes.len());
        let mut input = Unpacker::new(&bytes).unwrap();
        let read = read(records.iter().map(shape), &mut input).unwrap();
        assert!(
            read.iter().flatten().eq(records
                .iter()
                .flatten()
                .map(|&x| i32::from(x))
                .collect::<Vec<_>>()
                .iter())
        );
        assert!(input.is_at_end().unwrap());
    }

    #[test]
    fn a_few_bytes_are_not_many_numbers() {
        let mut packer = Packer::new().unwrap();
        packer.encoded(0, &[1, 2, 3]).unwrap();
        let bytes = packer.finish().unwrap();
        for length in [1 << 20, usize::MAX] {
            let shapes = [RecordShape { length, counts: [1, 1] }; 2];
            assert!(read(shapes.into_iter(), &mut Unpacker::new(&bytes).unwrap()).is_err());
        }
    }
}
