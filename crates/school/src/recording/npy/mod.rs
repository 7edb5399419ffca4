//! Arrays in NumPy's `.npy` format, version 1.0: little endian, C order, of three types.

mod header;

use thiserror::Error;

use header::Header;

/// Array of any number of dimensions; the last varies fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Array<T> {
    /// Length along each axis.
    pub shape: Vec<usize>,
    /// Values, as many as the product of the lengths.
    pub values: Vec<T>,
}

/// Reason why an array cannot be read.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum NpyError {
    /// The file lacks the first bytes of a `.npy` file.
    #[error("not a .npy file")]
    NotNpy,
    /// The file has another version of the format.
    #[error("version {0}.{1} of the .npy format; only 1.0 is read")]
    Version(u8, u8),
    /// The file ends within its header.
    #[error("the file ends within its header")]
    Cut,
    /// The header breaks the format.
    #[error("header: {0}")]
    Header(&'static str),
    /// The values are of another type.
    #[error("the values are of type {found:?}, not {expected:?}")]
    Type {
        /// Type in the file.
        found: String,
        /// Type that is read.
        expected: &'static str,
    },
    /// The values are in Fortran order.
    #[error("the values are in Fortran order; only C order is read")]
    Fortran,
    /// The file does not hold as many values as its header says.
    #[error("the header announces {announced} bytes of values, but {found} follow")]
    Length {
        /// Bytes that the header announces; `too many` if no file can hold them.
        announced: String,
        /// Bytes after the header.
        found: usize,
    },
}

/// Type of the values of an array.
pub trait Element: Copy {
    /// Name of the type in the header.
    const NAME: &'static str;
    /// Number of bytes of a value.
    const SIZE: usize;
    /// Appends the value, little endian.
    fn put(self, bytes: &mut Vec<u8>);
    /// Returns the value of [`Element::SIZE`] bytes.
    fn get(bytes: &[u8]) -> Self;
}

macro_rules! element {
    ($type:ty, $name:literal) => {
        impl Element for $type {
            const NAME: &'static str = $name;
            const SIZE: usize = size_of::<$type>();

            fn put(self, bytes: &mut Vec<u8>) {
                bytes.extend(self.to_le_bytes());
            }

            fn get(bytes: &[u8]) -> Self {
                let mut value = [0; size_of::<$type>()];
                value.copy_from_slice(bytes);
                Self::from_le_bytes(value)
            }
        }
    };
}

element!(f32, "<f4");
element!(u16, "<u2");
element!(u32, "<u4");

/// Returns the bytes of an array.
///
/// # Panics
/// If the number of values is not the product of the lengths.
pub fn write<T: Element>(shape: &[usize], values: impl ExactSizeIterator<Item = T>) -> Vec<u8> {
    assert_eq!(values.len(), shape.iter().product::<usize>(), "values of shape {shape:?}");
    let mut bytes = Header::bytes(T::NAME, shape);
    bytes.reserve_exact(values.len() * T::SIZE);
    values.for_each(|value| value.put(&mut bytes));
    bytes
}

/// Reads an array of a known type.
///
/// # Errors
/// A file that is cut, of another type, order or version, or whose header announces another number
/// of values than follow. No allocation exceeds the bytes given.
pub fn read<T: Element>(bytes: &[u8]) -> Result<Array<T>, NpyError> {
    let (header, values) = Header::read(bytes)?;
    if header.descr != T::NAME {
        return Err(NpyError::Type { found: header.descr, expected: T::NAME });
    }
    if header.fortran_order {
        return Err(NpyError::Fortran);
    }
    let count = header.shape.iter().try_fold(T::SIZE, |bytes, &side| bytes.checked_mul(side));
    if count != Some(values.len()) {
        let announced = count.map_or("too many".into(), |count| count.to_string());
        return Err(NpyError::Length { announced, found: values.len() });
    }
    let values = values.chunks_exact(T::SIZE).map(T::get).collect();
    Ok(Array { shape: header.shape, values })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn the_bytes_are_those_of_numpy() {
        let bytes = write(&[2, 3], [1.0f32, 2.0, 3.0, 4.0, 5.0, 6.0].into_iter());
        let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }";
        assert_eq!(&bytes[..10], b"\x93NUMPY\x01\x00\x76\x00");
        assert_eq!(&bytes[10..10 + header.len()], header.as_bytes());
        assert_eq!((bytes.len(), bytes[127]), (128 + 24, b'\n'));
        assert!(String::from_utf8_lossy(&write(&[3], [0u16; 3].into_iter())).contains("(3,)"));
        assert!(String::from_utf8_lossy(&write(&[], [7u32].into_iter())).contains("()"));
    }

    #[test]
    fn arrays_come_back_as_they_were() {
        let values = [1.5f32, -0.0, f32::MIN_POSITIVE, f32::MAX, 0.1, 7.0];
        let read_back = read::<f32>(&write(&[3, 1, 2], values.into_iter())).unwrap();
        assert_eq!((read_back.shape, &read_back.values[..]), (vec![3, 1, 2], &values[..]));
        let none = read::<u32>(&write(&[0, 5], [0u32; 0].into_iter())).unwrap();
        assert_eq!((none.shape, none.values.len()), (vec![0, 5], 0));
        let one = read::<u16>(&write(&[], [9u16].into_iter())).unwrap();
        assert_eq!((one.shape.len(), one.values), (0, vec![9]));
    }

    #[test]
    fn headers_that_lie_are_found_out() {
        let good = write(&[2, 3], [1u16; 6].into_iter());
        assert_eq!(read::<u16>(b"PNG"), Err(NpyError::NotNpy));
        assert_eq!(read::<u16>(&good[..40]), Err(NpyError::Cut));
        let mut later = good.clone();
        later[6] = 3;
        assert_eq!(read::<u16>(&later), Err(NpyError::Version(3, 0)));
        assert!(matches!(read::<f32>(&good), Err(NpyError::Type { .. })));
        assert!(matches!(read::<u16>(&good[..good.len() - 1]), Err(NpyError::Length { .. })));
        let more = [&good[..], &[0]].concat();
        assert!(matches!(read::<u16>(&more), Err(NpyError::Length { .. })));
        let with = |text: &str| {
            let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
            bytes.extend((text.len() as u16).to_le_bytes());
            [&bytes[..], text.as_bytes(), &[0; 12]].concat()
        };
        let fortran = with("{'descr': '<u2', 'fortran_order': True, 'shape': (2, 3)}\n");
        assert_eq!(read::<u16>(&fortran), Err(NpyError::Fortran));
        let huge = "{'descr': '<u2', 'fortran_order': False, 'shape': (99999999999, 99999999999)}";
        assert!(matches!(read::<u16>(&with(huge)), Err(NpyError::Length { .. })));
        let spaced = with("{ 'shape':(6 ,) ,'fortran_order':False,\"descr\":\"<u2\"}   \n");
        assert_eq!(read::<u16>(&spaced).unwrap().shape, [6]);
        for bad in [
            "",
            "{",
            "{}",
            "{'descr': '<u2'}",
            "{'descr': '<u2', 'fortran_order': False, 'shape': 6}",
            "{'descr': '<u2', 'fortran_order': False, 'shape': (-6,)}",
            "{'descr': '<u2', 'fortran_order': False, 'shape': (6,)} x",
            "{'descr': '<u2', 'fortran_order': False, 'shape': (6,), 'more': 1}",
            "{'descr': [('a', '<u2')], 'fortran_order': False, 'shape': (6,)}",
            "{'descr': '<u2', 'descr': '<u2', 'fortran_order': False, 'shape': (6,)}",
            "{'descr': '<u2', 'fortran_order': False, 'shape': (184467440737095516160,)}",
        ] {
            assert!(matches!(read::<u16>(&with(bad)), Err(NpyError::Header(_))), "{bad}");
        }
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(
            mut bytes in Just(write(&[2, 3], [1.0f32; 6].into_iter())),
            changes in prop::collection::vec((0usize..152, any::<u8>()), 1..8),
            end in 0usize..=152,
        ) {
            for (at, byte) in changes {
                bytes[at] = byte;
            }
            bytes.truncate(end);
            if let Ok(array) = read::<f32>(&bytes) {
                prop_assert_eq!(array.values.len(), array.shape.iter().product::<usize>());
            }
        }
    }
}
