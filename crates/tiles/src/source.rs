//! Where triangles come from: a scene in memory, or a file that is read in passing.

use std::io;

use meshlod_io::Scene;
use meshlod_mesh::{Bounds, Mesh};

use crate::layout::Layout;

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
    fn bounds(&self) -> io::Result<Bounds>;

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

/// Scene in memory.
#[derive(Debug)]
pub struct SceneSource {
    mesh: Mesh,
    layout: Layout,
}

impl SceneSource {
    /// Takes all that a scene shows, in world space.
    pub fn new(scene: Scene) -> Self {
        let mesh = scene.into_mesh();
        let layout = Layout::of(mesh.attributes.iter().flat_map(|attributes| &attributes.layers));
        Self { mesh, layout }
    }
}

impl Source for SceneSource {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn bounds(&self) -> io::Result<Bounds> {
        Ok(self.mesh.bounds())
    }

    fn triangles(&self, take: &mut dyn FnMut(&Triangles) -> io::Result<()>) -> io::Result<()> {
        let mut some = Triangles::default();
        let layers: Vec<_> = self
            .mesh
            .attributes
            .iter()
            .flat_map(|attributes| &attributes.layers)
            .filter(|layer| Layout::keeps(layer))
            .collect();
        for face in 0..self.mesh.faces.len() {
            let places = self.mesh.faces[face].map(|v| self.mesh.positions[v.index()]);
            some.places.push(places);
            if !layers.is_empty() {
                for wedge in self.mesh.corner_wedges(face) {
                    layers.iter().for_each(|layer| some.values.extend(layer.of(wedge)));
                }
            }
            let material = self.mesh.materials.as_ref().map_or(0, |labels| labels.of(face));
            some.materials.push(material as u16);
            if some.places.len() == MOST_TRIANGLES {
                take(&some)?;
                some.places.clear();
                some.values.clear();
                some.materials.clear();
            }
        }
        if some.places.is_empty() { Ok(()) } else { take(&some) }
    }
}
