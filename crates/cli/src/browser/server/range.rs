//! Ranges of bytes that requests ask for.

use std::ops::Range;

/// Part of a file that is sent.
#[derive(Debug, PartialEq, Eq)]
pub enum SentPart {
    /// All of it: nothing else was asked for, or what we do not understand.
    Whole,
    /// Some of its bytes.
    Some(Range<u64>),
    /// Nothing, since no byte of the file is in the range.
    Nothing,
}

/// Returns the part of a file of some length that the value of a header `Range` asks for.
///
/// Of several ranges the whole file is sent, which is allowed; so it is for an invalid value.
pub fn part(value: Option<&str>, length: u64) -> SentPart {
    let spec = value.and_then(|value| {
        let (unit, spec) = value.split_once('=')?;
        unit.trim().eq_ignore_ascii_case("bytes").then(|| spec.trim())
    });
    let Some((first, last)) = spec.and_then(|spec| spec.split_once('-')) else {
        return SentPart::Whole;
    };
    let number = |text: &str| {
        let is_number = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
        // More digits than fit are beyond any file.
        is_number.then(|| text.parse::<u64>().unwrap_or(u64::MAX))
    };
    match (number(first), number(last)) {
        (Some(first), None) if last.is_empty() => within(first, length, length),
        (Some(first), Some(last)) if first <= last => within(first, last.saturating_add(1), length),
        (None, Some(count)) if first.is_empty() => {
            within(length.saturating_sub(count), length, length)
        }
        _ => SentPart::Whole,
    }
}

/// Returns the part of a file between two places, the second of which may be behind its end.
fn within(start: u64, end: u64, length: u64) -> SentPart {
    if start < length { SentPart::Some(start..end.min(length)) } else { SentPart::Nothing }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_those_of_the_standard() {
        let of = |value| part(Some(value), 100);
        assert_eq!(of("bytes=0-0"), SentPart::Some(0..1));
        assert_eq!(of("bytes=10-"), SentPart::Some(10..100));
        assert_eq!(of("Bytes = 10-1000"), SentPart::Some(10..100));
        assert_eq!(of("bytes=0-99999999999999999999"), SentPart::Some(0..100));
        assert_eq!(of("bytes=-7"), SentPart::Some(93..100));
        assert_eq!(of("bytes=-700"), SentPart::Some(0..100));
        for nothing in ["bytes=100-", "bytes=100-200", "bytes=-0", "bytes=99999999999999999999-"] {
            assert_eq!(of(nothing), SentPart::Nothing, "{nothing}");
        }
        for whole in
            ["bytes=5-2", "bytes=0-1,5-6", "lines=0-1", "bytes=a-b", "bytes=1-x", "bytes", ""]
        {
            assert_eq!(of(whole), SentPart::Whole, "{whole}");
        }
        assert_eq!(part(Some("bytes=-5"), 0), SentPart::Nothing);
        assert_eq!(part(Some("bytes=0-"), 0), SentPart::Nothing);
        assert_eq!(part(None, 5), SentPart::Whole);
    }
}
