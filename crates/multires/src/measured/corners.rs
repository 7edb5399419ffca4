//! Positions of the corners of faces during a replay of contractions: those of the mesh, or posed.

use glam::DVec3;
use meshlod_mesh::{Layer, Mesh, VertexId};

use super::posing::{PosedWedges, Posing};
use crate::forest::{Forest, NONE, Stars};

/// Places of the corners of all faces, which follow the contractions.
pub(super) trait Corners {
    /// Applies a contraction into `node`; the stars must already include it.
    fn contract(&mut self, stars: &Stars, node: u32);

    /// Returns the place of a corner of a face, at a node.
    fn at(&self, face: u32, corner: usize, node: u32) -> DVec3;
}

/// Corners at the positions of their nodes.
pub(super) struct AtNodes<'f>(pub(super) &'f Forest);

impl Corners for AtNodes<'_> {
    fn contract(&mut self, _: &Stars, _: u32) {}

    fn at(&self, _: u32, _: usize, node: u32) -> DVec3 {
        self.0.exact_stored(node)
    }
}

/// Corners where a pose puts their wedges.
pub(super) struct AtWedges<'t> {
    table: &'t WedgeTable,
    /// By face: wedges of its corners.
    of_faces: Vec<[u32; 3]>,
    /// By wedge: its place, in stored units.
    places: Vec<DVec3>,
}

impl Corners for AtWedges<'_> {
    fn contract(&mut self, stars: &Stars, node: u32) {
        for &face in stars.changed() {
            let Some(nodes) = stars.face(face) else { continue };
            for (wedge, at) in self.of_faces[face as usize].iter_mut().zip(nodes) {
                let parent = self.table.parents[*wedge as usize];
                if at == node && parent != NONE {
                    *wedge = parent;
                }
            }
        }
    }

    fn at(&self, face: u32, corner: usize, _: u32) -> DVec3 {
        self.places[self.of_faces[face as usize][corner] as usize]
    }
}

/// All wedges of a forest as a pose takes them. Without attributes each node is a wedge.
pub(super) struct WedgeTable {
    /// By wedge: the one above, or [`NONE`].
    parents: Vec<u32>,
    /// By face of the input: its wedges.
    of_faces: Vec<[u32; 3]>,
    /// By wedge: its position, in model units.
    positions: Vec<[f64; 3]>,
    objects: Vec<u32>,
    layers: Vec<Layer>,
    /// Positions of the wedges of the input, which come first.
    of_input: Vec<[f64; 3]>,
}

impl WedgeTable {
    /// Lists the wedges of a forest; those of its leaves also at the places that `input` gives them.
    pub(super) fn new(forest: &Forest, input: &Mesh) -> Self {
        let nodes = wedge_nodes(forest);
        let model = |node: u32| forest.frame.model(forest.exact_stored(node));
        let leaves = nodes.iter().take_while(|&&node| (node as usize) < forest.vertices);
        let in_input = |&leaf: &u32| forest.frame.model(input.positions[leaf as usize]);
        let (parents, of_faces, objects) = match &forest.wedges {
            Some(wedges) => {
                let pair = |wedge| wedges.labels.pairs.get(wedges.labels.of(wedge) as usize);
                let object = |wedge| pair(wedge).map_or(0, |pair| pair[1]);
                let objects = (0..wedges.len() as u32).map(object).collect();
                (wedges.parents.clone(), wedges.corners.clone(), objects)
            }
            None => {
                let above = |&update: &u32| forest.node(update as usize) as u32;
                let above = |update: &u32| if *update == NONE { NONE } else { above(update) };
                let parents = forest.parents().iter().map(above).collect();
                (parents, forest.faces.clone(), vec![0; nodes.len()])
            }
        };
        let layers = forest.wedges.as_ref().map_or_else(Vec::new, |wedges| {
            let all = 0..wedges.len() as u32;
            wedges.values.packed(all.clone()).layers(all)
        });
        Self {
            parents,
            of_faces,
            objects,
            layers,
            of_input: leaves.map(in_input).collect(),
            positions: nodes.into_iter().map(model).collect(),
        }
    }

    /// Returns the input in a pose, in stored units, with a vertex for each wedge.
    pub(super) fn input(&self, forest: &Forest, posing: &dyn Posing, pose: usize) -> Mesh {
        let places = self.places(forest, posing, pose, &self.of_input);
        let places = places.iter().map(DVec3::to_array).collect();
        Mesh::new(places, self.of_faces.iter().map(|face| face.map(VertexId)).collect())
    }

    /// Returns the corners of the input's faces in a pose, ready to follow contractions.
    pub(super) fn corners(
        &self,
        forest: &Forest,
        posing: &dyn Posing,
        pose: usize,
    ) -> AtWedges<'_> {
        let places = self.places(forest, posing, pose, &self.positions);
        AtWedges { table: self, of_faces: self.of_faces.clone(), places }
    }

    fn places(
        &self,
        forest: &Forest,
        posing: &dyn Posing,
        pose: usize,
        positions: &[[f64; 3]],
    ) -> Vec<DVec3> {
        let objects = &self.objects[..positions.len()];
        let wedges = PosedWedges { positions, objects, layers: &self.layers };
        let places = posing.places(pose, &wedges);
        assert_eq!(places.len(), positions.len(), "a place for each wedge");
        places.into_iter().map(|place| forest.frame.local(place)).collect()
    }
}

/// Returns the node of each wedge.
fn wedge_nodes(forest: &Forest) -> Vec<u32> {
    let nodes = 0..forest.positions.len() as u32;
    match &forest.wedges {
        Some(wedges) => nodes.flat_map(|node| wedges.of(node).map(move |_| node)).collect(),
        None => nodes.collect(),
    }
}
