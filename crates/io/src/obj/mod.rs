//! Wavefront OBJ files with their material libraries.
//!
//! Topology comes from the `v` index of each corner, so a texture seam does not split the surface;
//! the `vt` and `vn` values there become wedges. `o` and `g` become objects, `usemtl` materials.

mod bare_faces;
mod colored_vertices;
mod labels;
pub(crate) mod mtl;
mod outlines;
mod polypaint;
mod read;
mod skipped;
mod smoothing;
mod stream;
#[cfg(test)]
mod tests;
mod value_numbers;
mod wedges;
mod write;

pub(crate) use colored_vertices::color_splits;
pub(crate) use mtl::one_line;
pub use mtl::write as write_mtl;
pub use outlines::OutlineRow;
pub use read::read;
pub use stream::{ObjEnd, ObjPart, ObjStream};
pub use write::write;
