//! Codecs of the glTF extensions `EXT_meshopt_compression` and `KHR_meshopt_compression`, written
//! from their specifications.
//!
//! A stream holds `count` elements of `stride` bytes. Count, stride, mode and filter are not part
//! of it but given separately, as a [`Layout`]. [`decode`] accepts arbitrary bytes: errors come
//! with their offset, and no more memory is allocated than the decoded elements need.
//!
//! ```
//! use meshlod_io::meshopt::{Filter, Layout, Mode, decode, encode_attributes, encode_triangles};
//!
//! let bytes: Vec<u8> = (0..=255).collect();
//! let layout = Layout { mode: Mode::Attributes, filter: Filter::None, count: 64, stride: 4 };
//! assert_eq!(decode(&encode_attributes(&bytes, 4), &layout)?, bytes);
//!
//! let stream = encode_triangles(&[[0, 1, 2], [2, 1, 3]]);
//! let layout = Layout { mode: Mode::Triangles, filter: Filter::None, count: 6, stride: 2 };
//! assert_eq!(decode(&stream, &layout)?, [0, 0, 1, 0, 2, 0, 2, 0, 1, 0, 3, 0]);
//! # Ok::<(), meshlod_io::meshopt::Malformed>(())
//! ```
//!
//! # References
//! [KS21] and [KSL25], appendices A and B.

mod attributes;
mod filters;
mod indices;
mod stream;
mod triangles;

pub use attributes::encode as encode_attributes;
pub(crate) use filters::apply as apply_filter;
pub use filters::{encode_exponential, encode_octahedral, encode_quaternion};
pub use stream::Malformed;
pub use triangles::encode as encode_triangles;

/// Meshopt compression mode: the type of data in a compressed stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Vertex attributes or other elements of any type, as bytewise differences; versions 0 and 1.
    Attributes,
    /// Vertex indices of a triangle list.
    Triangles,
    /// Any other sequence of indices.
    Indices,
}

/// Transform applied to the elements of a [`Mode::Attributes`] stream after decoding.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// Elements are left as decoded.
    #[default]
    None,
    /// Unit vectors stored in octahedral encoding.
    Octahedral,
    /// Unit quaternions stored as their three smaller components.
    Quaternion,
    /// Floats stored as 24-bit mantissas and 8-bit exponents.
    Exponential,
    /// Colours stored as YCoCg; only in `KHR_meshopt_compression`.
    Color,
}

/// Type, number and size of the elements in a meshopt stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Compression mode of the stream.
    pub mode: Mode,
    /// Filter applied to the elements after decoding.
    pub filter: Filter,
    /// Number of elements in the stream.
    pub count: usize,
    /// Size of a decoded element, in bytes.
    pub stride: usize,
}

impl Layout {
    /// Checks that compression mode, filter, element count and stride are compatible.
    ///
    /// # Errors
    /// The rule of the specification that is violated.
    pub fn check(&self) -> Result<(), String> {
        let Self { mode, filter, count, stride } = *self;
        match mode {
            Mode::Attributes if stride == 0 || stride > 256 || stride % 4 != 0 => {
                return Err(format!(
                    "the stride of attributes must be a multiple of 4 up to 256, not {stride}"
                ));
            }
            Mode::Triangles | Mode::Indices if !matches!(stride, 2 | 4) => {
                return Err(format!("the stride of indices must be 2 or 4, not {stride}"));
            }
            Mode::Triangles if count % 3 != 0 => {
                return Err(format!("the number of indices must be a multiple of 3, not {count}"));
            }
            Mode::Triangles | Mode::Indices if filter != Filter::None => {
                return Err("indices cannot have a filter".to_owned());
            }
            _ => {}
        }
        let fits = match filter {
            Filter::None | Filter::Exponential => true,
            Filter::Octahedral | Filter::Color => matches!(stride, 4 | 8),
            Filter::Quaternion => stride == 8,
        };
        if fits {
            Ok(())
        } else {
            Err(format!("filter {filter:?} does not support a stride of {stride}"))
        }
    }
}

/// Decompresses a meshopt stream to the contiguous little-endian elements that `layout` describes.
///
/// Cost: O(bytes out).
/// # Errors
/// If the layout is invalid, or the stream has an unknown version, is too short or too long, or is
/// nothing an encoder produces. Where the specification leaves a filter's result undefined, it is
/// arbitrary.
pub fn decode(stream: &[u8], layout: &Layout) -> Result<Vec<u8>, Malformed> {
    layout.check().map_err(|reason| Malformed { at: 0, reason })?;
    let Layout { mode, filter, count, stride } = *layout;
    match mode {
        Mode::Attributes => {
            let mut bytes = attributes::decode(stream, count, stride)?;
            filters::apply(filter, stride, &mut bytes);
            Ok(bytes)
        }
        Mode::Triangles => Ok(to_bytes(triangles::decode(stream, count / 3)?, stride)),
        Mode::Indices => Ok(to_bytes(indices::decode(stream, count)?, stride)),
    }
}

/// Stores indices in 2 or 4 bytes each; with 2, the specification lets them wrap around.
fn to_bytes(indices: Vec<u32>, stride: usize) -> Vec<u8> {
    let all = indices.iter();
    match stride {
        2 => all.flat_map(|&index| (index as u16).to_le_bytes()).collect(),
        _ => all.flat_map(|index| index.to_le_bytes()).collect(),
    }
}

#[cfg(test)]
mod tests;
