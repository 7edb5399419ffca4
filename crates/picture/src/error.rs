//! What can be wrong with a picture, a texture or an order for one.

use meshlod_mesh::MeshError;
use thiserror::Error;

use crate::Picture;

/// Why there is no picture, or no texture.
#[derive(Debug, Error)]
pub enum PictureError {
    /// The mesh breaks a rule of meshes.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// Width or height is zero or too large.
    #[error(
        "a picture of {width} x {height} pixels is not possible; sides go from 1 to {MAX_SIDE}"
    )]
    Size {
        /// The width.
        width: u64,
        /// The height.
        height: u64,
    },
    /// Two pictures that shall be compared have different sizes.
    #[error("{0} x {1} pixels cannot be compared with {2} x {3}", a[0], a[1], b[0], b[1])]
    DifferentSizes {
        /// Width and height of the first.
        a: [u32; 2],
        /// Width and height of the second.
        b: [u32; 2],
    },
    /// A list that goes with another has the wrong length.
    #[error("{what}: {found} entries where {expected} are needed")]
    Length {
        /// Which list.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length it must have.
        expected: usize,
    },
    /// A material names a texture that is not there.
    #[error("material {material} names texture {texture}, but there are only {count}")]
    NoTexture {
        /// The material.
        material: usize,
        /// The texture it names.
        texture: usize,
        /// How many there are.
        count: usize,
    },
    /// An image file is damaged, or of another kind.
    #[error("{kind} image: {reason}")]
    Decode {
        /// Which decoder spoke.
        kind: &'static str,
        /// Its reason.
        reason: String,
    },
    /// The PNG could not be written.
    #[error("png: {0}")]
    Encode(#[from] png::EncodingError),
}

/// The longest side of a picture or a texture, in pixels.
pub const MAX_SIDE: u32 = 16_384;

/// Refuses sides of zero and above [`MAX_SIDE`].
pub(crate) fn check_size(width: u64, height: u64) -> Result<(), PictureError> {
    let sides = 1..=u64::from(MAX_SIDE);
    if sides.contains(&width) && sides.contains(&height) {
        return Ok(());
    }
    Err(PictureError::Size { width, height })
}

/// Refuses pictures of different sizes.
pub(crate) fn check_same_size(a: &Picture, b: &Picture) -> Result<(), PictureError> {
    let [a, b] = [a, b].map(|picture| [picture.width(), picture.height()]);
    if a == b {
        return Ok(());
    }
    Err(PictureError::DifferentSizes { a, b })
}

/// Refuses a list of another length.
pub(crate) fn check_length(
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), PictureError> {
    if found == expected {
        return Ok(());
    }
    Err(PictureError::Length { what, found, expected })
}
