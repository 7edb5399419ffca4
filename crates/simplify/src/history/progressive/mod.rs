//! Progressive mesh [Hop96]: a base mesh and vertex splits that refine it and can be undone.
//!
//! Each step swaps the changed values with the record of the split, so that one record serves both
//! directions and every level is restored exactly.

mod bytes;
mod check;

use meshlod_mesh::{Attributes, FaceId, Mesh, VertexId, WedgeId};

pub use bytes::ProgressiveError;

use crate::history::History;
use crate::simplifier::Simplifier;
use crate::surface::Surface;
use crate::surface::candidate_states::CandidateId;

/// Progressive mesh: all levels of a [`Simplifier`] run, one of which is current.
///
/// Its levels are exactly those that [`Simplifier::level`] returned on the way: positions,
/// attributes, materials, and the order of all. The finest level is the input without unused
/// vertices and without the faces that the simplifier left out; a wedge shared by two materials
/// becomes two.
#[derive(Clone, Debug, PartialEq)]
pub struct Progressive {
    /// Everything the input had, in its current state; removed elements keep their last state.
    mesh: Mesh,
    alive: Vec<bool>,
    live_faces: usize,
    splits: VertexSplits,
    /// Number of splits undone; splits are in the order of the contractions.
    coarsened: usize,
}

/// All splits, in the order of the contractions that they undo.
#[derive(Clone, Debug, Default, PartialEq)]
struct VertexSplits {
    splits: Vec<VertexSplit>,
    /// Face corners that move from one end to the other.
    moved: Vec<CandidateId>,
    /// Wedges of those corners on the other side of the split; empty without attributes.
    wedges: Vec<WedgeId>,
    removed_faces: Vec<FaceId>,
    /// Wedges whose values change.
    blended: Vec<WedgeId>,
    /// Values of those wedges on the other side of the split, all layers of a wedge in sequence.
    values: Vec<f32>,
}

/// Vertex split. Its lists end where those of the next split start.
#[derive(Clone, Copy, Debug, PartialEq)]
struct VertexSplit {
    kept: VertexId,
    removed: VertexId,
    /// Position of the kept vertex on the other side of the split.
    position: [f64; 3],
    moved: u32,
    removed_faces: u32,
    blended: u32,
}

impl Progressive {
    /// Builds a progressive mesh from a simplification and its history. Its current level is that
    /// of the simplifier. Returns `None` if the history has not recorded every contraction.
    pub fn new(simplifier: Simplifier<'_>, history: History) -> Option<Self> {
        if simplifier.live_faces() + history.removed_face_count() != simplifier.first_faces() {
            return None;
        }
        let (mesh, surface) = simplifier.into_surface();
        let attributes = mesh.attributes.is_some();
        let splits = VertexSplits::new(history, attributes);
        Some(Self {
            mesh: workspace(mesh, &surface),
            alive: (0..mesh.faces.len()).map(|f| surface.is_alive(FaceId::new(f))).collect(),
            live_faces: surface.live_faces(),
            coarsened: splits.splits.len(),
            splits,
        })
    }

    /// Returns the number of faces of the current level of detail.
    pub fn live_faces(&self) -> usize {
        self.live_faces
    }

    /// Returns the number of faces of the finest level of detail.
    pub fn full_faces(&self) -> usize {
        let undone = &self.splits.splits[self.coarsened..];
        let to_come = undone
            .first()
            .map_or(0, |s| self.splits.removed_faces.len() - s.removed_faces as usize);
        // The current level lacks the faces of the splits that are not refined yet.
        self.live_faces + self.splits.removed_faces.len() - to_come
    }

    /// Returns the number of vertex splits between the base and the finest level.
    pub fn len(&self) -> usize {
        self.splits.splits.len()
    }

    /// Returns true if there are no vertex splits, so that the base is the only level.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Applies one vertex split, towards the finest level. Returns false if the current level
    /// already is the finest.
    pub fn refine(&mut self) -> bool {
        let Some(last) = self.coarsened.checked_sub(1) else { return false };
        self.coarsened = last;
        let split = self.splits.splits[last];
        self.swap(last, split.removed);
        for &face in &self.splits.removed_faces[self.splits.removed_range(last)] {
            self.alive[face.index()] = true;
            self.live_faces += 1;
        }
        true
    }

    /// Undoes one vertex split, towards the base. Returns false if the current level already is the
    /// base.
    pub fn coarsen(&mut self) -> bool {
        let Some(&split) = self.splits.splits.get(self.coarsened) else { return false };
        self.swap(self.coarsened, split.kept);
        for &face in &self.splits.removed_faces[self.splits.removed_range(self.coarsened)] {
            self.alive[face.index()] = false;
            self.live_faces -= 1;
        }
        self.coarsened += 1;
        true
    }

    /// Makes the finest level with at most `faces` faces current, or the base if all have more.
    pub fn go_to(&mut self, faces: usize) {
        while self.live_faces > faces && self.coarsen() {}
        while let Some(last) = self.coarsened.checked_sub(1) {
            if self.live_faces + self.splits.removed_range(last).len() > faces {
                return;
            }
            self.refine();
        }
    }

    /// Returns the current level as a mesh, exactly as [`Simplifier::level`] returned it.
    pub fn level(&self) -> Mesh {
        let kept: Vec<u32> =
            (0..self.alive.len() as u32).filter(|&f| self.alive[f as usize]).collect();
        let attributes = self.mesh.attributes.as_ref().map(|all| Attributes {
            corners: kept.iter().map(|&f| all.corners[f as usize]).collect(),
            ..all.clone()
        });
        let mut level = Mesh {
            positions: self.mesh.positions.clone(),
            faces: kept.iter().map(|&f| self.mesh.faces[f as usize]).collect(),
            attributes,
            materials: self.mesh.materials.as_ref().map(|labels| labels.select(&kept)),
            objects: self.mesh.objects.as_ref().map(|labels| labels.select(&kept)),
            face_layers: self.mesh.select_face_layers(&kept),
        };
        level.compact();
        level
    }

    /// Swaps the values that a split changes with its record, and moves its corners to `vertex`.
    fn swap(&mut self, index: usize, vertex: VertexId) {
        let splits = &mut self.splits;
        let moved = splits.moved_range(index);
        let (blended, forward) = (splits.blended_range(index), vertex == splits.splits[index].kept);
        let split = &mut splits.splits[index];
        std::mem::swap(&mut self.mesh.positions[split.kept.index()], &mut split.position);
        for &corner in &splits.moved[moved.clone()] {
            self.mesh.faces[corner.face().index()][corner.slot()] = vertex;
        }
        let Some(attributes) = &mut self.mesh.attributes else { return };
        for (&corner, wedge) in splits.moved[moved.clone()].iter().zip(&mut splits.wedges[moved]) {
            std::mem::swap(&mut attributes.corners[corner.face().index()][corner.slot()], wedge);
        }
        // A wedge that occurs twice gets back its first value last.
        let places = (0..blended.len()).map(|i| if forward { i } else { blended.len() - 1 - i });
        let width: usize = attributes.layers.iter().map(|layer| layer.width).sum();
        for place in places.map(|i| blended.start + i) {
            let wedge = splits.blended[place];
            let mut values = &mut splits.values[place * width..][..width];
            for layer in &mut attributes.layers {
                let (these, rest) = values.split_at_mut(layer.width);
                layer.of_mut(wedge).swap_with_slice(these);
                values = rest;
            }
        }
    }
}

impl VertexSplits {
    fn new(history: History, attributes: bool) -> Self {
        let splits = history.contractions().iter().map(|contraction| {
            let kept = usize::from(contraction.kept);
            let [moved, removed_faces, blended] = contraction.starts();
            VertexSplit {
                kept: contraction.contracted[kept],
                removed: contraction.contracted[1 - kept],
                position: contraction.from,
                moved,
                removed_faces,
                blended: if attributes { blended } else { 0 },
            }
        });
        let mut this = Self { splits: splits.collect(), ..Self::default() };
        let lists = history.into_lists();
        this.moved = lists.moved.iter().map(|moved| moved.corner).collect();
        this.removed_faces = lists.removed_faces;
        if attributes {
            this.wedges = lists.moved.iter().map(|moved| moved.wedge).collect();
            (this.blended, this.values) = (lists.blended, lists.values);
        }
        this
    }

    fn range(
        &self,
        index: usize,
        start: impl Fn(&VertexSplit) -> u32,
        end: usize,
    ) -> std::ops::Range<usize> {
        let next = self.splits.get(index + 1).map_or(end, |next| start(next) as usize);
        start(&self.splits[index]) as usize..next
    }

    fn moved_range(&self, index: usize) -> std::ops::Range<usize> {
        self.range(index, |split| split.moved, self.moved.len())
    }

    fn removed_range(&self, index: usize) -> std::ops::Range<usize> {
        self.range(index, |split| split.removed_faces, self.removed_faces.len())
    }

    fn blended_range(&self, index: usize) -> std::ops::Range<usize> {
        self.range(index, |split| split.blended, self.blended.len())
    }
}

/// Collects the whole state of the surface, including removed elements.
fn workspace(mesh: &Mesh, surface: &Surface) -> Mesh {
    let all: Vec<u32> = (0..mesh.faces.len() as u32).collect();
    let wedges = mesh.attributes.as_ref().and(surface.wedges.as_ref());
    Mesh {
        positions: (0..mesh.positions.len())
            .map(|v| surface.position(VertexId::new(v)).into())
            .collect(),
        faces: all.iter().map(|&f| surface.face(FaceId(f))).collect(),
        attributes: wedges.map(|wedges| wedges.select(&all)),
        materials: mesh.materials.clone(),
        objects: mesh.objects.clone(),
        face_layers: mesh.face_layers.clone(),
    }
}

#[cfg(test)]
mod tests;
