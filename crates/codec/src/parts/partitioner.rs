//! Partition of a mesh into any number of parts.

use meshlod_mesh::{Mesh, VertexId};

use super::division::Division;
use super::face_graph::{FaceGraph, is_whole};
use super::grid::{ACROSS, Reconstruction, SharedGrid};
use super::merge::Merges;
use super::{Parts, PartsError, lloyd};

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
/// Fraction of the size that cells as large as requested may still save when it stops, too.
const LITTLE: f64 = 0.005;
/// Ratio of too many parts to too few at which it stops, too: the sides of nearly equal numbers of
/// parts differ by chance.
const CLOSE_COUNT: f64 = 1.03;
/// Longest side of the largest box before relaxation, relative to the mean side after it, where it is
/// large: the search should start from too few parts, since flat ones gain from more of them forever.
const GAIN: f64 = 1.3;
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
        let mut used = vec![false; mesh.positions.len()];
        let whole = mesh.faces.iter().filter(|face| is_whole(face));
        whole.flatten().for_each(|v| used[v.index()] = true);
        let is_far = |v: &usize| !mesh.positions[*v].iter().all(|x| x.abs() < f64::from(f32::MAX));
        if let Some(v) = (0..used.len()).filter(|&v| used[v]).find(is_far) {
            return Err(PartsError::NotFinite(VertexId::new(v)));
        }
        let graph = FaceGraph::new(mesh);
        if graph.faces() == 0 {
            return Err(PartsError::Empty);
        }
        let merges = Merges::new(&graph);
        Ok(Self { graph, merges, vertices: used.iter().filter(|&&used| used).count() })
    }

    /// Partitions the mesh into `count` parts, or into as many as there are faces if these are
    /// fewer.
    ///
    /// Cost: some dozen times O(n log n).
    pub fn with_count(&self, count: usize, cells: Reconstruction) -> Parts {
        self.divide(count, cells).parts(&self.graph)
    }

    fn divide(&self, count: usize, cells: Reconstruction) -> Division {
        let count = count.clamp(1, self.graph.faces());
        let of_faces = lloyd::relax(&self.graph, self.merges.clusters(count), count);
        let boxes = lloyd::boxes(&self.graph, &of_faces, count);
        Division::new(&self.graph, of_faces, &boxes, self.vertices, cells)
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
        let mut best = self.divide(1, cells);
        if best.reduction() < reduction {
            return Err(PartsError::TooSmall { best: best.reduction() });
        }
        let (mut fails, mut next) = (self.graph.faces() + 1, FIRST_COUNT);
        for _ in 0..MAX_TRIES {
            next = next.clamp(best.count(), fails - 1);
            if next == best.count() || best.reduction() - reduction < CLOSE {
                break;
            }
            let division = self.divide(next, cells);
            next = division.count_for(reduction);
            if division.reduction() >= reduction {
                best = division;
                next = next.max(best.count() + 1);
            } else {
                fails = division.count();
                next = next.min(fails - 1);
            }
        }
        Ok(best.parts(&self.graph))
    }

    /// Partitions the mesh into the fewest parts found whose grid cells have a mean side of `cell`
    /// model units.
    ///
    /// The largest face must fit into a part. Where that alone takes larger cells, the parts are
    /// the fewest found whose cells are hardly larger than that.
    /// If those would take more than uncompressed positions, returns about as many parts as take
    /// less.
    ///
    /// Cost: that of several [`Partitioner::with_count`].
    pub fn within_cell(&self, cell: f64, cells: Reconstruction) -> Parts {
        let least = SharedGrid::new(self.graph.boxes(), cells).mean_side();
        let goal = cell.max(least);
        let (mut few, mut many): (Option<Division>, Option<Division>) = (None, None);
        let mut next = Some(self.merges.count_within(GAIN * ACROSS * goal));
        for _ in 0..MAX_TRIES {
            let Some(count) = next else { break };
            let division = self.divide(count, cells);
            let ratio = division.mean_side() / goal;
            let is_small = division.reduction() > 0.0;
            let is_few = ratio > 1.0 && is_small;
            let is_close = ratio >= CLOSE_CELL || division.saving(ratio) < LITTLE;
            let is_done = ratio <= 1.0 && is_small && is_close;
            let side = if is_few { &mut few } else { &mut many };
            *side = Some(division);
            if is_done {
                break;
            }
            next = self.next_count(few.as_ref(), many.as_ref(), goal);
        }
        let is_enough = |of: &Division| of.mean_side() <= goal && of.reduction() > 0.0;
        let enough = if many.as_ref().is_some_and(is_enough) { many } else { few.or(many) };
        enough.unwrap_or_else(|| self.divide(1, cells)).parts(&self.graph)
    }

    /// Returns the number of parts to try next for a mean side of `goal`, given the most that are
    /// too few and the fewest that are enough or too many; `None` if these are close together.
    fn next_count(
        &self,
        few: Option<&Division>,
        many: Option<&Division>,
        goal: f64,
    ) -> Option<usize> {
        let least = few.map_or(1, |few| few.count() + 1);
        let most = many.map_or(self.graph.faces(), |many| many.count() - 1);
        let excess = |division: &Division| (division.mean_side() / goal).ln();
        let wanted = match (few, many) {
            (Some(few), Some(many)) if many.count() as f64 <= CLOSE_COUNT * few.count() as f64 => {
                return None;
            }
            (Some(few), Some(many)) if many.reduction() > 0.0 => {
                let part = excess(few) / (excess(few) - excess(many)).max(f64::MIN_POSITIVE);
                let between = many.count() as f64 / few.count() as f64;
                few.count() as f64 * between.powf(part.clamp(0.1, 0.9))
            }
            // Sides of a surface's parts shrink as the square root of their number.
            (Some(one), None) => one.count() as f64 * SLIGHTLY_MORE * (2.0 * excess(one)).exp(),
            (None, Some(one)) if one.reduction() > 0.0 => {
                one.count() as f64 * SLIGHTLY_MORE * (2.0 * excess(one)).exp()
            }
            _ => (least as f64 * most as f64).sqrt(),
        };
        (least <= most).then(|| (wanted as usize).clamp(least, most))
    }
}
