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
