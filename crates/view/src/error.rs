//! Errors of drawing on a GPU.

use meshlod::picture::PictureError;
use meshlod_school::scene::SceneError;
use thiserror::Error;

use crate::CutError;

/// Reason why something cannot be drawn on the GPU.
#[derive(Debug, Error)]
pub enum ViewError {
    /// There is no GPU, nor a driver that stands in for one.
    #[error(
        "no GPU found: install a Vulkan driver (without a graphics card, a software one: \
         apt-get install mesa-vulkan-drivers)"
    )]
    NoGpu,
    /// The GPU refused to open, or was lost while it worked.
    #[error("the GPU failed: {0}")]
    Failed(String),
    /// There is no screen, or no window can be opened on it.
    #[error("the window cannot be opened: {0}")]
    NoWindow(String),
    /// A picture has no pixels, or more than the GPU can draw.
    #[error("a picture of {} x {} pixels: sides must be between 1 and {limit}", size[0], size[1])]
    Size {
        /// Width and height that were asked for, in pixels.
        size: [u32; 2],
        /// Longest side that the GPU can draw, in pixels.
        limit: u32,
    },
    /// A subject does not have the colours that a script asks for.
    #[error("it has no colours of the kind \"{0}\"")]
    NoColors(&'static str),
    /// The GPU lacks a feature.
    #[error("this GPU cannot {0}")]
    Unsupported(&'static str),
    /// A cut cannot follow its query.
    #[error(transparent)]
    Cut(#[from] CutError),
    /// Something needs a larger buffer or texture than the GPU has.
    #[error("{what} needs {needed} bytes in one buffer, but this GPU allows {limit}")]
    TooLarge {
        /// Name of the data that does not fit.
        what: &'static str,
        /// Size that it would need, in bytes.
        needed: u64,
        /// Limit of the GPU, in bytes.
        limit: u64,
    },
    /// The compressed mesh is damaged, which its checksums did not catch.
    #[error("the compressed mesh is damaged: {0}")]
    Damaged(#[from] meshlod::codec::Malformed),
    /// The mesh, its paint or the size of the picture is invalid.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The scene of a flock cannot be set up or go on.
    #[error(transparent)]
    Scene(#[from] SceneError),
}
