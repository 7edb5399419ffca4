//! Number types of PLY.

/// Scalar type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Scalar {
    /// Name of the type in a header, in the original spelling.
    pub fn name(self) -> &'static str {
        match self {
            Self::I8 => "char",
            Self::U8 => "uchar",
            Self::I16 => "short",
            Self::U16 => "ushort",
            Self::I32 => "int",
            Self::U32 => "uint",
            // No original spelling: numpy's names, which trimesh writes.
            Self::I64 => "int64",
            Self::U64 => "uint64",
            Self::F32 => "float",
            Self::F64 => "double",
        }
    }

    /// Appends a value in little-endian order, rounded and clamped to the range of the type.
    pub fn append(self, value: f64, block: &mut Vec<u8>) {
        let whole = value.round();
        match self {
            Self::I8 => block.extend_from_slice(&(whole as i8).to_le_bytes()),
            Self::U8 => block.push(whole as u8),
            Self::I16 => block.extend_from_slice(&(whole as i16).to_le_bytes()),
            Self::U16 => block.extend_from_slice(&(whole as u16).to_le_bytes()),
            Self::I32 => block.extend_from_slice(&(whole as i32).to_le_bytes()),
            Self::U32 => block.extend_from_slice(&(whole as u32).to_le_bytes()),
            Self::I64 => block.extend_from_slice(&(whole as i64).to_le_bytes()),
            Self::U64 => block.extend_from_slice(&(whole as u64).to_le_bytes()),
            Self::F32 => block.extend_from_slice(&(value as f32).to_le_bytes()),
            Self::F64 => block.extend_from_slice(&value.to_le_bytes()),
        }
    }

    /// Reports whether a value of this type may be exactly `value`.
    pub fn holds(self, value: f64) -> bool {
        match self.whole_range() {
            Some((least, most)) => {
                value.fract() == 0.0 && (least as f64..=most as f64).contains(&value)
            }
            None => self == Self::F64 || f64::from(value as f32) == value,
        }
    }

    /// Reports whether a number read as `value` may have been rounded: 64-bit integers from 2^53
    /// are.
    pub fn may_round(self, value: f64) -> bool {
        matches!(self, Self::I64 | Self::U64) && value.abs() >= 9_007_199_254_740_992.0
    }

    /// Returns the value that some bytes begin with; 64-bit integers from 2^53 are rounded, all
    /// others exact.
    #[inline]
    pub fn number(self, bytes: &[u8], is_big: bool) -> f64 {
        let mut number = 0.0;
        self.column(is_big, [bytes].into_iter(), |_, value| number = value);
        number
    }

    /// Returns the index that some bytes begin with; `None` for a negative number or a fraction.
    #[inline]
    pub fn index(self, bytes: &[u8], is_big: bool) -> Option<u64> {
        match self {
            Self::U8 => Some(bytes[0].into()),
            Self::U32 => Some(u32::from_le_bytes(little(bytes, is_big)).into()),
            Self::I32 => i32::from_le_bytes(little(bytes, is_big)).try_into().ok(),
            Self::U64 => Some(u64::from_le_bytes(little(bytes, is_big))),
            Self::I64 => i64::from_le_bytes(little(bytes, is_big)).try_into().ok(),
            _ => {
                let number = self.number(bytes, is_big);
                (number >= 0.0 && number.fract() == 0.0).then_some(number as u64)
            }
        }
    }

    /// Hands on the values that some rows begin with, with the number of the row, like
    /// [`Scalar::number`].
    #[inline]
    pub fn column<'a>(
        self,
        is_big: bool,
        rows: impl Iterator<Item = &'a [u8]>,
        put: impl FnMut(usize, f64),
    ) {
        match self {
            Self::I8 => each(is_big, rows, |raw| i8::from_le_bytes(raw).into(), put),
            Self::U8 => each(is_big, rows, |raw| u8::from_le_bytes(raw).into(), put),
            Self::I16 => each(is_big, rows, |raw| i16::from_le_bytes(raw).into(), put),
            Self::U16 => each(is_big, rows, |raw| u16::from_le_bytes(raw).into(), put),
            Self::I32 => each(is_big, rows, |raw| i32::from_le_bytes(raw).into(), put),
            Self::U32 => each(is_big, rows, |raw| u32::from_le_bytes(raw).into(), put),
            Self::I64 => each(is_big, rows, |raw| i64::from_le_bytes(raw) as f64, put),
            Self::U64 => each(is_big, rows, |raw| u64::from_le_bytes(raw) as f64, put),
            Self::F32 => each(is_big, rows, |raw| f32::from_le_bytes(raw).into(), put),
            Self::F64 => each(is_big, rows, f64::from_le_bytes, put),
        }
    }

    /// Returns the size of a value of this type in binary PLY, in bytes.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// Returns the minimum and maximum of an integer type; `None` for the floating-point types.
    pub fn whole_range(self) -> Option<(i128, i128)> {
        Some(match self {
            Self::I8 => (i8::MIN.into(), i8::MAX.into()),
            Self::U8 => (0, u8::MAX.into()),
            Self::I16 => (i16::MIN.into(), i16::MAX.into()),
            Self::U16 => (0, u16::MAX.into()),
            Self::I32 => (i32::MIN.into(), i32::MAX.into()),
            Self::U32 => (0, u32::MAX.into()),
            Self::I64 => (i64::MIN.into(), i64::MAX.into()),
            Self::U64 => (0, u64::MAX.into()),
            Self::F32 | Self::F64 => return None,
        })
    }
}

/// Hands on the number that each row begins with, by the type of its bytes.
#[inline]
fn each<'a, const N: usize>(
    is_big: bool,
    rows: impl Iterator<Item = &'a [u8]>,
    value: impl Fn([u8; N]) -> f64,
    mut put: impl FnMut(usize, f64),
) {
    for (row, bytes) in rows.enumerate() {
        put(row, value(little(bytes, is_big)));
    }
}

/// Returns the first bytes of a row in little-endian order.
#[inline]
fn little<const N: usize>(bytes: &[u8], is_big: bool) -> [u8; N] {
    let mut raw = *bytes.first_chunk().expect("a row holds the number");
    if is_big {
        raw.reverse();
    }
    raw
}
