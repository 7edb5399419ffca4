//! Triangles of a scene in memory.

use std::io;

use meshlod_io::Scene;
use meshlod_mesh::{Bounds, Mesh};

use super::{MOST_TRIANGLES, Source, Triangles};
use crate::layout::Layout;

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
