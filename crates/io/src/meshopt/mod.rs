//! The codecs of `EXT_meshopt_compression` and `KHR_meshopt_compression`, from their
//! specifications.
//!
//! A stream holds `count` elements of `stride` bytes; how many, how large and by which mode and
//! filter is said beside it, in a [`Layout`]. [`decode`] takes any bytes: what is wrong is told by
//! its place, and no more is allocated than the stream unfolds to.
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
pub use filters::{encode_exponential, encode_octahedral};
pub use stream::Malformed;
pub use triangles::encode as encode_triangles;

/// How elements were made a stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Elements of any kind, as differences byte by byte: versions 0 and 1.
    Attributes,
    /// The indices of a list of triangles.
    Triangles,
    /// Indices of anything else.
    Indices,
}

/// What is done to elements after [`Mode::Attributes`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// Nothing.
    #[default]
    None,
    /// Directions, from two coordinates on an octahedron.
    Octahedral,
    /// Rotations, from the three smaller components.
    Quaternion,
    /// Floats, from mantissas of 24 bits and exponents.
    Exponential,
    /// Colours, from luma and two differences (KHR alone).
    Color,
}

/// What a stream unfolds to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// How its elements are encoded.
    pub mode: Mode,
    /// What is done to them then.
    pub filter: Filter,
    /// How many elements there are.
    pub count: usize,
    /// Bytes an element.
    pub stride: usize,
}

impl Layout {
    /// That mode, filter, count and stride go together.
    ///
    /// # Errors
    /// The rule of the specification that is broken.
    pub fn check(&self) -> Result<(), String> {
        let Self { mode, filter, count, stride } = *self;
        match mode {
            Mode::Attributes if stride == 0 || stride > 256 || stride % 4 != 0 => {
                return Err(format!("attributes of {stride} bytes; 4, 8 … 256 can be"));
            }
            Mode::Triangles | Mode::Indices if !matches!(stride, 2 | 4) => {
                return Err(format!("indices of {stride} bytes; 2 or 4 can be"));
            }
            Mode::Triangles if count % 3 != 0 => {
                return Err(format!("{count} indices are no whole triangles"));
            }
            Mode::Triangles | Mode::Indices if filter != Filter::None => {
                return Err("indices have no filter".to_owned());
            }
            _ => {}
        }
        let fits = match filter {
            Filter::None | Filter::Exponential => true,
            Filter::Octahedral | Filter::Color => matches!(stride, 4 | 8),
            Filter::Quaternion => stride == 8,
        };
        if fits { Ok(()) } else { Err(format!("a filter {filter:?} on {stride} bytes")) }
    }
}

/// Unfolds a stream: `count` elements of `stride` bytes, one after the other, little-endian.
///
/// Cost: O(bytes out).
/// # Errors
/// When the layout breaks a rule, or the stream is of another version, shorter, longer or not
/// what an encoder makes; what the specification leaves undefined in filters gives some value.
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

/// Indices as 2 or 4 bytes each; the specification lets those of 2 wrap around.
fn to_bytes(indices: Vec<u32>, stride: usize) -> Vec<u8> {
    let all = indices.iter();
    match stride {
        2 => all.flat_map(|&index| (index as u16).to_le_bytes()).collect(),
        _ => all.flat_map(|index| index.to_le_bytes()).collect(),
    }
}

#[cfg(test)]
mod tests;
