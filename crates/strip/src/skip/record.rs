//! Recording of a simplification as a merge tree.

use meshlod_mesh::{Mesh, VertexId};
use meshlod_simplify::{
    History, Method, Observe, Options, Simplifier, SimplifyError, Target, Topology,
};
use thiserror::Error;

use super::pointers::Pointers;
use super::record_wedges::WedgeRecorder;
use super::tree::{MergeTree, STAYS};
use super::wedges::MeshWedges;

/// Reason why a merge tree cannot be built from a recorded simplification.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
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
        let Some(wedges) = MeshWedges::new(mesh) else {
            let mut history = History::default();
            let made = |history: &History| history.contractions().len();
            let torn = run(&mut simplifier, target, &options, &mut history, made)?;
            let tree = Self::from_history(mesh, &history).expect("just recorded from this mesh");
            return Ok(Self { torn, ..tree });
        };
        let mut recorder = WedgeRecorder::new(mesh, wedges, simplifier.surface());
        let made = |recorder: &WedgeRecorder| recorder.tree.contractions();
        let torn = run(&mut simplifier, target, &options, &mut recorder, made)?;
        Ok(Self { torn, ..recorder.tree })
    }

    /// Returns options by which [`MergeTree::record_with`] simplifies: those given, with the method
    /// and the topology that strips need.
    pub fn options(options: &Options) -> Options {
        let (method, topology) = (Method::QemEndpoint, Topology::Keep);
        Options { method, topology, vanish_below: None, ..options.clone() }
    }

    /// Builds the merge tree of a mesh's vertices, without attributes, from the recorded history of
    /// its simplification.
    ///
    /// Cost: linear, apart from sorting the mesh's faces.
    /// # Errors
    /// If the history moves points or is of another mesh.
    pub fn from_history(mesh: &Mesh, history: &History) -> Result<Self, HistoryError> {
        let mut this = Self::of_vertices(mesh);
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
}

/// Simplifies to a target in view of an observer that knows how many contractions were `made`.
/// Returns the numbers of contractions after which tied vertices are apart.
fn run<O: Observe>(
    simplifier: &mut Simplifier<'_>,
    target: Target,
    options: &Options,
    observer: &mut O,
    made: impl Fn(&O) -> usize,
) -> Result<Vec<u32>, SimplifyError> {
    if options.locks.ties.is_empty() {
        simplifier.run(target, observer)?;
        return Ok(Vec::new());
    }
    let (mut torn, mut before) = (Vec::new(), 0);
    // A step makes the contractions of tied edges together.
    while simplifier.step_to(target, observer)? {
        let now = made(observer) as u32;
        torn.extend(before + 1..now);
        before = now;
    }
    Ok(torn)
}
