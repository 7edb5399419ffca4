//! Division of a mesh's faces into parts, with what tells how well it does.

use meshlod_mesh::{Bounds, VertexId};
use rayon::prelude::*;

use super::face_graph::FaceGraph;
use super::grid::{Reconstruction, SharedGrid};
use super::{HEADER, Part, Parts, part_header};
use crate::bytes::reduction;

/// Faces assigned to parts, the grid that these need, and the size that they would take.
pub(super) struct Division {
    /// Part number of each face of the graph.
    of_faces: Vec<u32>,
    count: usize,
    grid: SharedGrid,
    /// Size of a part's header in bytes.
    header: usize,
    /// Number of vertices that faces use, and of those of all parts together.
    vertices: usize,
    stored: usize,
}

impl Division {
    /// Finds the grid for parts given by their faces and boxes, and counts what they store.
    ///
    /// `vertices` is the number of vertices that faces use. Cost: O(n), n = faces.
    pub(super) fn new(
        graph: &FaceGraph,
        of_faces: Vec<u32>,
        boxes: &[Bounds],
        vertices: usize,
        cells: Reconstruction,
    ) -> Self {
        let grid = SharedGrid::new(boxes, cells);
        let offsets: Vec<_> = boxes.iter().map(|of| grid.number(of.min)).collect();
        let (count, header) = (boxes.len(), part_header(&offsets));
        let mut this = Self { of_faces, count, grid, header, vertices, stored: 0 };
        this.stored = this.count_stored(graph);
        this
    }

    pub(super) fn count(&self) -> usize {
        self.count
    }

    pub(super) fn mean_side(&self) -> f64 {
        self.grid.mean_side()
    }

    pub(super) fn reduction(&self) -> f64 {
        reduction(HEADER + self.count * self.header + 3 * self.stored, self.vertices)
    }

    /// Estimates the fraction of the size that is saved by parts whose sides are 1 / `ratio` times as
    /// long: borders grow as the root of the number of parts.
    pub(super) fn saving(&self, ratio: f64) -> f64 {
        let headers = (self.count * self.header) as f64;
        let borders = (3 * (self.stored - self.vertices)) as f64;
        let saved = (1.0 - ratio) * borders + (1.0 - ratio * ratio) * headers;
        saved / (headers + (3 * self.stored) as f64)
    }

    /// Estimates how many parts would give a reduction. Vertices are repeated along borders, whose
    /// length grows as the square root of the number of parts.
    pub(super) fn count_for(&self, reduction: f64) -> usize {
        let (count, header) = (self.count as f64, self.header as f64);
        let again = (self.stored - self.vertices).max(1) as f64 / count.sqrt();
        let room = (1.0 - reduction) * (12 * self.vertices) as f64;
        let room = room - (HEADER + 3 * self.vertices) as f64;
        // header · x² + 3 again · x = room, where x is the root.
        let half = 1.5 * again / header;
        let root = (half * half + room.max(0.0) / header).sqrt() - half;
        (root * root) as usize
    }

    /// Collects the parts and their quantized vertices.
    pub(super) fn parts(&self, graph: &FaceGraph) -> Parts {
        let mut parts = vec![Part::default(); self.count];
        let faces = graph.triangles.iter().zip(&graph.ids);
        for ((face, &id), &part) in faces.zip(&self.of_faces) {
            let part = &mut parts[part as usize];
            // Mesh indices, for now.
            part.faces.push(face.map(|vertex| vertex.0));
            part.ids.push(id);
        }
        parts.par_iter_mut().for_each(|part| {
            let mut vertices: Vec<u32> = part.faces.iter().flatten().copied().collect();
            vertices.sort_unstable();
            vertices.dedup();
            let local = |v: u32| vertices.binary_search(&v).unwrap_or_default() as u32;
            part.faces.iter_mut().flatten().for_each(|v| *v = local(*v));
            part.vertices = vertices.into_iter().map(VertexId).collect();
            self.grid.quantize(graph, part);
        });
        Parts { grid: self.grid, vertices: self.vertices, parts }
    }

    /// Counts the vertices of each part, and adds them up.
    fn count_stored(&self, graph: &FaceGraph) -> usize {
        let mut starts = vec![0u32; self.count + 1];
        self.of_faces.iter().for_each(|&part| starts[part as usize + 1] += 1);
        (0..self.count).for_each(|part| starts[part + 1] += starts[part]);
        let mut by_part = vec![0; self.of_faces.len()];
        for (face, &part) in (0u32..).zip(&self.of_faces) {
            let at = &mut starts[part as usize];
            by_part[*at as usize] = face;
            *at += 1;
        }
        let mut last = vec![u32::MAX; graph.mesh_vertices()];
        let mut stored = 0;
        for face in by_part {
            let part = self.of_faces[face as usize];
            for v in graph.triangles[face as usize] {
                stored += usize::from(std::mem::replace(&mut last[v.index()], part) != part);
            }
        }
        stored
    }
}
