//! The codecs against the specification's examples, against each other, and against any bytes.

use proptest::prelude::*;

use super::stream::{Stream, push_varint, unzigzag, zigzag};
use super::*;

fn layout(mode: Mode, count: usize, stride: usize) -> Layout {
    Layout { mode, filter: Filter::None, count, stride }
}

/// A stream of version 0 of one group of elements of four bytes, whose first bytes are `group`.
fn one_group(choice: u8, group: &[u8]) -> Vec<u8> {
    let mut stream = vec![0xa0, choice];
    stream.extend_from_slice(group);
    stream.extend([0; 3 + 32]);
    stream
}

#[test]
fn the_example_of_the_specification_unfolds_to_its_differences() {
    let group = [0x17, 0x5f, 0xf0, 0xbc, 0x77, 0xa9, 0x21, 0x00, 0x34, 0xb5];
    let bytes = decode(&one_group(2, &group), &layout(Mode::Attributes, 16, 4)).unwrap();
    let mut last = 0;
    let differences: Vec<i8> = bytes
        .iter()
        .step_by(4)
        .map(|&byte| byte.wrapping_sub(std::mem::replace(&mut last, byte)) as i8)
        .collect();
    assert_eq!(differences, [-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0]);
}

#[test]
fn planes_and_channels_of_version_1_are_read() {
    // Literal low bytes, a high byte of single bits with one beyond them, the rest all zero.
    let mut stream = vec![0xa1, 0b10_10_00_11];
    stream.extend([2, 1, 0, 0]);
    stream.extend([0b01, 0b1000, 0, 2]);
    stream.extend([0; 24 - 5]);
    stream.extend([0xff, 0, 9, 0, 1]);
    let bytes = decode(&stream, &layout(Mode::Attributes, 4, 4)).unwrap();
    // Shorts: 255 + 1, - 1, + 0, and 0x0200 folded is + 256.
    assert_eq!(bytes, [0, 1, 9, 0, 255, 0, 9, 0, 255, 0, 9, 0, 255, 1, 9, 0]);
    *stream.last_mut().unwrap() = 0x12;
    let turned = decode(&stream, &layout(Mode::Attributes, 4, 4)).unwrap();
    assert_eq!(turned[..8], [0xff ^ 4, 0, 9, 0, 0xff ^ 4 ^ 2, 0, 9, 0]);
    *stream.last_mut().unwrap() = 3;
    let error = decode(&stream, &layout(Mode::Attributes, 4, 4)).unwrap_err();
    assert!(error.reason.contains("channel mode 0x03"), "{error}");
}

#[test]
fn indices_follow_either_of_two() {
    let mut stream = vec![0xd1];
    for (base, difference) in [(0, 5i32), (1, 100), (0, -2), (1, 1)] {
        push_varint(&mut stream, zigzag(difference as u32) << 1 | base);
    }
    stream.extend([0; 4]);
    let bytes = decode(&stream, &layout(Mode::Indices, 4, 4)).unwrap();
    assert_eq!(bytes, [5, 0, 0, 0, 100, 0, 0, 0, 3, 0, 0, 0, 101, 0, 0, 0]);
}

#[test]
fn streams_of_other_modes_and_lengths_are_refused() {
    let triangles = encode_triangles(&[[0, 1, 2], [2, 1, 3]]);
    let attributes = encode_attributes(&[7; 80], 4);
    for (stream, mode, count) in
        [(&triangles, Mode::Triangles, 6), (&attributes, Mode::Attributes, 20)]
    {
        decode(stream, &layout(mode, count, 4)).unwrap();
        for other in [Mode::Attributes, Mode::Triangles, Mode::Indices] {
            assert_eq!(decode(stream, &layout(other, count, 4)).is_ok(), other == mode);
        }
        for end in 0..stream.len() {
            // The length is what finds the tail, so no cut may pass but one that shows.
            assert!(decode(&stream[..end], &layout(mode, count, 4)).is_err(), "{mode:?} {end}");
        }
        decode(stream, &layout(mode, 3 << 40, 4)).unwrap_err();
        decode(stream, &layout(mode, usize::MAX / 3 * 3, 4)).unwrap_err();
    }
}

#[test]
fn layouts_keep_the_rules() {
    for (mode, filter, count, stride) in [
        (Mode::Attributes, Filter::None, 1, 0),
        (Mode::Attributes, Filter::None, 1, 6),
        (Mode::Attributes, Filter::None, 1, 260),
        (Mode::Attributes, Filter::Quaternion, 1, 4),
        (Mode::Attributes, Filter::Octahedral, 1, 12),
        (Mode::Triangles, Filter::None, 4, 4),
        (Mode::Triangles, Filter::None, 3, 1),
        (Mode::Indices, Filter::Exponential, 3, 4),
    ] {
        let layout = Layout { mode, filter, count, stride };
        assert!(layout.check().is_err() && decode(&[], &layout).is_err(), "{layout:?}");
    }
}

#[test]
fn directions_come_back_within_their_bits() {
    let mut worst = [0.0f64; 2];
    for (i, bits) in [8, 12].into_iter().enumerate() {
        for k in 0..5000 {
            let (t, z) = (f64::from(k) * 2.4, 1.0 - f64::from(k) / 2499.5);
            let r = (1.0 - z * z).max(0.0).sqrt();
            let direction = [r * t.cos(), r * t.sin(), z];
            let [x, y, z] = direction.map(|c| c as f32);
            let mut bytes = encode_octahedral(&[[x, y, z, -1.0]], bits);
            filters::apply(Filter::Octahedral, bytes.len(), &mut bytes);
            let found: Vec<f64> = match bits {
                8 => bytes.iter().map(|&b| f64::from(b as i8) / 127.0).collect(),
                _ => (bytes.as_chunks().0.iter())
                    .map(|&b| f64::from(i16::from_le_bytes(b)) / 32767.0)
                    .collect(),
            };
            assert_eq!(found[3], -1.0);
            let off = (0..3).map(|a| (found[a] - direction[a]).powi(2)).sum::<f64>().sqrt();
            worst[i] = worst[i].max(off);
        }
    }
    assert!(worst[0] < 0.02 && worst[1] < 0.001, "{worst:?}");
    assert_eq!(encode_octahedral(&[[0.0, f32::NAN, 0.0, 0.0]], 8), [0, 0, 127, 0]);
}

#[test]
fn floats_come_back_as_multiples_of_the_step() {
    let floats = [0.0, 1.0, -3.3, 1000.1, 1e-9];
    let mut bytes = encode_exponential(&floats, 0.01).unwrap();
    filters::apply(Filter::Exponential, 4, &mut bytes);
    for (&bytes, float) in bytes.as_chunks().0.iter().zip(floats) {
        let found = f32::from_le_bytes(bytes);
        assert_eq!(found * 128.0, (found * 128.0).round());
        assert!((found - float).abs() <= 0.5 / 128.0, "{found} for {float}");
    }
    assert_eq!(encode_exponential(&[1.0, f32::NAN], 0.1), None);
    assert_eq!(encode_exponential(&[1.0], 0.0), None);
    let large = encode_exponential(&[1e6, 1.0], 1e-9).unwrap();
    assert_eq!(large[3], -3i8 as u8, "as fine as 24 bits allow");
}

#[test]
fn varints_and_differences_are_those_of_the_specification() {
    for (bytes, value) in [(&[0x7f][..], 0x7f), (&[0x81, 0x04], 0x201)] {
        let padded = [&[0], bytes].concat();
        let (_, mut stream, _) = Stream::split(&padded, 0).unwrap();
        assert_eq!(stream.varint(), Ok(value));
        let mut again = Vec::new();
        push_varint(&mut again, value);
        assert_eq!(again, bytes);
    }
    let (_, mut endless, _) = Stream::split(&[0xff; 9], 0).unwrap();
    assert!(endless.varint().is_err());
    assert_eq!([0, 1, 2, 3].map(|v| unzigzag(v) as i32), [0, -1, 1, -2]);
}

/// Each triangle turned so that its least index, or the first of equal ones, comes first.
fn turned_to_least(triangle: &[u32; 3]) -> [u32; 3] {
    let [a, b, c] = *triangle;
    [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().unwrap()
}

proptest! {
    #[test]
    fn attributes_come_back(words in prop::collection::vec(any::<[u8; 4]>(), 0..1400),
                            quiet in 0u8..9, stride in 1usize..65) {
        let bytes: Vec<u8> = words.iter().flatten().map(|b| b.unbounded_shr(quiet.into())).collect();
        let stride = 4 * stride;
        let whole = bytes.len() / stride * stride;
        let stream = encode_attributes(&bytes, stride);
        let layout = layout(Mode::Attributes, whole / stride, stride);
        prop_assert_eq!(decode(&stream, &layout).unwrap(), &bytes[..whole]);
    }

    #[test]
    fn triangles_come_back(triangles in prop::collection::vec([0u32..40, 0..40, 0..40], 0..300),
                           far in 0u32..3) {
        let triangles: Vec<[u32; 3]> =
            triangles.iter().map(|t| t.map(|i| if i == 7 { i << (10 * far) } else { i })).collect();
        let stream = encode_triangles(&triangles);
        let bytes = decode(&stream, &layout(Mode::Triangles, 3 * triangles.len(), 4)).unwrap();
        let indices: Vec<u32> = bytes.as_chunks().0.iter().map(|&b| u32::from_le_bytes(b)).collect();
        let found: Vec<[u32; 3]> = indices.as_chunks().0.iter().map(turned_to_least).collect();
        prop_assert_eq!(found, triangles.iter().map(turned_to_least).collect::<Vec<_>>());
    }

    #[test]
    fn any_bytes_are_decoded_or_refused(mut stream in prop::collection::vec(any::<u8>(), 0..400),
                                        header in 0usize..6, count in 0usize..700,
                                        stride in 0usize..70, filter in 0usize..5) {
        if let (Some(first), Some(&known)) = (stream.first_mut(), [0xa0, 0xa1, 0xe1, 0xd1].get(header)) {
            *first = known;
        }
        let filters =
            [Filter::None, Filter::Octahedral, Filter::Quaternion, Filter::Exponential, Filter::Color];
        for mode in [Mode::Attributes, Mode::Triangles, Mode::Indices] {
            let stride = if mode == Mode::Attributes { 4 * stride } else { stride };
            let layout = Layout { mode, filter: filters[filter], count, stride };
            if let Ok(bytes) = decode(&stream, &layout) {
                prop_assert_eq!(bytes.len(), count * stride);
            }
        }
    }

    #[test]
    fn changed_streams_are_decoded_or_refused(at in any::<prop::sample::Index>(), byte in any::<u8>()) {
        let triangles: Vec<[u32; 3]> = (0..60).map(|i| [i, i + 1, i * 7 % 50]).collect();
        let mut stream = encode_triangles(&triangles);
        let at = at.index(stream.len());
        stream[at] = byte;
        let _ = decode(&stream, &layout(Mode::Triangles, 180, 2));
    }
}
