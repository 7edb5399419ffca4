//! What an extraction gives.

use glam::{DVec3, Vec3};
use meshlod_mesh::{Mesh, VertexId};

use crate::frame::Frame;
use crate::pack::ExactPositions;
use crate::query::Region;
use crate::query::{Focus, QueryError};

/// The cosine between two normals below which an edge is a fold.
const FOLD: f64 = -0.7;

/// Where fewer than one node in so many is there, they are searched for: a table of all would cost
/// more than the level.
const SPARSE: usize = 64;

/// A mesh out of a multiresolution model.
///
/// It shares with the model the positions that are kept to the bit, and finds them by `nodes`: what is
/// put in another order has to take its node along.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    frame: Frame,
    /// What each vertex is in the model: the same vertex of another level has the same number. Not to be
    /// changed: a vertex of the input is where its node is.
    pub nodes: Vec<u32>,
    /// Where each vertex is, in stored units and single precision: see [`Level::mesh`] for those of the
    /// model.
    pub positions: Vec<[f32; 3]>,
    /// Three vertices each, counter-clockwise seen from outside.
    pub faces: Vec<[u32; 3]>,
    /// Of the model's nodes, where the input is kept as it was.
    pub(crate) exact: ExactPositions,
}

impl Level {
    pub(crate) fn new(frame: Frame) -> Self {
        Self {
            frame,
            nodes: Vec::new(),
            positions: Vec::new(),
            faces: Vec::new(),
            exact: ExactPositions::default(),
        }
    }

    /// Forgets the mesh and keeps the room.
    pub(crate) fn clear(&mut self) {
        self.nodes.clear();
        self.positions.clear();
        self.faces.clear();
        self.exact = ExactPositions::default();
    }

    /// Of faces by nodes, of which there are `count`, and where each is.
    pub(crate) fn from_nodes(
        frame: Frame,
        count: usize,
        place: impl Fn(u32) -> [f32; 3],
        mut faces: Vec<[u32; 3]>,
    ) -> Self {
        let mut nodes: Vec<u32> = faces.iter().flatten().copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        if nodes.len() < count / SPARSE {
            let number = |node: u32| nodes.binary_search(&node).unwrap_or_default() as u32;
            faces.iter_mut().flatten().for_each(|node| *node = number(*node));
        } else {
            let mut number = vec![0; count];
            (0..).zip(&nodes).for_each(|(i, &node)| number[node as usize] = i);
            faces.iter_mut().flatten().for_each(|node| *node = number[*node as usize]);
        }
        let positions = nodes.iter().map(|&node| place(node)).collect();
        Self { frame, nodes, positions, faces, exact: ExactPositions::default() }
    }

    /// With the positions to the bit of those of the model's nodes that have one.
    pub(crate) fn with_exact(self, exact: &ExactPositions) -> Self {
        Self { exact: exact.clone(), ..self }
    }

    /// The faces that meet a focus, with their vertices: those that have a point in it, up to the
    /// rounding of positions; for a segment and a frustum maybe some that only come close.
    ///
    /// Cost: linear. [`Cut::level_within`](crate::Cut::level_within) looks at what is there only.
    /// # Errors
    /// A focus that is none.
    pub fn within(&self, focus: &Focus) -> Result<Self, QueryError> {
        focus.validate()?;
        let region = Region::new(focus, &self.frame);
        let corners = |face: &&[u32; 3]| face.map(|v| self.exact_stored(v));
        let faces = self.faces.iter().filter(|face| region.meets_triangle(corners(face)));
        let (count, place) = (self.positions.len(), |v: u32| self.positions[v as usize]);
        let level = Self::from_nodes(self.frame, count, place, faces.copied().collect());
        let mut level = level.with_exact(&self.exact);
        // They were told by their places here.
        level.nodes.iter_mut().for_each(|node| *node = self.nodes[*node as usize]);
        Ok(level)
    }

    /// Where a vertex is, in stored units: to the bit if that is known.
    fn exact_stored(&self, v: u32) -> DVec3 {
        let rounded = || Vec3::from(self.positions[v as usize]).as_dvec3();
        let exact = self.exact.get(self.nodes[v as usize]);
        exact.map_or_else(rounded, |exact| self.frame.point(exact.into()))
    }

    /// In model units; vertices of the input to the bit, where the model [keeps](crate::Forest::lossless)
    /// them.
    pub fn mesh(&self) -> Mesh {
        let position = |(&node, &rounded): (&u32, &[f32; 3])| {
            self.exact.get(node).unwrap_or_else(|| self.frame.model(rounded))
        };
        Mesh::new(
            self.nodes.iter().zip(&self.positions).map(position).collect(),
            self.faces.iter().map(|face| face.map(VertexId)).collect(),
        )
    }

    /// How many edges have two faces that turn back on each other: whose normals are more than 134°
    /// apart.
    ///
    /// Cost: n log n.
    pub fn folds(&self) -> usize {
        let normal = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|v| self.exact_stored(v));
            (b - a).cross(c - a).normalize_or_zero()
        };
        let normals: Vec<_> = self.faces.iter().map(normal).collect();
        let mut sides: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * self.faces.len());
        for (f, &[a, b, c]) in self.faces.iter().enumerate() {
            let ends = [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)]);
            sides.extend(ends.map(|ends| (ends, f as u32)));
        }
        sides.sort_unstable();
        let faces = sides.chunk_by(|a, b| a.0 == b.0).filter(|side| side.len() == 2);
        let fold = |side: &&[([u32; 2], u32)]| {
            normals[side[0].1 as usize].dot(normals[side[1].1 as usize]) < FOLD
        };
        faces.filter(fold).count()
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

#[cfg(test)]
mod tests {
    use meshlod_mesh::Bounds;

    use super::*;

    #[test]
    fn an_edge_that_turns_back_is_a_fold() {
        let frame = Frame::new(&Bounds { min: [0.0; 3], max: [1.0; 3] });
        let level = |height: f64| {
            let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1.0, 0.0], [0.5, 0.9, height]];
            let places: Vec<_> =
                corners.iter().map(|&c| frame.store(DVec3::from(c)).to_array()).collect();
            Level::from_nodes(frame, 4, |node| places[node as usize], vec![[0, 1, 2], [0, 3, 1]])
        };
        assert_eq!((level(0.1).folds(), level(2.0).folds()), (1, 0));
    }
}
