//! Where triangles come from: a scene in memory, or files that are read in passing.

mod file;
mod gltf;
mod joined;
mod obj;
mod open;
mod pages;
mod ply;
mod polygon;
mod scene;
mod spool;
mod stl;
mod table;

use std::io;

use meshlod_mesh::Bounds;

use crate::layout::Layout;

pub(crate) use file::PlacedFile;
pub use gltf::GltfSource;
pub use joined::JoinedSource;
pub use obj::ObjSource;
pub use open::{LEAST_STREAMED, Streamed, open_stream};
pub use ply::PlySource;
pub use scene::SceneSource;
pub use stl::StlSource;

/// Largest number of triangles that a source hands on at a time.
pub const MOST_TRIANGLES: usize = 1 << 16;

/// Triangles of a model in any order, which can be gone through several times.
pub trait Source {
    /// Returns what the corners have beside their places.
    fn layout(&self) -> &Layout;

    /// Returns the bounding box of all triangles, in model units.
    ///
    /// # Errors
    /// Errors of the file.
    fn bounds(&self) -> io::Result<Bounds> {
        let mut bounds = Bounds::default();
        self.triangles(&mut |some| {
            bounds.merge(&Bounds::of(some.places.as_flattened()));
            Ok(())
        })?;
        Ok(bounds)
    }

    /// Hands on all triangles, at most [`MOST_TRIANGLES`] at a time.
    ///
    /// # Errors
    /// Errors of the file, and of `take`.
    fn triangles(&self, take: &mut dyn FnMut(&Triangles) -> io::Result<()>) -> io::Result<()>;
}

/// Some triangles of a model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Triangles {
    /// Places of the three corners of each, in model units.
    pub places: Vec<[[f64; 3]; 3]>,
    /// Values of the corners, by [`Layout::width`]; three times as many a triangle.
    pub values: Vec<f32>,
    /// Material of each, by index; 0 if there are none.
    pub materials: Vec<u16>,
}

impl Triangles {
    /// Makes room for a number of triangles, whose values are those of others or 0.
    pub(crate) fn resize(&mut self, count: usize, width: usize) {
        self.places.resize(count, [[0.0; 3]; 3]);
        self.values.resize(3 * width * count, 0.0);
        self.materials.resize(count, 0);
    }
}

#[cfg(test)]
pub(crate) mod fixtures;
