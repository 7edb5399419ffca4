//! The merge tree: the vertex that each one merges into, and when.

use meshlod_mesh::{Mesh, VertexId};
use meshlod_simplify::{History, Method, Options, Simplifier, SimplifyError, Target, Topology};
use thiserror::Error;

use super::pointers::Pointers;
use crate::verify::{has_three_corners, lowest_first};

/// A mesh and the sequence of its half-edge contractions; each level is the mesh after some of
/// them.
///
/// Points never move, so every vertex of a level is a vertex of the mesh and one vertex buffer
/// serves all levels. Degenerate faces and duplicates are left out.
/// # References
/// [KY05], the merge tree.
#[derive(Clone, Debug)]
pub struct MergeTree {
    faces: Vec<[VertexId; 3]>,
    /// Vertex that each vertex merges into.
    parents: Vec<VertexId>,
    /// Contraction at which each vertex vanishes, or [`STAYS`].
    turns: Vec<u32>,
    /// Number of faces left after 0, 1, 2, … contractions.
    faces_left: Vec<u32>,
    /// Rising numbers of contractions after which tied vertices are apart, because only some of
    /// those that move them together have been made.
    torn: Vec<u32>,
}

/// Rank of a vertex that never vanishes.
const STAYS: u32 = u32::MAX;

/// Reason why a merge tree cannot be built from a recorded simplification.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum HistoryError {
    /// A contraction moves a vertex instead of merging it into the other end of its edge.
    #[error(
        "contraction {0} moves a point; strips need half-edge contractions, for example by qem-endpoint"
    )]
    Moves(usize),
    /// A contraction does not fit the mesh: the history is of another mesh, or a component
    /// vanished.
    #[error(
        "contraction {0} does not fit this mesh; record this mesh, without letting components vanish"
    )]
    Foreign(usize),
}

impl MergeTree {
    /// Creates the merge tree of a mesh without any contractions.
    ///
    /// Cost: O(n log n).
    pub fn new(mesh: &Mesh) -> Self {
        let faces = whole_faces(&mesh.faces);
        let vertices = mesh.positions.len();
        Self {
            parents: (0..vertices).map(VertexId::new).collect(),
            turns: vec![STAYS; vertices],
            faces_left: vec![faces.len() as u32],
            faces,
            torn: Vec::new(),
        }
    }

    /// Simplifies a mesh to a target by half-edge contractions (`qem-endpoint`) and records them in
    /// a merge tree. The topology of the mesh is kept, [`Topology::Keep`].
    /// # Errors
    /// If simplification refuses the mesh or the target.
    pub fn record(mesh: &Mesh, target: Target) -> Result<Self, SimplifyError> {
        Self::record_with(mesh, target, &Options::default())
    }

    /// Simplifies a mesh as [`MergeTree::record`] does, with the locks, ties and weights of some
    /// options; the method and the topology stay.
    ///
    /// [`MergeTree::contractions_to`] then gives levels whose tied vertices are together.
    /// # Errors
    /// If simplification refuses the mesh, the target or the locks.
    pub fn record_with(
        mesh: &Mesh,
        target: Target,
        options: &Options,
    ) -> Result<Self, SimplifyError> {
        let options = Self::options(options);
        let mut simplifier = Simplifier::new(mesh, &options)?;
        let (mut history, mut torn) = (History::default(), Vec::new());
        if options.locks.ties.is_empty() {
            simplifier.run(target, &mut history)?;
        } else {
            // A step makes the contractions of tied edges together.
            let mut before = 0;
            while simplifier.step_to(target, &mut history)? {
                let made = history.contractions().len() as u32;
                torn.extend(before + 1..made);
                before = made;
            }
        }
        let tree = Self::from_history(mesh, &history).expect("just recorded from this mesh");
        Ok(Self { torn, ..tree })
    }

    /// Returns options by which [`MergeTree::record_with`] simplifies: those given, with the method
    /// and the topology that strips need.
    pub fn options(options: &Options) -> Options {
        let (method, topology) = (Method::QemEndpoint, Topology::Keep);
        Options { method, topology, vanish_below: None, ..options.clone() }
    }

    /// Builds the merge tree of a mesh from the recorded history of its simplification.
    ///
    /// Cost: linear, apart from sorting the mesh's faces.
    /// # Errors
    /// If the history moves points or is of another mesh.
    pub fn from_history(mesh: &Mesh, history: &History) -> Result<Self, HistoryError> {
        let mut this = Self::new(mesh);
        let mut pointers = Pointers::new(mesh.positions.len());
        for (turn, contraction) in history.contractions().iter().enumerate() {
            let &[v0, v1] = &contraction.contracted[..] else {
                return Err(HistoryError::Moves(turn));
            };
            let [kept, gone] = if contraction.kept == 0 { [v0, v1] } else { [v1, v0] };
            if contraction.from != contraction.to {
                return Err(HistoryError::Moves(turn));
            }
            let is_new = |v: VertexId| this.turns.get(v.index()) == Some(&STAYS);
            if !is_new(kept) || !is_new(gone) {
                return Err(HistoryError::Foreign(turn));
            }
            let died = history.removed_faces(turn);
            for face in died {
                let corners = mesh.faces.get(face.index()).ok_or(HistoryError::Foreign(turn))?;
                let shown = corners.map(|v| this.shown(v, turn, &mut pointers));
                if !shown.contains(&kept) || !shown.contains(&gone) {
                    return Err(HistoryError::Foreign(turn));
                }
            }
            this.parents[gone.index()] = kept;
            this.turns[gone.index()] = turn as u32;
            let left = this.faces_left[turn].checked_sub(died.len() as u32);
            this.faces_left.push(left.ok_or(HistoryError::Foreign(turn))?);
        }
        Ok(this)
    }

    /// Returns the number of contractions that the merge tree holds.
    pub fn contractions(&self) -> usize {
        self.faces_left.len() - 1
    }

    /// Returns the number of vertices of the full-resolution mesh.
    pub fn vertices(&self) -> usize {
        self.parents.len()
    }

    /// Returns the number of faces left after a given number of contractions, clamped to the
    /// maximum.
    pub fn faces_left(&self, contractions: usize) -> usize {
        self.faces_left[contractions.min(self.contractions())] as usize
    }

    /// Returns the least number of contractions that leaves at most `faces` faces and tied vertices
    /// together, or the number of all contractions if none suffices.
    pub fn contractions_to(&self, faces: usize) -> usize {
        let found = self.faces_left.partition_point(|&left| left as usize > faces);
        let mut found = found.min(self.contractions());
        while self.torn.binary_search(&(found as u32)).is_ok() {
            found += 1;
        }
        found
    }

    /// Returns the faces of the full-resolution mesh.
    pub fn faces(&self) -> &[[VertexId; 3]] {
        &self.faces
    }

    /// Returns the faces of the level after a given number of contractions, by vertices of the
    /// full-resolution mesh.
    ///
    /// Cost: linear.
    pub fn level(&self, contractions: usize) -> Vec<[VertexId; 3]> {
        let mut pointers = Pointers::new(self.vertices());
        let shown =
            self.faces.iter().map(|face| face.map(|v| self.shown(v, contractions, &mut pointers)));
        shown.filter(has_three_corners).collect()
    }

    /// Lists the vertices that vanish, in order.
    pub(super) fn order(&self) -> Vec<VertexId> {
        let mut order = vec![VertexId(0); self.contractions()];
        for (v, &turn) in self.turns.iter().enumerate().filter(|(_, turn)| **turn != STAYS) {
            order[turn as usize] = VertexId::new(v);
        }
        order
    }

    /// Returns the vertex that a vertex merges into, itself if it stays.
    pub(super) fn parent(&self, vertex: VertexId) -> VertexId {
        self.parents[vertex.index()]
    }

    /// Returns the vertex that represents `vertex` after this many contractions.
    #[inline]
    pub(super) fn shown(
        &self,
        vertex: VertexId,
        contractions: usize,
        pointers: &mut Pointers,
    ) -> VertexId {
        let is_gone = |v: VertexId| (self.turns[v.index()] as usize) < contractions;
        pointers.shown(vertex, &self.parents, is_gone)
    }
}

/// Drops degenerate faces and duplicates of earlier ones; keeps the order.
fn whole_faces(faces: &[[VertexId; 3]]) -> Vec<[VertexId; 3]> {
    let whole = faces.iter().filter(|face| has_three_corners(face)).zip(0u32..);
    let mut sorted: Vec<_> = whole.map(|(&face, i)| (lowest_first(face), i, face)).collect();
    sorted.sort_unstable();
    sorted.dedup_by_key(|(corners, ..)| *corners);
    sorted.sort_unstable_by_key(|&(_, i, _)| i);
    sorted.into_iter().map(|(.., face)| face).collect()
}

#[cfg(test)]
mod tests {
    use meshlod_fixtures::{grid, tetrahedron};
    use meshlod_mesh::Locks;
    use meshlod_samples as samples;

    use super::*;
    use crate::strips::Strips;
    use crate::verify::{Difference, difference};

    /// Makes every triangle a strip of its own.
    fn apart(faces: &[[VertexId; 3]]) -> Strips {
        let mut strips = Strips::default();
        faces.iter().for_each(|&face| strips.push(face));
        strips
    }

    #[test]
    fn levels_are_those_of_the_simplification() {
        let mesh = samples::knot(1000);
        let tree = MergeTree::record(&mesh, Target::Faces(0)).unwrap();
        let options = Options { method: Method::QemEndpoint, ..Options::default() };
        let mut simplifier = Simplifier::new(&mesh, &options).unwrap();
        for ratio in [1.0, 0.7, 0.31, 0.1] {
            let report = simplifier.run(Target::Ratio(ratio), &mut ()).unwrap();
            let surface = simplifier.surface();
            let alive = (0..surface.face_count()).map(meshlod_mesh::FaceId::new);
            let alive = alive.filter(|&face| surface.is_alive(face));
            let engine: Vec<_> = alive.map(|face| surface.face(face)).collect();
            let made = tree.contractions_to(Target::Ratio(ratio).faces_of(mesh.faces.len()));
            assert_eq!(tree.faces_left(made), report.output_faces);
            assert_eq!(difference(&apart(&engine), &tree.level(made)), Difference::default());
        }
    }

    #[test]
    fn the_least_contractions_are_found() {
        let tree = MergeTree::record(&grid(6), Target::Faces(0)).unwrap();
        for faces in 0..=72 {
            let made = tree.contractions_to(faces);
            let is_enough = |made| tree.faces_left(made) <= faces;
            assert!(is_enough(made) || made == tree.contractions(), "{faces}");
            assert!(made == 0 || !is_enough(made - 1), "{faces}");
        }
    }

    #[test]
    fn tied_tiles_fit_together_at_every_level() {
        // Two terrains side by side: the second is the mirror image of the first.
        let mut mesh = samples::terrain(800);
        let (vertices, right) = (mesh.positions.len(), mesh.bounds().max[0]);
        let mirrored = mesh.positions.clone();
        mesh.positions.extend(mirrored.iter().map(|&[x, y, z]| [2.0 * right - x, y, z]));
        let other = |face: &[VertexId; 3]| face.map(|v| VertexId::new(vertices + v.index()));
        let faces: Vec<_> = mesh.faces.iter().map(other).map(|[a, b, c]| [a, c, b]).collect();
        mesh.faces.extend(faces);
        let border = (0..vertices).filter(|&v| mesh.positions[v][0] == right);
        let ties: Vec<_> = border.map(|v| [v, vertices + v].map(VertexId::new).to_vec()).collect();
        let locks = Locks { of_vertex: Vec::new(), ties: ties.clone() };
        let options = Options { locks, ..Options::default() };
        let tree = MergeTree::record_with(&mesh, Target::Ratio(0.1), &options).unwrap();
        let is_whole = |made: usize| {
            let shown = |v: VertexId| {
                let mut v = v;
                while tree.turns[v.index()] < made as u32 {
                    v = tree.parents[v.index()];
                }
                mesh.positions[v.index()]
            };
            ties.iter().all(|tie| shown(tie[0]) == shown(tie[1]))
        };
        assert!((0..=mesh.faces.len()).all(|faces| is_whole(tree.contractions_to(faces))));
        assert!(!(0..tree.contractions()).all(is_whole), "ties are contracted");
        assert!(tree.faces_left(tree.contractions()) <= mesh.faces.len() / 10);
    }

    #[test]
    fn an_error_bounds_contractions_with_and_without_ties() {
        let mut mesh = samples::terrain(800);
        // Two vertices far apart at one place.
        let tied = [0, mesh.positions.len() - 1].map(VertexId::new);
        mesh.positions[tied[1].index()] = mesh.positions[tied[0].index()];
        let ties = vec![tied.to_vec()];
        for ties in [Vec::new(), ties] {
            let options =
                Options { locks: Locks { of_vertex: Vec::new(), ties }, ..Options::default() };
            let faces_at = |error| {
                let target = Target::Error(error);
                let tree = MergeTree::record_with(&mesh, target, &options).unwrap();
                tree.faces_left(tree.contractions())
            };
            let [fine, coarse] = [faces_at(1e-3), faces_at(1e-2)];
            assert!(mesh.faces.len() > fine && fine > coarse && coarse > 20, "{fine} {coarse}");
        }
    }

    #[test]
    fn a_history_that_moves_points_is_refused() {
        let mesh = samples::sphere(200);
        let mut history = History::default();
        let mut simplifier = Simplifier::new(&mesh, &Options::default()).unwrap();
        simplifier.run(Target::Ratio(0.5), &mut history).unwrap();
        assert_eq!(MergeTree::from_history(&mesh, &history).err(), Some(HistoryError::Moves(0)));
    }

    #[test]
    fn a_history_of_another_mesh_is_refused() {
        let options = Options { method: Method::QemEndpoint, ..Options::default() };
        let mut history = History::default();
        let mesh = samples::sphere(200);
        let mut simplifier = Simplifier::new(&mesh, &options).unwrap();
        simplifier.run(Target::Ratio(0.5), &mut history).unwrap();
        for other in [samples::torus(200), tetrahedron()] {
            let error = MergeTree::from_history(&other, &history).err();
            assert!(matches!(error, Some(HistoryError::Foreign(_))), "{error:?}");
        }
    }

    #[test]
    fn faces_without_three_corners_and_repeated_ones_are_left_out() {
        let faces = [[0, 1, 2], [1, 2, 0], [3, 3, 1], [2, 1, 0]].map(|f: [u32; 3]| f.map(VertexId));
        let whole: Vec<_> = whole_faces(&faces).iter().map(|f| f.map(|v| v.0)).collect();
        assert_eq!(whole, [[0, 1, 2], [2, 1, 0]]);
    }
}
