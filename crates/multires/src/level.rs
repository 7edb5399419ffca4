//! The mesh that an extraction returns.

use glam::{DVec3, Vec3};
use meshlod_mesh::{Frame, Mesh, VertexId};
use meshlod_spatial::closest_point;

use crate::pack::ExactPositions;
use crate::query::{Criterion, Focus, Query, QueryError, Region};
use crate::wedges::LevelWedges;

/// Cosine of the angle between two face normals below which their common edge counts as folded.
const FOLD: f64 = -0.7;

/// If fewer than one node in this many is in the level, nodes are looked up by binary search: a
/// table over all nodes would cost more than the level itself.
const SPARSE: usize = 64;

/// A mesh extracted from a multiresolution model.
///
/// A level of a lossless model shares its table of exact positions and looks them up through
/// `nodes`, so code that reorders vertices must reorder `nodes` with them.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    frame: Frame,
    /// Number of each vertex's node in the model, which is the same in every level.
    ///
    /// Do not change the numbers, as exact positions are found by them.
    pub nodes: Vec<u32>,
    /// Vertex positions in the model's stored units, in single precision; [`Level::mesh`] converts
    /// them to model units.
    pub positions: Vec<[f32; 3]>,
    /// Vertex indices of each face, counter-clockwise seen from outside.
    pub faces: Vec<[u32; 3]>,
    /// Exact positions by node of the model, if the model is lossless.
    pub(crate) exact: ExactPositions,
    /// Wedges at the corners of the faces, if the model has attributes, materials or objects.
    pub(crate) wedges: Option<LevelWedges>,
}

impl Level {
    pub(crate) fn new(frame: Frame) -> Self {
        Self {
            frame,
            nodes: Vec::new(),
            positions: Vec::new(),
            faces: Vec::new(),
            exact: ExactPositions::default(),
            wedges: None,
        }
    }

    /// Empties the mesh but keeps its memory.
    pub(crate) fn clear(&mut self) {
        self.nodes.clear();
        self.positions.clear();
        self.faces.clear();
        self.exact = ExactPositions::default();
        self.wedges = None;
    }

    /// Builds a level from faces over `count` nodes, whose positions `place` returns.
    pub(crate) fn from_nodes(
        frame: Frame,
        count: usize,
        place: impl Fn(u32) -> [f32; 3],
        mut faces: Vec<[u32; 3]>,
    ) -> Self {
        let nodes = renumber(&mut faces, count);
        let positions = nodes.iter().map(|&node| place(node)).collect();
        Self { frame, nodes, positions, faces, exact: ExactPositions::default(), wedges: None }
    }

    /// Returns true if each face has wedges of its own nodes, of one material and object, which only
    /// certified models are sure of.
    pub(crate) fn has_own_wedges(&self) -> bool {
        self.wedges.as_ref().is_none_or(|LevelWedges { corners, all }| {
            let nodes = self.faces.iter().map(|face| face.map(|v| self.nodes[v as usize]));
            corners.iter().zip(nodes).all(|(&wedges, nodes)| all.may_be_at(wedges, nodes))
        })
    }

    /// Attaches the exact positions of the model's nodes.
    pub(crate) fn with_exact(self, exact: &ExactPositions) -> Self {
        Self { exact: exact.clone(), ..self }
    }

    /// Returns the faces that intersect the region `focus`, with their vertices.
    ///
    /// Intersection is exact up to the rounding of positions, except for segments and frusta, which
    /// may also return faces that only come close.
    ///
    /// Cost: linear. [`Cut::level_within`](crate::Cut::level_within) visits only what is near the
    /// focus.
    /// # Errors
    /// The focus is invalid.
    pub fn within(&self, focus: &Focus) -> Result<Self, QueryError> {
        focus.validate()?;
        let region = Region::new(focus, &self.frame);
        Ok(self.where_corners(|corners| region.meets_triangle(corners)))
    }

    /// Returns the faces that intersect the focus of a query, or where that is several queries, the
    /// focus of one of these, with their vertices, like [`within`](Self::within).
    ///
    /// Cost: linear, for each of the queries.
    /// # Errors
    /// The query is invalid.
    pub fn where_asked(&self, query: &Query<'_>) -> Result<Self, QueryError> {
        let criterion = Criterion::new(query, &self.frame)?;
        Ok(self.where_corners(|corners| criterion.meets_triangle(corners)))
    }

    fn where_corners(&self, keeps: impl Fn([DVec3; 3]) -> bool) -> Self {
        let corners = |face: [u32; 3]| face.map(|v| self.exact_stored(v));
        let kept: Vec<usize> =
            (0..self.faces.len()).filter(|&f| keeps(corners(self.faces[f]))).collect();
        let faces = kept.iter().map(|&f| self.faces[f]).collect();
        let (count, place) = (self.positions.len(), |v: u32| self.positions[v as usize]);
        let mut level = Self::from_nodes(self.frame, count, place, faces).with_exact(&self.exact);
        level.wedges = self.wedges.as_ref().map(|wedges| LevelWedges {
            corners: kept.iter().map(|&f| wedges.corners[f]).collect(),
            all: wedges.all.clone(),
        });
        // The faces were numbered by vertices of this level.
        level.nodes.iter_mut().for_each(|node| *node = self.nodes[*node as usize]);
        level
    }

    /// Returns the point of the level that is closest to a point in model units; `None` if the level
    /// has no faces.
    ///
    /// Cost: linear.
    pub fn closest_point(&self, point: [f64; 3]) -> Option<[f64; 3]> {
        let at = self.frame.local(point);
        let on_face = |face: &[u32; 3]| closest_point(at, &face.map(|v| self.exact_stored(v)));
        let order =
            |a: &DVec3, b: &DVec3| at.distance_squared(*a).total_cmp(&at.distance_squared(*b));
        self.faces.iter().map(on_face).min_by(order).map(|closest| self.frame.model(closest))
    }

    /// Returns the faces that contain the point of the level closest to a point in model units,
    /// with their vertices: one face, the two at an edge or those at a vertex.
    ///
    /// Cost: linear.
    /// # Errors
    /// A coordinate is not finite.
    pub fn nearest(&self, point: [f64; 3]) -> Result<Self, QueryError> {
        let focus = Focus::Point(point);
        focus.validate()?;
        self.within(&self.closest_point(point).map_or(focus, Focus::Point))
    }

    /// Returns the position of a vertex in stored units, exact if the model is lossless.
    fn exact_stored(&self, v: u32) -> DVec3 {
        let rounded = || Vec3::from(self.positions[v as usize]).as_dvec3();
        let exact = self.exact.get(self.nodes[v as usize]);
        exact.map_or_else(rounded, |exact| self.frame.local(exact))
    }

    /// Converts the level to a mesh in model units.
    ///
    /// Faces have the attributes, materials and objects of the model, if there are any. Vertices of
    /// the input come back exactly if the model is [lossless](crate::Forest::lossless).
    pub fn mesh(&self) -> Mesh {
        let position = |(&node, &rounded): (&u32, &[f32; 3])| {
            self.exact.get(node).unwrap_or_else(|| self.frame.model(Vec3::from(rounded)))
        };
        let mut mesh = Mesh::new(
            self.nodes.iter().zip(&self.positions).map(position).collect(),
            self.faces.iter().map(|face| face.map(VertexId)).collect(),
        );
        if let Some(wedges) = &self.wedges {
            wedges.add_to(&mut mesh);
        }
        mesh
    }

    /// Counts the folded edges: those whose two faces have normals more than 134° apart.
    ///
    /// Cost: O(n log n).
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

    /// Returns the faces as triples of model nodes in a canonical order, so that equal meshes
    /// compare as equal.
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

/// Numbers the nodes that faces use, or their wedges, from 0 on in rising order, out of `count`, and
/// returns them.
pub(crate) fn renumber(faces: &mut [[u32; 3]], count: usize) -> Vec<u32> {
    let mut used: Vec<u32> = faces.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    if used.len() < count / SPARSE {
        let number = |node: u32| used.binary_search(&node).unwrap_or_default() as u32;
        faces.iter_mut().flatten().for_each(|node| *node = number(*node));
    } else {
        let mut number = vec![0; count];
        (0..).zip(&used).for_each(|(i, &node)| number[node as usize] = i);
        faces.iter_mut().flatten().for_each(|node| *node = number[*node as usize]);
    }
    used
}

#[cfg(test)]
mod tests {
    use meshlod_mesh::Bounds;

    use super::*;

    #[test]
    fn an_edge_that_turns_back_is_a_fold() {
        let frame = Frame::of_diagonal(&Bounds { min: [0.0; 3], max: [1.0; 3] });
        let level = |height: f64| {
            let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1.0, 0.0], [0.5, 0.9, height]];
            let places: Vec<_> =
                corners.iter().map(|&c| frame.local(c).as_vec3().to_array()).collect();
            Level::from_nodes(frame, 4, |node| places[node as usize], vec![[0, 1, 2], [0, 3, 1]])
        };
        assert_eq!((level(0.1).folds(), level(2.0).folds()), (1, 0));
    }
}
