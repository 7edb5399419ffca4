//! Where the vertices and faces of a flattened scene come from.

use meshlod::Scene;
use meshlod::mesh::{FaceId, VertexId};
use serde_json::{Value, json};

/// The meshes that a scene shows, in the order in which [`Scene::flatten`] puts them.
pub struct Sites(Vec<Site>);

/// A mesh where a node shows it.
struct Site {
    node: usize,
    mesh: usize,
    /// The node's name, else the mesh's, else its number.
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

    /// A face as people find it: with its node where there are several.
    pub fn face(&self, face: FaceId) -> String {
        let site = self.0.iter().rfind(|site| site.first_face <= face.index());
        match site.filter(|_| self.0.len() > 1) {
            Some(site) => format!("f{} of {}", face.index() - site.first_face, site.name),
            None => face.to_string(),
        }
    }

    /// A vertex likewise.
    pub fn vertex(&self, vertex: VertexId) -> String {
        let site = self.0.iter().rfind(|site| site.first_vertex <= vertex.index());
        match site.filter(|_| self.0.len() > 1) {
            Some(site) => format!("v{} of {}", vertex.index() - site.first_vertex, site.name),
            None => vertex.to_string(),
        }
    }

    /// Which ids are of which node and mesh; `null` where all are of one.
    pub fn json(&self) -> Value {
        let json = |site: &Site| {
            json!({
                "node": site.node, "mesh": site.mesh, "name": site.name,
                "first_vertex": site.first_vertex, "vertices": site.vertices,
                "first_face": site.first_face, "faces": site.faces,
            })
        };
        match &self.0[..] {
            [_] => Value::Null,
            sites => sites.iter().map(json).collect(),
        }
    }
}
