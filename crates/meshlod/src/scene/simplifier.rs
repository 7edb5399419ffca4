//! Simplification of a scene: all its meshes share one target number of faces or error bound.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use meshlod_io::Scene;
use meshlod_mesh::Mesh;
use meshlod_simplify::{
    Contractions, ErrorProof, HandleCounts, Held, Method, Observe, Refusals, Report, Simplifier,
    SimplifyError, Target, VolumeLoss,
};
use thiserror::Error;

use crate::bounded::{Tightness, run_within};
use crate::scene::ConditionedScene;
use crate::scene::place;

/// Part of the scene's diagonal, one in this many, by which a mesh near its limit must have moved to be
/// worth a note.
const WORTH_A_NOTE: f64 = 25.0;

/// Simplifies all meshes of a scene to one common target, always contracting where it costs least
/// in world space.
///
/// Everything is counted and measured as the scene shows it: the faces of a mesh that three nodes
/// show count three times, and errors are in world units, by the largest length scale of its nodes.
/// Meshes that no node shows, and those without a face to contract, stay as they are.
///
/// Levels taken from one run are nested. For a scene with one mesh and no transform this is
/// [`Simplifier`], on the conditioned mesh.
pub struct SceneSimplifier<'s> {
    conditioned: &'s ConditionedScene<'s>,
    scene: &'s Scene,
    method: Method,
    parts: Vec<Part<'s>>,
    /// Number of shown faces in meshes that stay as they are.
    still_faces: usize,
}

/// A mesh that is simplified.
struct Part<'s> {
    mesh: usize,
    /// Number of nodes that show it.
    copies: usize,
    /// World units per unit of the mesh, in its largest instance.
    scale: f64,
    /// Costs in world space per cost in the space of the mesh.
    cost_scale: f64,
    /// Option `vanish_below`, in units of the mesh.
    vanish_below: Option<f64>,
    simplifier: Simplifier<'s>,
    /// Proof of the distance from the mesh, if the last target was an error.
    proof: Option<ErrorProof>,
    /// True if all targets so far were errors, so that a run may be repeated.
    is_bounded: bool,
}

/// Reason why the meshes of a scene cannot be simplified.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SceneError {
    /// The scene has no node that shows a mesh.
    #[error("nodes: none of them shows a mesh")]
    Nothing,
    /// An option or target is invalid, or the only mesh of the scene is.
    #[error(transparent)]
    Whole(#[from] SimplifyError),
    /// One of several meshes is invalid.
    #[error("mesh {mesh}{}: {source}", in_brackets(name))]
    Mesh {
        /// Index of the mesh in the scene.
        mesh: usize,
        /// Name of the mesh in the scene.
        name: String,
        /// Reason why the mesh cannot be simplified.
        source: SimplifyError,
    },
}

impl<'s> SceneSimplifier<'s> {
    /// Prepares every mesh that the scene shows for simplification, without simplifying yet.
    ///
    /// The option `vanish_below` is in world units; no mesh vanishes completely.
    ///
    /// Cost: O(n log n), n = faces.
    /// # Errors
    /// An invalid mesh or option, or no mesh with a face to contract.
    pub fn new(conditioned: &'s ConditionedScene<'s>) -> Result<Self, SceneError> {
        let scene = conditioned.scene;
        let method = conditioned.options.method;
        let mut this = Self { conditioned, scene, method, parts: Vec::new(), still_faces: 0 };
        let mut still = None;
        let sizes = place::sizes(scene);
        for (index, (&copies, scale)) in conditioned.copies.iter().zip(sizes).enumerate() {
            if copies == 0 {
                continue;
            }
            // A mesh scaled to a point is smaller than any size.
            let vanish_below = conditioned.options.vanish_below.map(|size| size / scale);
            let vanish_below = vanish_below.map(|size| if size.is_nan() { 0.0 } else { size });
            match conditioned.meshes[index].simplifier(vanish_below) {
                Ok(simplifier) => {
                    let cost_scale = scale.powi(method.cost_power());
                    let (mesh, proof) = (index, None);
                    this.parts.push(Part {
                        mesh,
                        copies,
                        scale,
                        cost_scale,
                        vanish_below,
                        simplifier,
                        proof,
                        is_bounded: true,
                    });
                }
                Err(error @ (SimplifyError::NoFaces | SimplifyError::AllDegenerate(_))) => {
                    this.still_faces += copies * scene.meshes[index].mesh.faces.len();
                    still.get_or_insert(error);
                }
                Err(source) => return Err(this.error_of(index, source)),
            }
        }
        match (this.parts.is_empty(), still) {
            (true, reason) => Err(reason.map_or(SceneError::Nothing, SceneError::Whole)),
            _ => Ok(this),
        }
    }

    /// Contracts edges and faces of all meshes until the target is reached or no contraction is
    /// allowed any more.
    ///
    /// A number of faces is shared: the next contraction is the cheapest of all meshes in world
    /// space. Observers see the ids of conditioned meshes.
    ///
    /// An error bound holds for each mesh by itself, in both directions, at the largest size at
    /// which a node shows it, so it holds for the whole scene in world space. It is
    /// [proved](Report::proof), whatever the method, unless the observer wants to see contractions:
    /// then it is what the method [makes of it](Target::Error). Where the proof fails at first,
    /// contractions are taken back or the run is repeated, so such a level need not be nested in an
    /// earlier one. After a target of another kind neither is done: the proof then says what holds.
    ///
    /// # Errors
    /// An invalid target.
    pub fn run(
        &mut self,
        target: Target,
        observer: &mut dyn Observe,
    ) -> Result<Report, SimplifyError> {
        let budget = match target.valid()? {
            Target::Error(error) => return self.run_within(error, observer),
            target => target.faces_of(self.input_faces()),
        };
        let others = self.still_faces;
        self.parts.iter_mut().for_each(|part| (part.proof, part.is_bounded) = (None, false));
        match &mut self.parts[..] {
            [only] => {
                let faces = budget.saturating_sub(others) / only.copies;
                only.simplifier.run(Target::Faces(faces), observer)?;
            }
            _ => self.share(budget, observer),
        }
        let report = self.report()?;
        Ok(Report { reached: report.output_faces <= budget, ..report })
    }

    /// Returns the number of faces that the scene currently shows, counting every instance.
    pub fn live_faces(&self) -> usize {
        let of = |part: &Part<'_>| part.copies * part.simplifier.live_faces();
        self.still_faces + self.parts.iter().map(of).sum::<usize>()
    }

    /// Returns the number of faces that the scene showed before simplification, counting every
    /// instance.
    pub fn input_faces(&self) -> usize {
        let of = |part: &Part<'_>| part.copies * self.scene.meshes[part.mesh].mesh.faces.len();
        self.still_faces + self.parts.iter().map(of).sum::<usize>()
    }

    /// Returns all meshes of the scene as simplified so far, in the order of the scene, each
    /// [settled](Simplifier::settled_level).
    pub fn level(&self) -> Vec<Mesh> {
        self.settled_level(&mut VolumeLoss::default())
    }

    /// Returns [the level](Self::level), and sets [`VolumeLoss::repaid`] of `loss`, the volume of
    /// the run's report, to what its instances have been repaid in world space.
    pub fn settled_level(&self, loss: &mut VolumeLoss) -> Vec<Mesh> {
        loss.repaid = 0.0;
        let mut instances = self.scene.instances();
        instances.sort_by_key(|place| place.mesh);
        let mut parts = self.parts.iter().peekable();
        let meshes = self.scene.meshes.iter().enumerate();
        let settled = meshes.map(|(index, mesh)| {
            let Some(part) = parts.next_if(|part| part.mesh == index) else {
                return mesh.mesh.clone();
            };
            let mut own = VolumeLoss::default();
            let level = self.conditioned.meshes[index].settled_level(&part.simplifier, &mut own);
            if own.repaid != 0.0 {
                let first = instances.partition_point(|place| place.mesh < index);
                let placed = instances[first..].iter().take_while(|place| place.mesh == index);
                placed.for_each(|place| loss.add(&own, &place.transform));
            }
            level
        });
        settled.collect()
    }

    fn run_within(
        &mut self,
        error: f64,
        observer: &mut dyn Observe,
    ) -> Result<Report, SimplifyError> {
        for part in &mut self.parts {
            let own = error / part.scale;
            // A mesh scaled to a point may lose anything.
            let own = if own.is_nan() { f64::INFINITY } else { own };
            let mesh = &self.conditioned.meshes[part.mesh];
            let again = part.is_bounded.then_some((mesh, part.vanish_below));
            let errors = [own, mesh.moved()];
            let report =
                run_within(again, &mut part.simplifier, (errors, Tightness::FULL), observer)?;
            part.proof = report.proof;
        }
        let report = self.report()?;
        let proof = self.proof(error);
        Ok(Report { reached: proof.is_none_or(|proof| proof.proved <= error), proof, ..report })
    }

    /// Returns what is proved of the distance from the scene, in world units.
    fn proof(&self, asked: f64) -> Option<ErrorProof> {
        let mut whole = ErrorProof { asked, proved: 0.0, rounds: 0 };
        for part in &self.parts {
            let own = part.proof?;
            let proved = if own.proved <= own.asked { asked } else { part.scale * own.proved };
            whole.proved = whole.proved.max(proved);
            whole.rounds += own.rounds;
        }
        Some(whole)
    }

    /// Contracts in the mesh with the cheapest next contraction until `budget` faces are shown.
    fn share(&mut self, budget: usize, observer: &mut dyn Observe) {
        let next = |(i, part): (usize, &mut Part<'_>)| Some(Next::new(part.next_cost()?, i));
        let mut queue: BinaryHeap<Next> =
            self.parts.iter_mut().enumerate().filter_map(next).collect();
        let mut faces = self.live_faces();
        while faces > budget {
            let Some(cheapest) = queue.pop() else { return };
            let most = queue.peek().map_or(f64::INFINITY, |&other| cheapest.up_to(other));
            let part = &mut self.parts[cheapest.part()];
            let most_cost = part.cost_up_to(most);
            while faces > budget {
                let before = part.simplifier.live_faces();
                if !part.simplifier.step(most_cost, observer) {
                    break;
                }
                faces -= part.copies * (before - part.simplifier.live_faces());
            }
            queue.extend(part.next_cost().map(|cost| Next::new(cost, cheapest.part())));
        }
    }

    /// Returns the report so far, summed over the meshes; error targets count as reached.
    fn report(&mut self) -> Result<Report, SimplifyError> {
        let mut whole = Report {
            method: self.method,
            input_faces: self.input_faces(),
            degenerate_faces: 0,
            duplicate_faces: 0,
            non_manifold_vertices: 0,
            held: Held::default(),
            output_faces: self.live_faces(),
            contractions: Contractions::default(),
            vanished: 0,
            handles: None,
            reached: true,
            error_estimate: 0.0,
            near_limit: false,
            proof: None,
            refusals: Refusals::default(),
            volume: VolumeLoss::default(),
        };
        let mut places = self.scene.instances();
        places.sort_by_key(|place| place.mesh);
        let mut places = places.into_iter().peekable();
        for part in &mut self.parts {
            // A run to the current number of faces does nothing and returns the report.
            let here = Target::Faces(part.simplifier.live_faces());
            let report = part.simplifier.run(here, &mut ())?;
            whole.degenerate_faces += part.copies * report.degenerate_faces;
            let left_out = self.conditioned.meshes[part.mesh].counts().duplicate_faces;
            whole.duplicate_faces += part.copies * (report.duplicate_faces + left_out);
            whole.non_manifold_vertices += part.copies * report.non_manifold_vertices;
            whole.vanished += part.copies * report.vanished;
            if let Some(HandleCounts { before, closed }) = report.handles {
                let [before, closed] = [before, closed].map(|count| part.copies * count);
                *whole.handles.get_or_insert_default() += HandleCounts { before, closed };
            }
            whole.held.add(&report.held, part.copies);
            whole.error_estimate = whole.error_estimate.max(part.scale * report.error_estimate);
            if report.near_limit && !part.is_bounded {
                let far = part.scale * report.error_estimate;
                whole.near_limit |= WORTH_A_NOTE * far > place::world_bounds(self.scene).diagonal();
            }
            whole.contractions += report.contractions;
            whole.refusals += report.refusals;
            // Parts are in the order of their meshes; other meshes have nothing to contract.
            while let Some(place) = places.next_if(|place| place.mesh <= part.mesh) {
                if place.mesh == part.mesh {
                    whole.volume.add(&report.volume, &place.transform);
                }
            }
        }
        Ok(whole)
    }

    fn error_of(&self, mesh: usize, source: SimplifyError) -> SceneError {
        match &self.scene.meshes[..] {
            [_] => SceneError::Whole(source),
            all => SceneError::Mesh { mesh, name: all[mesh].name.clone(), source },
        }
    }
}

impl Part<'_> {
    /// Returns the cost of the next contraction in world space.
    fn next_cost(&mut self) -> Option<f64> {
        self.simplifier.next_cost().map(|cost| cost * self.cost_scale)
    }

    /// Converts a cost in world space to the space of the mesh; at least the cost of the next
    /// contraction, however the division rounds, so that there is always one to try.
    fn cost_up_to(&mut self, world: f64) -> f64 {
        let own = self.simplifier.next_cost().unwrap_or(0.0);
        own.max(world / self.cost_scale)
    }
}

/// The cost of the next contraction of a mesh, in an order as `f64::total_cmp` has it, and the
/// number of the mesh. The greatest is the cheapest, and of equal ones that of the first mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Next(Reverse<(i64, usize)>);

impl Next {
    fn new(cost: f64, part: usize) -> Self {
        Self(Reverse((in_order(cost.to_bits() as i64), part)))
    }

    fn part(self) -> usize {
        let Self(Reverse((_, part))) = self;
        part
    }

    /// Returns how far the cost may rise before the other is cheaper: an interrupted run then
    /// continues as if it had not been interrupted.
    fn up_to(self, other: Self) -> f64 {
        let Self(Reverse((order, part))) = other;
        let cost = f64::from_bits(in_order(order) as u64);
        if part < self.part() { cost.next_down() } else { cost }
    }
}

/// Turns the bits of a number into an integer that compares as `f64::total_cmp` does, and back.
fn in_order(bits: i64) -> i64 {
    bits ^ (((bits >> 63) as u64) >> 1) as i64
}

fn in_brackets(name: &str) -> String {
    if name.is_empty() { String::new() } else { format!(" ({name})") }
}

#[cfg(test)]
mod tests;
