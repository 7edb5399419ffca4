//! What an extraction gives.

use meshlod_mesh::{Mesh, VertexId};

use crate::frame::Frame;

/// A mesh out of a multiresolution model.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    frame: Frame,
    /// What each vertex is in the model: the same vertex of another level has the same number.
    pub nodes: Vec<u32>,
    /// Where each vertex is, in stored units: see [`Level::mesh`] for those of the model.
    pub positions: Vec<[f32; 3]>,
    /// Three vertices each, counter-clockwise seen from outside.
    pub faces: Vec<[u32; 3]>,
}

impl Level {
    pub(crate) fn new(frame: Frame) -> Self {
        Self { frame, nodes: Vec::new(), positions: Vec::new(), faces: Vec::new() }
    }

    /// Forgets the mesh and keeps the room.
    pub(crate) fn clear(&mut self) {
        self.nodes.clear();
        self.positions.clear();
        self.faces.clear();
    }

    /// Of faces by nodes, whose places are in a table.
    pub(crate) fn of_nodes(frame: Frame, places: &[[f32; 3]], mut faces: Vec<[u32; 3]>) -> Self {
        let mut nodes: Vec<u32> = faces.iter().flatten().copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let mut number = vec![0; places.len()];
        nodes.iter().enumerate().for_each(|(i, &node)| number[node as usize] = i as u32);
        faces.iter_mut().flatten().for_each(|node| *node = number[*node as usize]);
        let positions = nodes.iter().map(|&node| places[node as usize]).collect();
        Self { frame, nodes, positions, faces }
    }

    /// In model units.
    pub fn mesh(&self) -> Mesh {
        Mesh::new(
            self.positions.iter().map(|&p| self.frame.model(p)).collect(),
            self.faces.iter().map(|face| face.map(VertexId)).collect(),
        )
    }

    /// The faces by what their vertices are in the model, each from its least, in order: equal for
    /// equal meshes.
    pub fn canonical(&self) -> Vec<[u32; 3]> {
        let mut faces: Vec<_> =
            self.faces.iter().map(|f| f.map(|v| self.nodes[v as usize])).collect();
        for face in &mut faces {
            let least = (0..3).min_by_key(|&k| face[k]).unwrap_or(0);
            face.rotate_left(least);
        }
        faces.sort_unstable();
        faces
    }
}
