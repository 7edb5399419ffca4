//! Errors of drawing on a GPU.

use meshlod::flock::scene::SceneError;
use meshlod::picture::PictureError;
use thiserror::Error;

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
