//! glTF 2.0 and GLB. Parts of a document other than geometry are passed through unchanged.

mod accessor;
mod accessor_use;
mod animation;
mod buffer_builder;
mod compress;
mod container;
mod decompress;
mod dequantize_nodes;
mod dequantize_skins;
mod document;
mod draco;
#[cfg(feature = "draco")]
mod draco_header;
#[cfg(feature = "draco")]
mod draco_stream;
#[cfg(feature = "draco")]
mod draco_unpack;
mod encode;
mod extents;
mod facts;
mod instancing;
mod limits;
mod local_space;
mod lod;
mod materials;
mod mesh;
mod new_document;
mod new_material;
mod nodes;
mod object_nodes;
mod parts;
mod primitive_rows;
mod primitives;
mod quantize;
mod read;
mod schema;
mod skeleton;
mod skeleton_images;
mod strips;
#[cfg(test)]
mod tests;
mod unheld;
mod unmapped;
mod uri;
mod vertex_cache;
mod write;

pub use animation::{Animator, Moment, Pose, Skin};
pub use compress::{Bytes, Compression, CompressionReport};
pub use facts::{AnimationFacts, FileFacts};
pub(crate) use limits::new_document_limits;
pub(crate) use local_space::to_local;
pub(crate) use lod::Levels;
pub use lod::{Level, LodLayout};
pub use parts::{QuantizedPart, write_parts_glb};
pub use primitive_rows::PrimitiveRows;
pub use read::{SourceDocument, read};
pub use schema::parse_target_name;
pub use skeleton::Skeleton;
pub use skeleton_images::SkeletonImage;
pub(crate) use strips::strip_files;
pub use strips::{StripCorner, StripMesh, write_strips, write_strips_glb};
pub(crate) use uri::{Uri, of_file as encode_name, parse as parse_uri};
pub(crate) use write::files;
pub use write::{
    GltfFiles, write, write_compressed, write_compressed_glb, write_glb, write_lods_glb,
};
