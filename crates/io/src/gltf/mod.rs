//! glTF 2.0 and GLB. Parts of a document other than geometry are passed through unchanged.
//!
//! | room | holds |
//! |---|---|
//! | `document` | the file: container, JSON, buffers, accessors, and the [`SourceDocument`] of a scene |
//! | `read` | scenes from documents |
//! | `stream` | triangles of documents that are larger than memory |
//! | `draco` | decompression of primitives, before they are read |
//! | `write` | documents from scenes: new geometry, levels, strips, compression |
//! | `animation` | poses of nodes, and packing of key frames |
//! | `skeleton` | scenes without geometry, as bytes |
//!
//! `read` and `write` use `document`; `write` also uses `read`, to find the meshes that changed.

mod animation;
pub(crate) mod document;
mod draco;
mod read;
mod skeleton;
mod stream;
#[cfg(test)]
mod tests;
pub(crate) mod write;

pub use animation::{Animator, Moment, Pose, Skin};
pub use document::facts::{AnimationFacts, FileFacts};
pub use document::schema::parse_target_name;
pub use document::source::SourceDocument;
pub use document::stored::{ScratchFile, Store, StoreFiles};
pub use read::primitive_rows::PrimitiveRows;
pub use read::read;
pub use skeleton::Skeleton;
pub use skeleton::images::SkeletonImage;
pub(crate) use stream::StreamHead;
pub use stream::{GltfRun, GltfStream};
pub use write::levels::{ImageSizes, Level, LodLayout, NeedleLevels, SizedImage};
pub use write::output::GltfFiles;
pub use write::parts::{QuantizedPart, write_parts_glb};
pub use write::settings::{Bytes, Compression, CompressionReport, PositionGrid};
pub use write::strip_mesh::{StripCorner, StripMesh};
pub use write::strips::{write_strips, write_strips_glb};
pub use write::{write, write_compressed, write_compressed_glb, write_glb, write_lods_glb};
