//! Wavefront OBJ with its material library.
//!
//! Topology comes from the `v` index of each corner, so a texture seam does not tear the surface:
//! what `vt` and `vn` say there becomes wedges. `o` and `g` become objects, `usemtl` materials.

mod labels;
mod mtl;
mod read;
#[cfg(test)]
mod tests;
mod wedges;
mod write;

pub use mtl::write as write_mtl;
pub use read::read;
pub use write::write;
