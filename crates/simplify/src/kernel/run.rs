//! A run of the kernel, as [`Simplifier`](crate::Simplifier) drives it.

use std::cell::OnceCell;
use std::sync::Arc;

use meshlod_mesh::{Mesh, VertexId};
use meshlod_spatial::{Bvh, Mates};

use crate::clean;
use crate::engine::policy::{Observe, Stop};
use crate::excess::{Excess, ExcessFace};
use crate::kernel::attributes::AttributeStore;
use crate::kernel::bound::ErrorBound;
use crate::kernel::bound::input_surface::InputSurface;
use crate::kernel::contraction_log::{InputNames, Logged, Steps, replay};
use crate::kernel::handles::Handles;
use crate::kernel::level::{level, live_faces, workspace};
use crate::kernel::mesh::local_frame::Frame;
use crate::kernel::mesh::one_ring::VertexStore;
use crate::kernel::mesh::vertex::{NO_VERTEX, Vertex, VertexFlags};
use crate::kernel::metric::Metric;
use crate::kernel::partition::Partition;
use crate::kernel::polish::{Origin, polish};
use crate::kernel::repay::{Debt, Means, repay};
use crate::kernel::retrace::{FarFace, Retrace};
use crate::kernel::schedule::bucket_queue::{NONE, bucket, min_cost_in};
use crate::kernel::setup::vertex_order::{Order, numbers};
use crate::method::Method;
use crate::options::Contractions;
use crate::refusal::Refusal;
use crate::run::{Run, Tally};
use crate::surface::Surface;
use crate::surface::rims::Rims;

/// The input mesh, and its correspondence with the kernel's vertices.
pub(crate) struct KernelInput<'m> {
    pub(crate) mesh: &'m Mesh,
    pub(crate) frame: Frame,
    pub(crate) order: Order,
    /// The faces with copies of vertices, if they differ from the input's.
    pub(crate) faces: Option<Vec<[u32; 3]>>,
    /// True to fit levels to the input.
    pub(crate) polish: bool,
}

/// A mesh being simplified by the kernel.
pub(crate) struct KernelRun<'m, S> {
    source: KernelInput<'m>,
    partition: Partition<S>,
    /// Smallest error bound that has refused an edge since all edges were last made eligible.
    refused_above: f64,
    /// Input surface, if an error bound has been asked for.
    input: OnceCell<InputSurface>,
    /// All steps so far, if each was made within an error bound and none was shown to an observer.
    steps: Option<Vec<Logged>>,
    /// The last error bound, and the part of it that holds at each vertex; empty if the whole
    /// bound holds everywhere.
    lowered: (f64, Vec<f32>),
    /// True if most of the surface could go no further after the last run, and the rest has moved far.
    near_limit: bool,
    /// Current surface, if it was asked for and has not changed unobserved since.
    surface: OnceCell<Surface>,
}

impl<'m, S: AttributeStore> KernelRun<'m, S> {
    pub(crate) fn new(source: KernelInput<'m>, partition: Partition<S>) -> Self {
        // Edges between ties are contracted together, which steps do not tell.
        let steps = partition.whole.ties.is_none().then(Vec::new);
        let lowered = (f64::INFINITY, Vec::new());
        let (input, surface) = (OnceCell::new(), OnceCell::new());
        let (refused_above, near_limit) = (f64::INFINITY, false);
        Self { source, partition, refused_above, input, steps, lowered, near_limit, surface }
    }

    /// Returns the faces of the input in the kernel's vertices, if they differ from its own.
    fn faces(&self) -> Option<&[[u32; 3]]> {
        let cut = self.partition.whole.handles.as_ref().map(Handles::faces);
        cut.or(self.source.faces.as_deref())
    }

    fn names(&self) -> InputNames<'_> {
        names(&self.source, &self.partition.store, self.partition.store.own())
    }

    /// Returns the current mesh, and the id there of each input vertex.
    fn numbered_level(&self) -> (Mesh, Vec<u32>) {
        level(self.names(), &self.partition.attributes, self.faces())
    }

    /// Returns for each vertex of a level whether a pin or a tie holds it, given the ids of the
    /// input vertices.
    fn held(&self, ids: &[u32]) -> Vec<bool> {
        let KernelInput { order, .. } = &self.source;
        let used = (0..).zip(ids).filter(|(_, id)| **id != NO_VERTEX);
        let of_input = self.source.mesh.positions.len() as u32;
        let flags = |v: u32| self.partition.store.all[order.id(VertexId(v)) as usize].flags;
        used.map(|(v, _)| v < of_input && flags(v).any(VertexFlags::HELD)).collect()
    }

    /// Fits a level to the input, given the ids of the input vertices.
    fn polish(&self, level: &mut Mesh, ids: &[u32]) {
        let (KernelInput { mesh, order, .. }, names) = (&self.source, self.names());
        let live = names.store.live_vertices();
        let heir = |v: u32| ids[names.input(live[order.id(VertexId(v)) as usize]).index()];
        let heirs: Vec<u32> = (0..mesh.positions.len() as u32).map(heir).collect();
        polish(level, &Origin { input: mesh, heirs: &heirs, frame: *names.frame }, &self.held(ids));
    }

    /// Returns for each of `count` vertices of a level how far contractions have moved the surface
    /// there, in model units, given the ids of the input vertices.
    fn moved(&self, ids: &[u32], count: usize) -> Vec<f64> {
        let (names, mut moved) = (self.names(), vec![0.0_f64; count]);
        for (v, vertex) in (0..).zip(&self.partition.store.all) {
            if let Some(of_level) = moved.get_mut(ids[names.input(v).index()] as usize) {
                *of_level = of_level.max(f64::from(vertex.moved).sqrt() * names.frame.unit);
            }
        }
        moved
    }

    /// Returns the factor from the kernel's costs to model units.
    fn cost_unit(&self) -> f64 {
        self.source.frame.unit.powi(S::Metric::METHOD.cost_power())
    }

    /// Returns the last bucket that holds costs of at most `cost`. The cost of a bucket is its
    /// smallest, so a limit taken from [`Run::next_cost`] always allows at least one try.
    fn last_bucket(&self, cost: f64) -> u16 {
        let unit = self.cost_unit();
        let costs_at_most = |bucket: u16| f64::from(min_cost_in(bucket)) * unit <= cost;
        // The division may have rounded either way.
        let about = bucket((cost / unit) as f32);
        let near = [about.saturating_add(1), about, about.saturating_sub(1)];
        match about {
            NONE => NONE,
            _ => near.into_iter().find(|&b| b < NONE && costs_at_most(b)).unwrap_or(0),
        }
    }

    /// Makes edges eligible again that a smaller error bound has refused.
    fn try_again_within(&mut self, error: f64) {
        if error > self.refused_above {
            self.refused_above = f64::INFINITY;
            self.partition.wake_all();
        }
    }

    /// Returns the corners of faces in live vertices.
    fn far_faces(&self, excess: &[Excess]) -> Vec<FarFace> {
        let KernelInput { mesh, order, .. } = &self.source;
        let faces = self.faces();
        let of_input = |i: usize| match faces {
            Some(faces) => faces[i],
            None => order.face(&mesh.faces[i]),
        };
        let live = self.partition.store.live_vertices();
        let of_level = live_faces(mesh.faces.len(), of_input, &live);
        let corners = |far: &Excess| match far.face {
            ExcessFace::OfLevel(face) => of_level.get(face.index()).map(|(_, corners)| *corners),
            ExcessFace::OfInput(face) if face.index() < mesh.faces.len() => {
                Some(of_input(face.index()).map(|v| live[v as usize]))
            }
            ExcessFace::OfInput(_) => None,
        };
        excess.iter().filter_map(|far| Some((corners(far)?, far.ratio))).collect()
    }

    /// Simplifies to this number of faces, and shows the observer what it wants to see.
    fn advance(&mut self, faces: usize, stop: &Stop, observer: &mut dyn Observe) {
        if observer.needs_surface() {
            self.surface();
        }
        let at_first = self.partition.live_faces;
        let log = self.contract(faces, stop, observer);
        let is_unchanged = self.partition.live_faces == at_first;
        match (log, self.surface.take()) {
            (Some(Steps { log, values }), Some(mut surface)) => {
                let components = self.partition.whole.components.as_ref();
                replay((&log, &values), components, self.names(), &mut surface, observer);
                self.surface = surface.into();
            }
            (_, surface) if is_unchanged => {
                self.surface = surface.map_or_else(OnceCell::new, OnceCell::from);
            }
            _ => {}
        }
    }

    /// Simplifies to this number of faces, and returns the log if the observer wants to see it.
    fn contract(&mut self, faces: usize, stop: &Stop, observer: &mut dyn Observe) -> Option<Steps> {
        let is_shown = observer.needs_surface();
        let is_bounded = stop.error < f64::INFINITY;
        if is_shown {
            self.steps = None;
            self.partition.log = Some(Steps::default());
        } else if is_bounded {
            // A part of this bound says nothing about another.
            if stop.error != self.lowered.0 {
                self.lowered = (stop.error, Vec::new());
            }
            self.partition.log = self.steps.take().map(|log| Steps { log, ..Steps::default() });
        }
        self.partition.records_values = is_shown;
        self.try_again_within(stop.error);
        let last = self.last_bucket(stop.cost);
        let refused = |partition: &Partition<S>| partition.refusals.count(Refusal::Error);
        let (refused_before, at_first) = (refused(&self.partition), self.partition.live_faces);
        let Self { source, partition, input, lowered, .. } = &mut *self;
        let mut bound =
            is_bounded.then(|| bound(stop, &lowered.1, source, &partition.store, input));
        partition.run(faces, last, bound.as_mut(), &mut |gone| observer.gone(gone));
        if refused(&self.partition) > refused_before {
            self.refused_above = self.refused_above.min(stop.error);
        }
        let is_unchanged = self.partition.live_faces == at_first;
        let mut log = self.partition.log.take();
        if !is_shown {
            self.steps =
                log.take().map(|steps| steps.log).or(self.steps.take().filter(|_| is_unchanged));
        }
        log
    }

    /// Returns true if the surface is the input as it is: nothing has been contracted, left out or
    /// copied, and no face has more than its vertices.
    fn is_input(&self) -> bool {
        let Mesh { attributes, materials, objects, .. } = self.source.mesh;
        let is_bare = attributes.is_none() && materials.is_none() && objects.is_none();
        let Partition { store, contractions, .. } = &self.partition;
        let is_whole = self.faces().is_none() && store.spare == 0 && store.copied.is_empty();
        is_bare && is_whole && *contractions == 0
    }

    /// Builds the current surface.
    fn new_surface(&self) -> Surface {
        surface_of(&workspace(self.names(), &self.partition.attributes, self.faces()))
    }
}

fn surface_of(mesh: &Mesh) -> Surface {
    let (connectivity, _) = clean::connect(mesh);
    let mut surface = Surface::new(mesh, &connectivity);
    surface.rims = Rims::new(mesh, &connectivity);
    surface
}

fn names<'w>(source: &'w KernelInput<'_>, store: &'w VertexStore, own: usize) -> InputNames<'w> {
    let KernelInput { mesh, frame, order, .. } = source;
    InputNames { mesh, frame, order, store, own }
}

/// Returns the error bound of a run. Builds the input surface if it is missing.
fn bound<'o>(
    stop: &Stop,
    parts: &[f32],
    source: &KernelInput<'_>,
    store: &VertexStore,
    input: &'o OnceCell<InputSurface>,
) -> ErrorBound<'o> {
    let KernelInput { mesh, frame, order, faces, .. } = source;
    let input = input.get_or_init(|| {
        let place = |v: u32| frame.to_local(mesh.positions[order.input(store.origin(v)) as usize]);
        let of_cuts = store.all[store.all.len() - store.spare..].iter().map(Vertex::place);
        let all = 0..(store.all.len() - store.spare) as u32;
        let places = all.map(place).chain(of_cuts).collect();
        InputSurface::new(mesh, *frame, places, numbers(mesh, order, faces.as_deref()))
    });
    let max_error = (stop.error / frame.unit) as f32;
    let bound = ErrorBound::new(max_error, parts.to_vec(), input, store);
    if stop.is_compared { bound.compared() } else { bound }
}

impl<S: AttributeStore> Run for KernelRun<'_, S> {
    fn run(&mut self, stop: &Stop, observer: &mut dyn Observe) {
        self.advance(stop.faces, stop, observer);
        self.near_limit = stop.error == f64::INFINITY && self.partition.is_near_limit();
    }

    fn run_out(mut self: Box<Self>, stop: &Stop, observer: &mut dyn Observe) -> (Tally, usize) {
        let is_shown = observer.needs_surface();
        // The input's surface is built anew, rather than kept beside the kernel's.
        let is_input = is_shown && self.is_input();
        if is_input {
            self.surface.take();
        } else if is_shown {
            self.surface();
        }
        let log = self.contract(stop.faces, stop, observer);
        self.near_limit = stop.error == f64::INFINITY && self.partition.is_near_limit();
        let done = (self.tally(), self.live_faces());
        let Self { source, partition, surface, .. } = *self;
        let Some(Steps { log, values }) = log else { return done };
        let own = partition.store.own();
        let (store, whole) = partition.without_vertices();
        let kept = surface.into_inner().filter(|_| !is_input);
        let mut surface = kept.unwrap_or_else(|| surface_of(source.mesh));
        let names = names(&source, &store, own);
        replay((&log, &values), whole.components.as_ref(), names, &mut surface, observer);
        done
    }

    fn step(&mut self, stop: &Stop, observer: &mut dyn Observe) -> bool {
        self.partition.unite();
        let before = self.partition.live_faces;
        self.advance(before.saturating_sub(1), stop, observer);
        self.partition.live_faces < before
    }

    fn next_cost(&mut self) -> Option<f64> {
        self.try_again_within(f64::INFINITY);
        self.partition.unite();
        let bucket = self.partition.next_bucket()?;
        Some(f64::from(min_cost_in(bucket)) * self.cost_unit())
    }

    fn live_faces(&self) -> usize {
        self.partition.live_faces
    }

    fn level(&self, _: &Mesh) -> Mesh {
        self.numbered_level().0
    }

    fn settled_level(&self, _: &Mesh) -> (Mesh, f64) {
        let (mut level, ids) = self.numbered_level();
        // A bound of the error comes before the volume.
        if self.input.get().is_some() {
            return (level, 0.0);
        }
        if self.source.polish && S::Metric::METHOD == Method::LindstromTurk {
            self.polish(&mut level, &ids);
        }
        let names = self.names();
        let unit = names.frame.unit.powi(3);
        let debt = |(v, sixfold): (u32, f64)| Debt {
            vertex: VertexId(ids[names.input(v).index()]),
            sixfold: sixfold * unit,
        };
        let debts: Vec<Debt> = self.partition.debts().into_iter().map(debt).collect();
        if debts.is_empty() {
            return (level, 0.0);
        }
        let means =
            Means { held: &self.held(&ids), moved: &self.moved(&ids, level.positions.len()) };
        let sixfold = repay(&mut level, &debts, &means);
        (level, sixfold / 6.0)
    }

    fn retrace(&mut self, excess: &[Excess]) -> Option<Retrace> {
        let far = self.far_faces(excess);
        let Partition { store, whole, .. } = &self.partition;
        let known = (whole.components.as_ref(), &self.lowered.1[..]);
        let chosen = Retrace::new(self.steps.as_ref()?.clone(), &far, known, store.all.len())?;
        Some(Retrace {
            refusals: self.partition.refusals,
            deferral: self.partition.deferral(),
            refused_above: self.refused_above,
            error: self.lowered.0,
            input: std::mem::take(&mut self.input),
            ..chosen
        })
    }

    fn follow(&mut self, retrace: Retrace) {
        let log = Vec::with_capacity(retrace.steps.len());
        self.partition.log = Some(Steps { log, ..Steps::default() });
        self.partition.retrace(&retrace);
        self.steps = self.partition.log.take().map(|steps| steps.log);
        let Retrace { refused_above, error, parts, input, .. } = retrace;
        (self.refused_above, self.lowered, self.input) = (refused_above, (error, parts), input);
    }

    fn surface(&self) -> &Surface {
        self.surface.get_or_init(|| self.new_surface())
    }

    fn into_surface(self: Box<Self>) -> Surface {
        self.surface();
        self.surface.into_inner().expect("it was made just now")
    }

    fn hierarchy(&self) -> Option<(Arc<Bvh>, Arc<Mates>)> {
        self.input.get().map(InputSurface::hierarchy)
    }

    fn tally(&self) -> Tally {
        let owed = self.partition.debts().iter().map(|(_, sixfold)| sixfold).sum();
        Tally {
            vanished: self
                .partition
                .whole
                .components
                .as_ref()
                .map_or(0, |all| all.vanished().len()),
            handles: self.partition.whole.handles.as_ref().map(Handles::counts),
            contractions: Contractions { edges: self.partition.contractions, faces: 0 },
            refusals: self.partition.refusals,
            error_estimate: self.partition.error.sqrt() * self.source.frame.unit,
            near_limit: self.near_limit,
            volume: self.partition.volume.loss(&self.source.frame, owed),
        }
    }
}
