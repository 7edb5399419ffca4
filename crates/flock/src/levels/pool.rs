//! Vertices that all levels share.

use std::collections::HashMap;

use meshlod_mesh::{Layer, Mesh, VertexId, WedgeId};

/// Vertices as a GPU reads them: a position and the values of all layers.
#[derive(Default)]
pub(crate) struct VertexPool {
    pub positions: Vec<[f64; 3]>,
    pub layers: Vec<Layer>,
    known: HashMap<Vec<u32>, u32>,
}

impl VertexPool {
    /// Adds the vertices of a level that are new, and returns its triangles.
    ///
    /// A vertex is known if its position and all its values are. Levels of half-edge contraction
    /// add next to none to those of the model.
    pub(crate) fn add(&mut self, mesh: &Mesh) -> Vec<[u32; 3]> {
        let attributes = mesh.attributes.as_ref();
        if self.layers.is_empty() {
            let empty = |layer: &Layer| Layer { values: Vec::new(), ..layer.clone() };
            self.layers = attributes.map_or(&[][..], |a| &a.layers).iter().map(empty).collect();
        }
        let corner = |face: usize, at: usize| {
            (mesh.faces[face][at], attributes.map(|attributes| attributes.corners[face][at]))
        };
        let triangle = |face| [0, 1, 2].map(|at| self.vertex(mesh, corner(face, at)));
        (0..mesh.faces.len()).map(triangle).collect()
    }

    fn vertex(&mut self, mesh: &Mesh, (vertex, wedge): (VertexId, Option<WedgeId>)) -> u32 {
        let position = mesh.positions[vertex.index()];
        let layers = || mesh.attributes.iter().flat_map(|attributes| &attributes.layers);
        let values = || wedge.into_iter().flat_map(|w| layers().map(move |layer| layer.of(w)));
        let place = position.iter().flat_map(|x| [x.to_bits() as u32, (x.to_bits() >> 32) as u32]);
        let key: Vec<u32> = place.chain(values().flatten().map(|x| x.to_bits())).collect();
        let next = self.positions.len() as u32;
        let index = *self.known.entry(key).or_insert(next);
        if index == next {
            self.positions.push(position);
            for (layer, values) in self.layers.iter_mut().zip(values()) {
                layer.values.extend_from_slice(values);
            }
        }
        index
    }
}
