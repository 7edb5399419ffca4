//! Decoding a compressed mesh, as a whole or one patch at a time.

use meshlod_mesh::{Attributes, Labels, Mesh, VertexId, WedgeId, merge_equal_wedges};

use super::face_labels::FaceLabels;
use super::{Compressed, WedgeVertices};
use crate::attributes::PackedLayer;
use crate::bytes::Malformed;

impl Compressed {
    /// Decodes the whole mesh, with each vertex once.
    ///
    /// Faces come patch by patch, with the wedges that the input had.
    ///
    /// # Errors
    /// Damaged data that the checksums did not catch.
    pub fn decode(&self) -> Result<Mesh, Malformed> {
        let faces = (0..self.faces.len()).map(|patch| self.faces.of_patch(patch));
        let faces = faces.collect::<Result<Vec<_>, _>>()?.concat();
        let (vertex_of, positions) =
            self.wedge_vertices.all(&faces, &self.positions, self.faces.rows())?;
        let vertex = |node: u32| VertexId(vertex_of[node as usize]);
        let mut mesh = Mesh::new(positions, faces.iter().map(|face| face.map(vertex)).collect());
        if !self.layers.is_empty() {
            mesh.attributes = Some(Attributes {
                corners: faces.iter().map(|face| face.map(WedgeId)).collect(),
                wedge_count: vertex_of.len(),
                layers: self.layers.iter().map(PackedLayer::decode).collect(),
            });
            if let WedgeVertices::Parts(_) = self.wedge_vertices {
                merge_equal_wedges(&mut mesh);
            }
        }
        mesh.materials = self.materials();
        mesh.objects = self.labels[1].as_ref().map(FaceLabels::all);
        Ok(mesh)
    }

    /// Decodes the materials of all faces, in the order of [`Compressed::decode`].
    pub fn materials(&self) -> Option<Labels> {
        self.labels[0].as_ref().map(FaceLabels::all)
    }

    /// Decodes one patch of faces with its vertices and their attributes, and nothing else.
    ///
    /// With [`Scheme::Parts`](super::Scheme::Parts) a vertex appears once for each of its wedges.
    /// # Errors
    /// As [`Compressed::decode`].
    ///
    /// # Panics
    /// If `at` is not less than [`Compressed::patches`].
    pub fn patch(&self, at: usize) -> Result<Mesh, Malformed> {
        let faces = self.faces.of_patch(at)?;
        let mut nodes: Vec<u32> = faces.as_flattened().to_vec();
        nodes.sort_unstable();
        nodes.dedup();
        let rows = self.faces.rows();
        let places: Vec<_> = nodes.iter().map(|&node| rows.place(node)).collect();
        let vertex_of = |(&node, &at)| self.wedge_vertices.of(node, at, rows);
        let vertex_of: Vec<_> = nodes.iter().zip(&places).map(vertex_of).collect();
        let mut vertices = vertex_of.clone();
        vertices.sort_unstable();
        vertices.dedup();
        let number = |list: &[u32], of: u32| list.binary_search(&of).expect("it is in the list");
        let wedges = |face: &[u32; 3]| face.map(|node| WedgeId::new(number(&nodes, node)));
        let corners: Vec<_> = faces.iter().map(wedges).collect();
        let vertex = |wedge: WedgeId| VertexId::new(number(&vertices, vertex_of[wedge.index()]));
        let mut mesh = Mesh::new(
            vertices.iter().map(|&vertex| self.positions.at(vertex as usize)).collect(),
            corners.iter().map(|face| face.map(vertex)).collect(),
        );
        if !self.layers.is_empty() {
            let layers = self.layers.iter().map(|layer| layer.decode_some(&places)).collect();
            mesh.attributes = Some(Attributes { corners, wedge_count: nodes.len(), layers });
        }
        let [materials, objects] = &self.labels;
        mesh.materials = materials.as_ref().map(|labels| labels.of_patch(at));
        mesh.objects = objects.as_ref().map(|labels| labels.of_patch(at));
        Ok(mesh)
    }
}
