//! Strips of scenes that show meshes many times: of each mesh once, counted as often as it is shown.

use meshlod_io::{MeshInstance, Node, Scene};
use meshlod_mesh::{Connectivity, VertexId};
use meshlod_strip::{MergeTree, StripStatistics, StripWedge, Strips};

use super::{Odd, StripRequest};
use crate::VertexLocking;
use crate::jobs::copies::Copies;

/// The meshes of a scene of copies.
pub(super) struct EachMesh {
    /// The scene with each mesh once, as the largest of its instances.
    pub scene: Scene,
    /// Number of instances of each mesh, in the order of that scene.
    times: Vec<usize>,
    /// Their first faces in that scene, merged into one mesh. Those of a mesh without faces are those
    /// of the next.
    first_faces: Vec<usize>,
}

impl EachMesh {
    /// Returns the meshes of a scene; `None` unless it shows them many times, in similar shapes, and
    /// strips are not held or fused where instances meet.
    pub fn of(scene: &Scene, request: &StripRequest) -> Option<Self> {
        let constraints = &request.constraints;
        if constraints.fuse || matches!(constraints.locks, VertexLocking::Contacts(_)) {
            return None;
        }
        let copies = Copies::of(scene)?;
        let mut of_meshes = vec![0; scene.meshes.len()];
        scene.instances().iter().for_each(|shown| of_meshes[shown.mesh] += 1);
        let mut own = Self {
            scene: Scene { nodes: Vec::new(), roots: Vec::new(), source: None, ..scene.clone() },
            times: Vec::new(),
            first_faces: Vec::new(),
        };
        let mut faces = 0;
        for shown in each_shown(scene, &copies) {
            let node = &scene.nodes[shown.node];
            own.scene.roots.push(own.scene.nodes.len());
            own.scene.nodes.push(Node {
                name: node.name.clone(),
                transform: shown.transform,
                mesh: Some(shown.mesh),
                ..Node::default()
            });
            own.times.push(of_meshes[shown.mesh]);
            own.first_faces.push(faces);
            faces += scene.meshes[shown.mesh].mesh.faces.len();
        }
        Some(own)
    }

    /// Returns the largest number of times that a mesh with faces is shown.
    pub fn most_times(&self) -> usize {
        let shown = self.scene.nodes.iter().zip(&self.times);
        let has_faces = |node: &Node| {
            node.mesh.is_some_and(|mesh| !self.scene.meshes[mesh].mesh.faces.is_empty())
        };
        shown.filter(|(node, _)| has_faces(node)).map(|(_, times)| *times).max().unwrap_or(1)
    }

    /// Returns the number of faces that are shown of some faces of the tree.
    pub fn shown(&self, wedges: &[StripWedge], faces: &[[VertexId; 3]]) -> usize {
        faces.iter().map(|face| self.times[self.mesh(wedges, face[0])]).sum()
    }

    /// Returns the place, in the scene of each mesh once, of the mesh that has a vertex of the tree.
    fn mesh(&self, wedges: &[StripWedge], vertex: VertexId) -> usize {
        let face = wedges[vertex.index()].face.index();
        self.first_faces.partition_point(|first| *first <= face) - 1
    }

    /// Counts what strips send for all instances, which are drawn one after the other.
    pub fn statistics(&self, wedges: &[StripWedge], strips: &Strips) -> StripStatistics {
        let mut of_meshes = vec![Strips::default(); self.times.len()];
        for strip in strips.iter().filter(|strip| !strip.is_empty()) {
            of_meshes[self.mesh(wedges, strip[0])].push(strip.iter().copied());
        }
        let mut all = StripStatistics::new(&Strips::default());
        for (own, &times) in of_meshes.iter().zip(&self.times) {
            let own = StripStatistics::new(own);
            all.triangles += times * own.triangles;
            all.vertices_sent += times * own.vertices_sent;
            all.indices_with_restart += times * own.indices_with_restart;
            all.indices_stitched += times * own.indices_stitched;
            all.strips += times * own.strips;
            all.swaps += times * own.swaps;
            all.odd_starts += times * own.odd_starts;
            // Misses of the caches, until they are shared out.
            let drawn = (times * own.triangles) as f64;
            all.acmr16 += drawn * own.acmr16;
            all.acmr32 += drawn * own.acmr32;
        }
        let drawn = all.triangles.max(1) as f64;
        StripStatistics { acmr16: all.acmr16 / drawn, acmr32: all.acmr32 / drawn, ..all }
    }

    /// Counts what is odd about the faces of all instances.
    pub fn odd_faces(&self, wedges: &[StripWedge], tree: &MergeTree) -> Odd {
        let mut kept = vec![0; self.times.len()];
        tree.faces().iter().for_each(|face| kept[self.mesh(wedges, face[0])] += 1);
        let mut all = Odd::default();
        for ((node, times), kept) in self.scene.nodes.iter().zip(&self.times).zip(kept) {
            let mesh = &self.scene.meshes[node.mesh.expect("every node has one")].mesh;
            let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
            all.add(&Odd::of(&connectivity, mesh.faces.len() - kept), *times);
        }
        all
    }
}

/// Returns an instance of each mesh that a scene shows, by mesh: the largest, or the first of a mesh
/// without faces.
fn each_shown(scene: &Scene, copies: &Copies) -> Vec<MeshInstance> {
    let mut shown: Vec<MeshInstance> = copies.largest().chain(scene.instances()).collect();
    shown.sort_by_key(|shown| shown.mesh);
    shown.dedup_by_key(|shown| shown.mesh);
    shown
}
