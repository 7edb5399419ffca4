//! How a mesh falls into parts, in any number of them.

use meshlod_mesh::{Mesh, VertexId};

use super::face_graph::FaceGraph;
use super::grid::{Reconstruction, SharedGrid};
use super::merge::Merges;
use super::{Part, Parts, PartsError, lloyd};

/// What all numbers of parts of a mesh have in common.
pub struct Partitioner<'m> {
    pub(super) graph: FaceGraph<'m>,
    pub(super) merges: Merges,
    vertices: usize,
}

/// Where the search for a number of parts begins, and how often it is tried.
const FIRST_COUNT: usize = 64;
const MOST_COUNTS: usize = 10;
/// What is as close as this below the cells that were asked for is good.
const CLOSE_CELL: f64 = 0.97;
/// So that the next try rather keeps what was asked for.
const SLIGHTLY_MORE: f64 = 1.01;
/// What is as close as this to the reduction that was asked for is good.
const CLOSE: f64 = 5e-4;

impl<'m> Partitioner<'m> {
    /// Looks how a mesh falls into parts. Faces that repeat a vertex are left out.
    ///
    /// Cost: O(n log² n), n = faces.
    /// # Errors
    /// A mesh without faces, or with coordinates that are none.
    pub fn new(mesh: &'m Mesh) -> Result<Self, PartsError> {
        let graph = FaceGraph::new(mesh);
        if graph.faces() == 0 {
            return Err(PartsError::Empty);
        }
        let mut used = vec![false; mesh.positions.len()];
        graph.triangles.iter().flatten().for_each(|v| used[v.index()] = true);
        let is_far = |v: &usize| !mesh.positions[*v].iter().all(|x| x.abs() < f64::from(f32::MAX));
        if let Some(v) = (0..used.len()).filter(|&v| used[v]).find(is_far) {
            return Err(PartsError::NotFinite(VertexId::new(v)));
        }
        let merges = Merges::new(&graph);
        Ok(Self { graph, merges, vertices: used.iter().filter(|&&used| used).count() })
    }

    /// In so many parts, or as many as there are faces.
    ///
    /// Cost: some dozen times O(n log n).
    pub fn with_count(&self, count: usize, cells: Reconstruction) -> Parts {
        let count = count.clamp(1, self.graph.faces());
        let of_faces = lloyd::relax(&self.graph, self.merges.clusters(count), count);
        let grid = SharedGrid::new(&lloyd::boxes(&self.graph, &of_faces, count), cells);
        let mut parts = self.members(&of_faces, count);
        parts.iter_mut().for_each(|part| grid.quantize(&self.graph, part));
        Parts { grid, vertices: self.vertices, parts }
    }

    /// In about as many parts as leave this reduction of what positions take, a part between 0 and 1: more
    /// parts have smaller cells and store more vertices twice.
    ///
    /// The reduction is kept, and exceeded by little: on closed meshes of some thousand vertices by less than
    /// a thousandth. Cost: of some [`Partitioner::with_count`].
    /// # Errors
    /// A reduction that is none, or that the mesh is too small for.
    pub fn within_reduction(
        &self,
        reduction: f64,
        cells: Reconstruction,
    ) -> Result<Parts, PartsError> {
        if !(0.0..1.0).contains(&reduction) {
            return Err(PartsError::Reduction(reduction));
        }
        let mut best = self.with_count(1, cells);
        if best.reduction() < reduction {
            return Err(PartsError::TooSmall { best: best.reduction() });
        }
        let (mut fails, mut next) = (self.graph.faces() + 1, FIRST_COUNT);
        for _ in 0..MOST_COUNTS {
            next = next.clamp(best.parts.len(), fails - 1);
            if next == best.parts.len() || best.reduction() - reduction < CLOSE {
                break;
            }
            let parts = self.with_count(next, cells);
            next = parts.count_for(reduction);
            if parts.reduction() >= reduction {
                best = parts;
                next = next.max(best.parts.len() + 1);
            } else {
                fails = parts.parts.len();
                next = next.min(fails - 1);
            }
        }
        Ok(best)
    }

    /// In as few parts as are found whose cells have sides of this length in the mean; or, where those would take more
    /// than the positions do, in about as many as take less.
    ///
    /// Cost: of some [`Partitioner::with_count`].
    pub fn within_cell(&self, cell: f64, cells: Reconstruction) -> Parts {
        let (mut few, mut many): (Option<Parts>, Option<Parts>) = (None, None);
        let mut next = 1;
        for _ in 0..MOST_COUNTS {
            let parts = self.with_count(next, cells);
            let ratio = parts.mean_side() / cell;
            let is_small = parts.reduction() > 0.0;
            let is_few = ratio > 1.0 && is_small;
            let side = if is_few { &mut few } else { &mut many };
            *side = Some(parts);
            let count = |parts: &Option<Parts>| parts.as_ref().map(|parts| parts.parts.len());
            let least = count(&few).unwrap_or(0) + 1;
            let most = count(&many).map_or(self.graph.faces(), |many| many - 1);
            if least > most || (CLOSE_CELL..=1.0).contains(&ratio) {
                break;
            }
            // Sides of a surface's parts shrink as the root of how many there are.
            let wanted = match is_small {
                true => next as f64 * ratio * ratio * SLIGHTLY_MORE,
                false => (least as f64 * most as f64).sqrt(),
            };
            next = (wanted as usize).clamp(least, most);
        }
        let is_enough = |parts: &Parts| parts.mean_side() <= cell;
        let enough = if many.as_ref().is_some_and(is_enough) { many } else { few.or(many) };
        enough.unwrap_or_else(|| self.with_count(1, cells))
    }

    /// The parts with their own numbers for vertices, not yet in cells.
    fn members(&self, of_faces: &[u32], count: usize) -> Vec<Part> {
        let mut parts = vec![Part::default(); count];
        let faces = self.graph.triangles.iter().zip(&self.graph.ids);
        for ((face, &id), &part) in faces.zip(of_faces) {
            let part = &mut parts[part as usize];
            // By the mesh's numbers, for now.
            part.faces.push(face.map(|vertex| vertex.0));
            part.ids.push(id);
        }
        for part in &mut parts {
            let mut vertices: Vec<u32> = part.faces.iter().flatten().copied().collect();
            vertices.sort_unstable();
            vertices.dedup();
            let local = |v: u32| vertices.binary_search(&v).unwrap_or_default() as u32;
            part.faces.iter_mut().flatten().for_each(|v| *v = local(*v));
            part.vertices = vertices.into_iter().map(VertexId).collect();
        }
        parts
    }
}
