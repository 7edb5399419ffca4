//! How a mesh falls into parts, in any number of them.

use meshlod_mesh::{Mesh, VertexId};

use super::grid::{Cells, Grid};
use super::merge::Merges;
use super::surface::Surface;
use super::{Part, Parts, PartsError, lloyd};

/// What all numbers of parts of a mesh have in common.
pub struct Parting<'m> {
    pub(super) surface: Surface<'m>,
    pub(super) merges: Merges,
    vertices: usize,
}

/// Where the search for a number of parts begins, and how often it is tried.
const FIRST_COUNT: usize = 64;
const MOST_COUNTS: usize = 10;
/// What is as close as this to the reduction that was asked for is good.
const CLOSE: f64 = 5e-4;

impl<'m> Parting<'m> {
    /// Looks how a mesh falls into parts. Faces that repeat a vertex are left out.
    ///
    /// Cost: O(n log² n), n = faces.
    /// # Errors
    /// A mesh without faces, or with coordinates that are none.
    pub fn new(mesh: &'m Mesh) -> Result<Self, PartsError> {
        let surface = Surface::new(mesh);
        if surface.faces() == 0 {
            return Err(PartsError::Empty);
        }
        let mut used = vec![false; mesh.positions.len()];
        surface.triangles.iter().flatten().for_each(|v| used[v.index()] = true);
        let is_far = |v: &usize| !mesh.positions[*v].iter().all(|x| x.abs() < f64::from(f32::MAX));
        if let Some(v) = (0..used.len()).filter(|&v| used[v]).find(is_far) {
            return Err(PartsError::NotFinite(VertexId::new(v)));
        }
        let merges = Merges::new(&surface);
        Ok(Self { surface, merges, vertices: used.iter().filter(|&&used| used).count() })
    }

    /// In so many parts, or as many as there are faces.
    ///
    /// Cost: some dozen times O(n log n).
    pub fn into_count(&self, count: usize, cells: Cells) -> Parts {
        let count = count.clamp(1, self.surface.faces());
        let of_faces = lloyd::settle(&self.surface, self.merges.clusters(count), count);
        let grid = Grid::new(&lloyd::boxes(&self.surface, &of_faces, count), cells);
        let mut parts = self.members(&of_faces, count);
        parts.iter_mut().for_each(|part| grid.quantize(&self.surface, part));
        Parts { grid, vertices: self.vertices, parts }
    }

    /// In about as many parts as leave this reduction of what positions take, a part between 0 and 1: more
    /// parts have smaller cells and store more vertices twice.
    ///
    /// The reduction is kept, and exceeded by little: on closed meshes of some thousand vertices by less than
    /// a thousandth. Cost: of some [`Parting::into_count`].
    /// # Errors
    /// A reduction that is none, or that the mesh is too small for.
    pub fn within_reduction(&self, reduction: f64, cells: Cells) -> Result<Parts, PartsError> {
        if !(0.0..1.0).contains(&reduction) {
            return Err(PartsError::Reduction(reduction));
        }
        let mut best = self.into_count(1, cells);
        if best.reduction() < reduction {
            return Err(PartsError::TooSmall { best: best.reduction() });
        }
        let (mut fails, mut next) = (self.surface.faces() + 1, FIRST_COUNT);
        for _ in 0..MOST_COUNTS {
            next = next.clamp(best.parts.len(), fails - 1);
            if next == best.parts.len() || best.reduction() - reduction < CLOSE {
                break;
            }
            let parts = self.into_count(next, cells);
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

    /// The parts with their own numbers for vertices, not yet in cells.
    fn members(&self, of_faces: &[u32], count: usize) -> Vec<Part> {
        let empty = Part { offset: [0; 3], positions: vec![], vertices: vec![], faces: vec![] };
        let mut parts = vec![empty; count];
        for (face, &part) in self.surface.triangles.iter().zip(of_faces) {
            // By the mesh's numbers, for now.
            parts[part as usize].faces.push(face.map(|vertex| vertex.0));
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
