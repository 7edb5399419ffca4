//! Zigzag coding of signed integers: 0, -1, 1, -2… become 0, 1, 2, 3…

/// Encodes a signed integer. Values that fit in 32 bits signed fit in 32 bits unsigned.
pub(crate) fn zigzag(x: i64) -> u64 {
    ((x << 1) ^ (x >> 63)) as u64
}

/// Decodes a signed integer.
pub(crate) fn unzigzag(x: u64) -> i64 {
    (x >> 1) as i64 ^ -((x & 1) as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_come_back() {
        assert_eq!([0, -1, 1, -2].map(zigzag), [0, 1, 2, 3]);
        for x in [0, 5, -5, i32::MAX.into(), i32::MIN.into(), i64::MAX, i64::MIN] {
            assert_eq!(unzigzag(zigzag(x)), x);
            assert_eq!(u32::try_from(zigzag(x)).is_ok(), i32::try_from(x).is_ok(), "{x}");
        }
    }
}
