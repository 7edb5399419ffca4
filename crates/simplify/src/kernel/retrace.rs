//! Contractions taken back where the level has turned out to be too far from the input.
//!
//! The bound on the error is probed at points, so a face in a thousand may be farther away between
//! them. A fresh run then repeats all contractions but those that made such faces, and those after
//! them whose rings differ because of that. There it goes on with a lower bound. Elsewhere nothing
//! changes, to the bit: other places cannot become worse.

use std::cell::OnceCell;

use crate::kernel::attributes::AttributeModel;
use crate::kernel::bound::input_surface::InputSurface;
use crate::kernel::collapse::Collapse;
use crate::kernel::collapse_loop::CollapseLoop;
use crate::kernel::components::Components;
use crate::kernel::contraction_log::{Logged, LoggedContraction};
use crate::kernel::mesh::one_ring::GHOST;
use crate::kernel::mesh::vertex::{NO_VERTEX, VertexFlags};
use crate::kernel::metric::Metric;
use crate::kernel::schedule::bucket_queue::{BucketQueue, NONE};
use crate::kernel::schedule::deferral::Deferral;
use crate::refusal::Refusals;

/// Safety factor on the lowered bound, since the new contraction may err elsewhere.
const CAUTION: f32 = 0.98;

/// Largest factor by which a bound is lowered where it was not held. Ten times too far away is no
/// want of precision: a face lies over a hole, say. Nothing moves there again.
const MOST_FACTOR: f32 = 0.97;

/// Factor by which a bound is lowered further where it was not held again.
const AGAIN: f32 = 0.7;

/// Fraction of the bound below which a lowered bound becomes zero, so that lowering ends.
const LEAST_PART: f32 = 0.1;

/// Step that stands for none.
const NO_STEP: u32 = u32::MAX;

/// The contractions of a run, and which of them to take back.
pub(crate) struct Retrace {
    pub(crate) steps: Vec<Logged>,
    /// Steps to take back, with all that depends on them; sorted.
    pub(crate) back: Vec<u32>,
    /// Fraction of the error bound that holds at each vertex from now on.
    pub(crate) parts: Vec<f32>,
    pub(crate) refusals: Refusals,
    pub(crate) deferral: Deferral,
    /// Smallest error bound that has refused an edge.
    pub(crate) refused_above: f64,
    /// Error bound that was not held, in model units.
    pub(crate) error: f64,
    /// The surface that distances are measured from.
    pub(crate) input: OnceCell<InputSurface>,
}

/// Corners of a face in the kernel's live vertices, with the ratio by which it is too far away.
pub(crate) type FarFace = ([u32; 3], f64);

impl Retrace {
    /// Chooses the steps to take back: the last one at a corner of each face that is too far away.
    /// Lowers the bound at its vertices and at those of the face.
    ///
    /// Returns `None` if no step is at any of the faces.
    pub(crate) fn new(
        steps: Vec<Logged>,
        far: &[FarFace],
        (components, parts): (Option<&Components>, &[f32]),
        vertices: usize,
    ) -> Option<Self> {
        let last = last_steps(&steps, components, vertices);
        let old = |v: u32| parts.get(v as usize).copied().unwrap_or(1.0);
        let mut parts = (0..vertices as u32).map(old).collect::<Vec<f32>>();
        let before = parts.clone();
        let mut back = Vec::new();
        for (corners, ratio) in far {
            let at = corners.iter().map(|&v| last[v as usize]).filter(|&step| step != NO_STEP);
            let Some(step) = at.max() else { continue };
            back.push(step);
            let own = match &steps[step as usize] {
                Logged::Contraction(done) => vec![done.kept, done.gone],
                Logged::Vanished(component) => {
                    components.map_or(Vec::new(), |all| all.vertices(*component).to_vec())
                }
            };
            let all = || own.iter().chain(corners);
            let least = all().map(|&v| before[v as usize]).fold(1.0, f32::min);
            let factor = (CAUTION / *ratio as f32).min(MOST_FACTOR);
            let lower = if least < 1.0 { least * factor.min(AGAIN) } else { factor };
            let lower = if lower < LEAST_PART { 0.0 } else { lower };
            all().for_each(|&v| parts[v as usize] = parts[v as usize].min(lower));
        }
        back.sort_unstable();
        back.dedup();
        (!back.is_empty()).then(|| Self {
            steps,
            back,
            parts,
            refusals: Refusals::default(),
            deferral: Deferral::default(),
            refused_above: f64::INFINITY,
            error: f64::INFINITY,
            input: OnceCell::new(),
        })
    }
}

/// Returns for each vertex the last step that moved it or took it away.
fn last_steps(steps: &[Logged], components: Option<&Components>, vertices: usize) -> Vec<u32> {
    let mut last = vec![NO_STEP; vertices];
    for (number, step) in (0..).zip(steps) {
        match step {
            Logged::Contraction(done) => last[done.kept as usize] = number,
            Logged::Vanished(component) => {
                let vertices = components.map_or(&[][..], |all| all.vertices(*component));
                vertices.iter().for_each(|&v| last[v as usize] = number);
            }
        }
    }
    last
}

impl<A: AttributeModel> CollapseLoop<'_, A> {
    /// Repeats the steps of another run on the unchanged surface, which must be one part, without
    /// those that are taken back. Then only vertices whose rings differ from that run are queued.
    pub(crate) fn retrace(&mut self, Retrace { steps, back, .. }: &Retrace) {
        // The run that is repeated was one within an error.
        self.hold_seams();
        let mut differs = vec![false; self.vertices.all.len()];
        let mut back = back.iter().copied().peekable();
        for (number, step) in (0..).zip(steps) {
            let is_back = back.next_if_eq(&number).is_some();
            match step {
                Logged::Contraction(done) => {
                    let ends = [done.kept, done.gone];
                    let is_same = !is_back && ends.iter().all(|&v| !differs[v as usize]);
                    if !(is_same && self.repeat(done)) {
                        self.mark_around(&ends, &mut differs);
                    }
                }
                Logged::Vanished(component) => {
                    self.repeat_vanishing(*component, is_back, &mut differs)
                }
            }
        }
        self.queue_only(&differs);
    }

    /// Repeats a contraction. Returns false, with nothing changed, if that is not possible.
    fn repeat(&mut self, done: &LoggedContraction) -> bool {
        let Self { vertices, model, edge_ring, .. } = self;
        let [v0, v1] = [done.kept, done.gone];
        let Ok(mut ends) = model.orient(vertices, v0, v1) else { return false };
        if ends.v0 != v0 {
            match model.orient(vertices, v1, v0) {
                Ok(other) if other.v0 == v0 => ends = other,
                _ => return false,
            }
        }
        if edge_ring.gather(vertices, v0, v1).is_err() {
            return false;
        }
        let (end0, end1) = (vertices.get(v0), vertices.get(v1));
        let displacement = done.place - end0.place();
        let quadric = A::Metric::edge_quadric(edge_ring, end0, end1);
        if edge_ring.try_place(displacement).is_err() {
            return false;
        }
        let from_middle = displacement.as_dvec3() - quadric.half;
        let collapse =
            Collapse { ends, half: quadric.half, from_middle, place: done.place, displacement };
        model.preview(vertices, edge_ring, &collapse);
        self.commit(&collapse, &quadric, done.moved, done.front);
        true
    }

    /// Removes a component as before, unless that is taken back or the component differs.
    fn repeat_vanishing(&mut self, component: u32, is_back: bool, differs: &mut [bool]) {
        let Some(components) = &mut self.components else { return };
        let of_component = components.vertices(component).to_vec();
        let is_same = !is_back && of_component.iter().all(|&v| !differs[v as usize]);
        if is_same {
            components.remove(component);
            let faces = self.faces_of(component);
            self.vanish(component, &faces);
        } else {
            of_component.iter().for_each(|&v| differs[v as usize] = true);
        }
    }

    /// Marks vertices and their neighbours.
    fn mark_around(&mut self, around: &[u32], differs: &mut [bool]) {
        for &v in around {
            let v = self.vertices.live_vertex(v);
            differs[v as usize] = true;
            self.vertices.refresh(v);
            let ring = self.vertices.neighbours(v).iter().filter(|&&w| w != GHOST);
            ring.for_each(|&w| differs[w as usize] = true);
        }
    }

    /// Queues marked vertices. All others count as refused until their rings change.
    fn queue_only(&mut self, marked: &[bool]) {
        *self.queue = BucketQueue::default();
        for v in self.vertices.ids() {
            let vertex = self.vertices.get_mut(v);
            vertex.bucket = NONE;
            if vertex.flags.any(VertexFlags::INACTIVE) || vertex.len == 0 {
                continue;
            }
            if marked[v as usize] {
                self.put_first(v);
            } else {
                vertex.target = NO_VERTEX;
                vertex.floor = 1;
            }
        }
    }
}
