//! Comparison of a cut with the finest triangles around a focus, repeated where the cut changes.

use meshlod_measure::{BeyondOptions, FaceBeyond, PreparedSurface, faces_beyond};
use meshlod_mesh::{Bounds, FaceId, Mesh, VertexId};
use meshlod_multires::{Cut, Implicit, Limits, SlotMesh, Surroundings};

/// Part of a limit by which a face that passes may still exceed it, which the limits make up for.
const SLACK: f64 = 0.002;

/// Part of a limit that is left for positions to be rounded in when they are written.
pub(super) const RESERVE: f64 = 1e-3;

/// Divisions allowed for each of the finest triangles. What is undecided when they are used up is
/// refined without need: with four million in all, the dragon had 582,208 faces at .03 %.
const SPLITS_PER_FACE: usize = 256;

/// Surface of a cut, with the nodes of its triangles.
pub(super) struct CutSurface {
    mesh: Mesh,
    nodes: Vec<[u32; 3]>,
    /// Slot of each triangle in the cut.
    slots: Vec<u32>,
}

impl CutSurface {
    pub(super) fn of(cut: &Cut<'_>) -> Self {
        let (slots, nodes) = cut.triangles().unzip();
        Self { mesh: Mesh { attributes: None, ..cut.level().mesh() }, nodes, slots }
    }

    /// Returns the least distance that is allowed in any triangle, in model units; infinite if none
    /// meets the focus.
    pub(super) fn least_limit(&self, limits: &Limits) -> f64 {
        let at = |face: &[VertexId; 3]| face.map(|v| self.mesh.positions[v.index()]);
        let allowed = self.mesh.faces.iter().map(|face| limits.in_triangle(at(face)));
        allowed.fold(f64::INFINITY, f64::min)
    }
}

/// Comparison of a cut with the finest triangles of its model, both ways.
pub(super) struct Check<'c> {
    model: &'c Implicit,
    limits: &'c Limits,
    /// Distance that the file may be off from the original, in model units.
    rounding: f64,
    finest: PreparedSurface<'c>,
    /// Nodes of the finest triangles.
    nodes: &'c [[u32; 3]],
    /// Slots of the cut to compare with the finest triangles; `None` for all.
    changed: Option<Vec<u32>>,
    /// Finest triangles to compare with the cut; `None` for all.
    suspects: Option<Vec<FaceId>>,
}

impl<'c> Check<'c> {
    /// Prepares the comparison with the finest triangles around a focus; `None` if they have no
    /// area.
    pub(super) fn new(
        finest: &'c CutSurface,
        near: &'c Surroundings,
        rounding: f64,
    ) -> Option<Self> {
        Some(Self {
            model: &near.model,
            limits: &near.limits,
            rounding,
            finest: PreparedSurface::new(&finest.mesh).ok()?,
            nodes: &finest.nodes,
            changed: None,
            suspects: None,
        })
    }

    /// Refines a cut where it is farther from the finest triangles than allowed, or they from it.
    /// Returns the number of splits, 0 if nothing is beyond.
    ///
    /// Call it with the same cut until it returns 0. Only what the last refinement may have changed
    /// is compared again.
    pub(super) fn refine(&mut self, cut: &mut Cut<'_>) -> usize {
        let surface = CutSurface::of(cut);
        let Ok(shown) = PreparedSurface::new(&surface.mesh) else {
            // A cut without area is compared with nothing.
            return cut.refine_all_around(self.limits);
        };
        let allowed = |corners: [[f64; 3]; 3]| {
            let most = self.limits.in_triangle(corners);
            (most * (1.0 - RESERVE) - self.rounding) / (1.0 + SLACK)
        };
        let beyond = |from: &PreparedSurface<'_>, to: &PreparedSurface<'_>, faces: &[FaceId]| {
            let least = BeyondOptions::default().most_splits;
            let most_splits = least.max(SPLITS_PER_FACE.saturating_mul(self.nodes.len()));
            let options = BeyondOptions { slack: SLACK, most_splits, faces: Some(faces) };
            faces_beyond(from, to, &allowed, &options).faces
        };
        let there = beyond(&shown, &self.finest, &self.to_compare(&surface));
        let back = beyond(&self.finest, &shown, &self.to_compare_back(cut));
        let coarse = there.iter().map(|found| surface.nodes[found.face.index()]);
        let under = back.iter().map(|found| self.responsible(found, &surface));
        let splits = cut.refine_at(coarse.chain(under));
        self.note_changes(cut, &back);
        match splits {
            0 if !there.is_empty() || !back.is_empty() => cut.refine_all_around(self.limits),
            splits => splits,
        }
    }

    /// Returns the triangles of the cut to compare, neighbours side by side. Those of the finest mesh
    /// are in it.
    fn to_compare(&self, surface: &CutSurface) -> Vec<FaceId> {
        let is_changed = |slot: &u32| {
            self.changed.as_ref().is_none_or(|changed| changed.binary_search(slot).is_ok())
        };
        let faces = (0..surface.nodes.len()).filter(|&face| {
            is_changed(&surface.slots[face]) && !self.is_finest(&surface.nodes[face])
        });
        let mut faces: Vec<FaceId> = faces.map(FaceId::new).collect();
        // Nodes are numbered depth first.
        faces.sort_by_key(|face| surface.nodes[face.index()]);
        faces
    }

    /// Returns the finest triangles to compare; those that the cut shows are in it.
    fn to_compare_back(&self, cut: &Cut<'_>) -> Vec<FaceId> {
        let all = self.finest.bvh().faces_in_leaf_order();
        let faces = self.suspects.as_deref().unwrap_or(all).iter().copied();
        let is_shown = |face: &FaceId| self.nodes[face.index()].iter().all(|&n| cut.shows(n));
        faces.filter(|face| !is_shown(face)).collect()
    }

    fn is_finest(&self, triangle: &[u32; 3]) -> bool {
        triangle.iter().all(|&node| self.model.children_of(node).is_none())
    }

    /// Returns the triangle of the cut that is to be refined for a finest one: the one closest to its
    /// worst point, or if that is as fine as can be, the one that shows it.
    fn responsible(&self, found: &FaceBeyond, surface: &CutSurface) -> [u32; 3] {
        let closest = surface.nodes[found.place.face.index()];
        if self.is_finest(&closest) { self.nodes[found.face.index()] } else { closest }
    }

    /// Notes what to compare next: the new triangles of a cut, the finest ones that were beyond, and
    /// those that may have been within the limit of a triangle that is gone.
    fn note_changes(&mut self, cut: &Cut<'_>, beyond: &[FaceBeyond]) {
        let mut is_suspect = vec![false; self.nodes.len()];
        beyond.iter().for_each(|found| is_suspect[found.face.index()] = true);
        let mut changed = Vec::new();
        for patch in cut.patches() {
            if patch.new.is_some() {
                changed.push(patch.slot);
            }
            let Some(gone) = patch.old else { continue };
            let Bounds { min, max } = Bounds::of(&gone.map(|node| self.model.position(node)));
            let middle = [0, 1, 2].map(|k| 0.5 * (min[k] + max[k]));
            let radius = 0.5 * Bounds { min, max }.diagonal();
            let reach = (1.0 + 2.0 * SLACK) * self.limits.reach(middle, radius);
            let around = [min.map(|x| x - reach), max.map(|x| x + reach)];
            self.finest.bvh().faces_near_box(around, |face| is_suspect[face.index()] = true);
        }
        changed.sort_unstable();
        self.changed = Some(changed);
        let all = self.finest.bvh().faces_in_leaf_order().iter().copied();
        self.suspects = Some(all.filter(|face| is_suspect[face.index()]).collect());
    }
}
