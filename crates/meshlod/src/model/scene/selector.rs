//! Copies of some faces of a mesh.

use meshlod_mesh::{Attributes, Layer, Mesh, VertexId, WedgeId};

/// Copies parts of a mesh, each vertex and wedge once a part.
pub(super) struct Selector<'m> {
    mesh: &'m Mesh,
    vertices: Renumbering,
    wedges: Renumbering,
}

impl<'m> Selector<'m> {
    pub fn new(mesh: &'m Mesh) -> Self {
        let wedges = mesh.attributes.as_ref().map_or(0, |attributes| attributes.wedge_count);
        let [vertices, wedges] = [mesh.positions.len(), wedges].map(Renumbering::new);
        Self { mesh, vertices, wedges }
    }

    /// Returns some faces with their positions.
    pub fn faces(&mut self, faces: &[u32]) -> Mesh {
        self.vertices.begin();
        let corners = faces.iter().map(|&face| {
            self.mesh.faces[face as usize].map(|v| VertexId(self.vertices.number(v.0)))
        });
        let corners = corners.collect();
        let kept = self.vertices.kept.iter();
        Mesh::new(kept.map(|&v| self.mesh.positions[v as usize]).collect(), corners)
    }

    /// Returns some layers of the wedges of some faces, given by index and width; `None` if there
    /// are no such layers.
    pub fn attributes(&mut self, faces: &[u32], layers: &[[u32; 2]]) -> Option<Option<Attributes>> {
        if layers.is_empty() {
            return Some(None);
        }
        let all = self.mesh.attributes.as_ref().filter(|all| layers.len() <= all.layers.len())?;
        self.wedges.begin();
        let corners = faces
            .iter()
            .map(|&face| all.corners[face as usize].map(|w| WedgeId(self.wedges.number(w.0))));
        let corners = corners.collect();
        let layer = |&[index, width]: &[u32; 2]| {
            let layer = all.layers.get(index as usize)?;
            let width = width as usize;
            if width == 0 || width > layer.width || layer.kind.width().is_some_and(|w| w != width) {
                return None;
            }
            let values = self.wedges.kept.iter().flat_map(|&w| &layer.of(WedgeId(w))[..width]);
            let values = values.copied().collect();
            Some(Layer { kind: layer.kind, name: layer.name.clone(), width, values })
        };
        let layers = layers.iter().map(layer).collect::<Option<_>>()?;
        Some(Some(Attributes { corners, wedge_count: self.wedges.kept.len(), layers }))
    }
}

/// New numbers of elements, in the order in which they are first met.
struct Renumbering {
    round: u32,
    /// Round and new number of each element.
    numbers: Vec<(u32, u32)>,
    kept: Vec<u32>,
}

impl Renumbering {
    fn new(count: usize) -> Self {
        Self { round: 0, numbers: vec![(0, 0); count], kept: Vec::new() }
    }

    fn begin(&mut self) {
        self.round += 1;
        self.kept.clear();
    }

    fn number(&mut self, old: u32) -> u32 {
        let (round, number) = &mut self.numbers[old as usize];
        if *round != self.round {
            (*round, *number) = (self.round, self.kept.len() as u32);
            self.kept.push(old);
        }
        *number
    }
}
