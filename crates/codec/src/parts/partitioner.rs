//! Partition of a mesh into any number of parts.

use meshlod_mesh::{Mesh, VertexId};

use super::face_graph::FaceGraph;
use super::grid::{ACROSS, Reconstruction, SharedGrid};
use super::merge::Merges;
use super::{Part, Parts, PartsError, lloyd};

/// Hierarchical clustering of a mesh's faces, from which partitions of any size are made.
pub struct Partitioner<'m> {
    pub(super) graph: FaceGraph<'m>,
    pub(super) merges: Merges,
    vertices: usize,
}

/// First number of parts to try, and the limit on tries.
const FIRST_COUNT: usize = 64;
const MAX_TRIES: usize = 10;
/// Ratio of cell to requested cell at which the search stops.
const CLOSE_CELL: f64 = 0.97;
/// Longest side of the largest box before relaxation, relative to the mean side after it, where it is
/// large: the search should start from too few parts, since flat ones gain from more of them forever.
const GAIN: f64 = 1.6;
/// Factor on the next number of parts, so that it is more likely to meet the request.
const SLIGHTLY_MORE: f64 = 1.01;
/// Excess of the reduction at which the search stops.
const CLOSE: f64 = 5e-4;

impl<'m> Partitioner<'m> {
    /// Clusters the faces of a mesh. Faces that repeat a vertex are left out.
    ///
    /// Cost: O(n log² n), n = faces.
    /// # Errors
    /// A mesh without faces, or a coordinate that is not finite.
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

    /// Partitions the mesh into `count` parts, or into as many as there are faces if these are
    /// fewer.
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

    /// Partitions the mesh into about as many parts as still save a given fraction of position
    /// storage.
    ///
    /// The fraction is between 0 and 1. More parts have smaller cells but repeat more vertices.
    ///
    /// The reduction is kept, and exceeded by little: by less than a thousandth on closed meshes of
    /// some thousand vertices. Cost: that of several [`Partitioner::with_count`].
    /// # Errors
    /// A reduction out of range, or one that the mesh is too small for.
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
        for _ in 0..MAX_TRIES {
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

    /// Partitions the mesh into the fewest parts found whose grid cells have a mean side of `cell`
    /// model units.
    ///
    /// If those would take more than uncompressed positions, returns about as many parts as take
    /// less.
    ///
    /// Cost: that of several [`Partitioner::with_count`].
    pub fn within_cell(&self, cell: f64, cells: Reconstruction) -> Parts {
        let (mut few, mut many): (Option<Parts>, Option<Parts>) = (None, None);
        let mut next = self.merges.count_within(GAIN * ACROSS * cell);
        for _ in 0..MAX_TRIES {
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
            // Sides of a surface's parts shrink as the square root of their number.
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

    /// Collects the parts with local vertex indices, not yet quantized.
    fn members(&self, of_faces: &[u32], count: usize) -> Vec<Part> {
        let mut parts = vec![Part::default(); count];
        let faces = self.graph.triangles.iter().zip(&self.graph.ids);
        for ((face, &id), &part) in faces.zip(of_faces) {
            let part = &mut parts[part as usize];
            // Mesh indices, for now.
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
