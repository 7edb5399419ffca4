//! Errors in making pictures and textures.

use meshlod_mesh::MeshError;
use thiserror::Error;

use crate::Picture;

/// Reason why a picture or a texture could not be made.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The mesh to be drawn is invalid.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The width or the height of a picture is zero or too large.
    #[error(
        "a picture cannot have {width} x {height} pixels; sides must be between 1 and {MAX_SIDE}"
    )]
    Size {
        /// Requested width in pixels.
        width: u64,
        /// Requested height in pixels.
        height: u64,
    },
    /// Two pictures to be compared have different sizes.
    #[error(
        "cannot compare pictures of different sizes: {0} x {1} and {2} x {3} pixels",
        a[0], a[1], b[0], b[1]
    )]
    DifferentSizes {
        /// Width and height of the first picture, in pixels.
        a: [u32; 2],
        /// Width and height of the second picture, in pixels.
        b: [u32; 2],
    },
    /// A list does not have the length that the mesh or the picture size requires.
    #[error("{what}: expected {expected} entries, found {found}")]
    Length {
        /// Name of what the list contains.
        what: &'static str,
        /// Actual length of the list.
        found: usize,
        /// Length that the list must have.
        expected: usize,
    },
    /// A material refers to a texture that does not exist.
    #[error("material {material} refers to texture {texture}, but there are only {count}")]
    NoTexture {
        /// Index of the material that refers to a missing texture.
        material: usize,
        /// Index of the texture that does not exist.
        texture: usize,
        /// Number of textures that exist.
        count: usize,
    },
    /// The cells of an atlas do not fill its picture.
    #[error(
        "an atlas of {width} x {height} pixels cannot have cells of {cell_px}: their side must be a \
         power of two that divides both"
    )]
    Cell {
        /// Side of a cell in pixels.
        cell_px: u32,
        /// Width of the picture in pixels.
        width: u32,
        /// Height of the picture in pixels.
        height: u32,
    },
    /// A card shows a cell that its atlas does not have.
    #[error("a card shows cell {cell}, but the atlas has only {count}")]
    NoCell {
        /// Cell that does not exist.
        cell: usize,
        /// Number of cells that exist.
        count: usize,
    },
    /// An image file is damaged or not of the expected type.
    #[error("{kind} image: {reason}")]
    Decode {
        /// Image type that was expected, `png` or `jpeg`.
        kind: &'static str,
        /// Reason given by the image decoder.
        reason: String,
    },
    /// The picture could not be written as PNG.
    #[error("png: {0}")]
    Encode(#[from] png::EncodingError),
}

/// Maximum width and height of a picture or a texture, in pixels.
pub const MAX_SIDE: u32 = 16_384;

/// Checks that both sides are between 1 and [`MAX_SIDE`].
pub(crate) fn check_size(width: u64, height: u64) -> Result<(), PictureError> {
    let sides = 1..=u64::from(MAX_SIDE);
    if sides.contains(&width) && sides.contains(&height) {
        return Ok(());
    }
    Err(PictureError::Size { width, height })
}

/// Checks that two pictures have the same size.
pub(crate) fn check_same_size(a: &Picture, b: &Picture) -> Result<(), PictureError> {
    let [a, b] = [a, b].map(|picture| [picture.width(), picture.height()]);
    if a == b {
        return Ok(());
    }
    Err(PictureError::DifferentSizes { a, b })
}

/// Checks the length of a list.
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
