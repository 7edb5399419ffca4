//! Serialization of height fields.

use meshlod_mesh::Mesh;

use super::{SIZES, Sample};
use crate::rtin::{FieldBytesError, HeightField, HeightPrecision};

fn bytes_of(field: &HeightField, precision: HeightPrecision) -> Vec<u8> {
    field.to_bytes(precision).unwrap()
}

/// Returns a field of the given heights, two in a row.
fn strip(heights: &[f64]) -> HeightField {
    let mut mesh: Mesh = Sample::new([2, heights.len() as u32 / 2]).mesh();
    mesh.positions.iter_mut().zip(heights).for_each(|(p, &height)| p[2] = height);
    HeightField::from_mesh(&mesh).unwrap()
}

#[test]
fn heights_come_back_unchanged() {
    for size in SIZES {
        for (up, looks_down) in [(0, true), (1, false), (2, false)] {
            let field = Sample { up, looks_down, ..Sample::new(size) }.field();
            let bytes = bytes_of(&field, HeightPrecision::Exact);
            assert_eq!(HeightField::from_bytes(&bytes), Ok(field));
        }
    }
    let odd = [1e-20, 1e10, -3.5, f64::MIN_POSITIVE / 8.0, 0.1, 1e-300, 7.0, 1e140, -1e140, 0.0];
    for heights in [&odd[..], &[0.0; 10], &[0.1; 10], &[-5.0; 10]] {
        let field = strip(heights);
        let bytes = bytes_of(&field, HeightPrecision::Exact);
        assert_eq!(HeightField::from_bytes(&bytes).unwrap().heights(), heights);
    }
}

#[test]
fn heights_are_rounded_within_their_bound() {
    let field = Sample::new([12, 17]).field();
    let mut lengths = Vec::new();
    for bound in [0.001, 0.01, 0.1, 0.5, 3.0] {
        let bytes = bytes_of(&field, HeightPrecision::Within(bound));
        let read = HeightField::from_bytes(&bytes).unwrap();
        let off = field.heights().iter().zip(read.heights()).map(|(a, b)| (a - b).abs());
        let off = off.fold(0.0, f64::max);
        assert!(off <= bound && read.fit().rounded == off, "{off} of {bound}");
        lengths.push(bytes.len());
    }
    assert!(lengths[4] < lengths[2] && lengths[2] < lengths[0], "{lengths:?}");
    for bound in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(field.to_bytes(HeightPrecision::Within(bound)).is_err());
    }
    // Finer than the numbers themselves.
    let heights = [1e140, 1e-140, 3.0, 0.1];
    let bytes = bytes_of(&strip(&heights), HeightPrecision::Within(1e-150));
    assert_eq!(HeightField::from_bytes(&bytes).unwrap().heights(), heights);
}

#[test]
fn cut_off_bytes_are_errors() {
    for precision in [HeightPrecision::Exact, HeightPrecision::Within(0.1)] {
        let bytes = bytes_of(&Sample::new([7, 12]).field(), precision);
        for length in 0..bytes.len() {
            let read = HeightField::from_bytes(&bytes[..length]);
            assert!(matches!(read, Err(FieldBytesError::Short { .. })), "{length}: {read:?}");
        }
        let longer = [&bytes[..], &[0]].concat();
        assert_eq!(HeightField::from_bytes(&longer), Err(FieldBytesError::Bad("length")));
    }
}

#[test]
fn damaged_bytes_are_errors_or_fields() {
    let field = Sample::new([7, 12]).field();
    let bytes = bytes_of(&field, HeightPrecision::Exact);
    for at in 0..bytes.len() {
        for bit in 0..8 {
            let mut damaged = bytes.clone();
            damaged[at] ^= 1 << bit;
            match HeightField::from_bytes(&damaged) {
                // The header has no checksum, so the placement of the grid may have changed.
                Ok(read) => {
                    assert!(at < 72 || read == field, "byte {at} may not change unseen");
                    assert!(read.bounds().diagonal().is_finite());
                    crate::Rtin::new(&read).certify().unwrap();
                }
                Err(error) => assert!(!error.to_string().is_empty()),
            }
        }
    }
}

#[test]
fn a_header_cannot_ask_for_more_than_its_bytes_are_worth() {
    let flat = strip(&vec![4.0; 200_000]);
    let bytes = bytes_of(&flat, HeightPrecision::Exact);
    assert_eq!(bytes.len(), 200_000usize.div_ceil(256));
    assert_eq!(HeightField::from_bytes(&bytes), Ok(flat));
    for [columns, rows] in [[u32::MAX, u32::MAX], [1 << 15, 1 << 15], [1, 7], [0, 0], [2, 1 << 29]]
    {
        let mut wide = bytes.clone();
        wide[8..12].copy_from_slice(&columns.to_le_bytes());
        wide[12..16].copy_from_slice(&rows.to_le_bytes());
        assert!(HeightField::from_bytes(&wide).is_err());
    }
    // A prefix may be short of that, but not ask for any number.
    let prefix =
        |bytes: &[u8], whole| HeightField::from_prefix(bytes, whole).map(|(_, parts)| parts);
    let [parts, all] = prefix(&bytes[..300], bytes.len() as u64).unwrap();
    assert!(parts <= all);
    let mut wide = bytes[..300].to_vec();
    wide[8..16].copy_from_slice(&[(1u32 << 15).to_le_bytes(); 2].concat());
    assert!(matches!(prefix(&wide, 1 << 40), Err(FieldBytesError::Short { .. })));
}
