//! Correspondence between the ids of a flattened scene and its nodes and meshes.

use meshlod::Scene;
use meshlod::mesh::{FaceId, VertexId};
use serde::Serialize;

/// The meshes that the nodes of a scene place, in the order of [`Scene::flatten`].
pub struct Sites(Vec<Site>);

/// Mesh placed by a node.
#[derive(Serialize)]
pub struct Site {
    node: usize,
    mesh: usize,
    /// Name of the node, else of the mesh, else the node's number.
    name: String,
    first_vertex: usize,
    vertices: usize,
    first_face: usize,
    faces: usize,
}

impl Sites {
    pub fn of(scene: &Scene) -> Self {
        let (mut first_vertex, mut first_face) = (0, 0);
        let sites = scene.instances().into_iter().map(|placement| {
            let (node, mesh) = (placement.node, placement.mesh);
            let of = &scene.meshes[mesh];
            let named = [&scene.nodes[node].name, &of.name].into_iter().find(|n| !n.is_empty());
            let name = named.cloned().unwrap_or_else(|| format!("node {node}"));
            let (vertices, faces) = (of.mesh.positions.len(), of.mesh.faces.len());
            let site = Site { node, mesh, name, first_vertex, vertices, first_face, faces };
            first_vertex += vertices;
            first_face += faces;
            site
        });
        Self(sites.collect())
    }

    /// Returns whether ids are those of several nodes, which they name.
    pub fn are_several(&self) -> bool {
        self.0.len() > 1
    }

    /// Formats a face id, preceded by its node if the scene has several.
    pub fn face(&self, face: FaceId) -> String {
        let site = self.0.iter().rfind(|site| site.first_face <= face.index());
        match site.filter(|_| self.are_several()) {
            Some(site) => format!("f{} of {}", face.index() - site.first_face, site.name),
            None => face.to_string(),
        }
    }

    /// Formats a vertex id, preceded by its node if the scene has several.
    pub fn vertex(&self, vertex: VertexId) -> String {
        let site = self.0.iter().rfind(|site| site.first_vertex <= vertex.index());
        match site.filter(|_| self.are_several()) {
            Some(site) => format!("v{} of {}", vertex.index() - site.first_vertex, site.name),
            None => vertex.to_string(),
        }
    }

    /// Returns the ranges of ids that belong to each node and mesh; `None` if there is only one.
    pub fn several(&self) -> Option<&[Site]> {
        (self.0.len() != 1).then_some(&self.0)
    }
}
