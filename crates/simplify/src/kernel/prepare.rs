//! Preparation: from a mesh to vertices with rings, locks, ties and attributes.

use glam::Vec3;
use meshlod_mesh::{Bounds, Lock, Mesh, VertexId};

use crate::clean;
use crate::held::Held;
use crate::kernel::attributes::AttributeStore;
use crate::kernel::attributes::bare::NoAttributes;
use crate::kernel::attributes::corners::Corners;
use crate::kernel::attributes::layers::AttributeLayers;
use crate::kernel::attributes::wedge_store::WedgeStore;
use crate::kernel::components::{Components, Pieces};
use crate::kernel::handles::{Handles, PER_CUT, genus};
use crate::kernel::mesh::local_frame::Frame;
use crate::kernel::mesh::one_ring::GHOST;
use crate::kernel::mesh::vertex::VertexFlags;
use crate::kernel::metric::Metric;
use crate::kernel::partition::{Partition, Whole};
use crate::kernel::run::{KernelInput, KernelRun};
use crate::kernel::setup::build_rings::Fans;
use crate::kernel::setup::split_non_manifold;
use crate::kernel::setup::vertex_order::{Order, numbers};
use crate::options::{Options, Topology};
use crate::run::{InputSummary, Run, Wanted};
use crate::surface::MOST_FACES;
use crate::surface::ties::{MOST_MEMBERS, Ties};

/// Largest number of costed attribute channels; further ones are only carried along.
const MAX_CHANNELS: usize = 8;

/// Largest weight of a boundary: beyond it floats would overflow, and nothing changes any more.
const MAX_BOUNDARY_WEIGHT: f64 = 1e9;

/// Fraction of the diagonal by which a vertex may leave the bounding box of the input: vertices of
/// a round surface must lie outside to preserve its volume.
const BEYOND: f32 = 0.004;

/// A mesh ready to be simplified.
pub(crate) struct Prepared<'m, M> {
    metric: M,
    mesh: &'m Mesh,
    frame: Frame,
    order: Order,
    fans: Fans,
    /// The faces with copies of vertices, or without repeated faces, if they differ from the
    /// input's.
    faces: Option<Vec<[u32; 3]>>,
    input: InputSummary,
    whole: Whole,
    polish: bool,
}

impl<'m, M: Metric + 'm> Prepared<'m, M> {
    /// Prepares a mesh. Non-manifold vertices are split into copies that stay where they are, until
    /// each copy has one fan of faces, or returns `None` if only a manifold mesh is wanted.
    pub(crate) fn new(
        metric: M,
        mesh: &'m Mesh,
        bounds: &Bounds,
        (options, wanted): (&Options, Wanted),
    ) -> Option<Self> {
        let frame = Frame::new(mesh, bounds);
        let (order, mut places) = Order::new(mesh, &frame);
        let count = mesh.faces.len();
        let face = |i: usize| order.face(&mesh.faces[i]);
        let weight = options.boundary_weight.map_or(M::BOUNDARY_WEIGHT, boundary_weight);
        let mut fans = Fans::new::<M>((&places, Vec::new()), count, face, weight);
        if wanted == Wanted::Manifold && !fans.irregular.is_empty() {
            return None;
        }
        let degenerate_faces = count - fans.faces;
        let (mut faces, mut duplicate_faces) = (None, 0);
        if !fans.irregular.is_empty() {
            let mut all: Vec<_> = (0..count).map(face).collect();
            duplicate_faces = split_non_manifold::drop_duplicates(&mut all, &fans.irregular);
            if duplicate_faces > 0 {
                fans = Fans::new::<M>((&places, Vec::new()), count, |i| all[i], weight);
            }
            faces = Some(all);
        }
        let non_manifold_vertices = fans.irregular.len();
        let mut copied: Vec<u32> = Vec::new();
        while let Some(all) = faces.as_mut().filter(|_| !fans.irregular.is_empty()) {
            let copies = split_non_manifold::split(all, &fans.irregular, places.len());
            let own = places.len() - copied.len();
            for v in copies {
                let origin = (v as usize).checked_sub(own).map_or(v, |copy| copied[copy]);
                places.push(places[v as usize]);
                copied.push(origin);
            }
            fans = Fans::new::<M>((&places, copied.clone()), count, |i| all[i], weight);
        }
        let held = Held::default();
        let input = InputSummary { degenerate_faces, duplicate_faces, non_manifold_vertices, held };
        let room = frame.to_local(bounds.max);
        let room = room + Vec3::splat(BEYOND * (bounds.diagonal() / frame.unit) as f32);
        let whole = Whole { room, ..Whole::default() };
        let polish = options.polish;
        let mut prepared = Self { metric, mesh, frame, order, fans, faces, input, whole, polish };
        prepared.pin();
        let is_held = prepared.lock(options);
        prepared.tie(options);
        if options.topology == Topology::Free {
            let below = options.vanish_below.unwrap_or(f64::INFINITY);
            prepared.find_components(is_held, options, below);
        }
        Some(prepared)
    }

    /// Pins all copies of vertices. If the copies of a vertex have too many faces together, nothing
    /// is contracted into them either, since observers would have to visit all these faces each
    /// time.
    fn pin(&mut self) {
        let store = &mut self.fans.store;
        let own = store.own() as u32;
        let split = std::mem::take(&mut store.split);
        let mut faces: Vec<usize> =
            split.iter().map(|&v| store.whole().neighbours(v).len()).collect();
        let of = |copied: &u32| split.binary_search(copied).expect("what has copies is split");
        for (i, at) in store.copied.clone().iter().map(of).enumerate() {
            faces[at] += store.whole().neighbours(own + i as u32).len();
        }
        let pins = |at: usize| match faces[at] > MOST_FACES {
            true => VertexFlags(VertexFlags::PINNED.0 | VertexFlags::BARRED.0),
            false => VertexFlags::PINNED,
        };
        for (at, &v) in split.iter().enumerate() {
            store.all[v as usize].flags.set(pins(at));
        }
        for (i, at) in store.copied.iter().map(of).enumerate() {
            store.all[own as usize + i].flags.set(pins(at));
        }
        store.split = split;
    }

    /// Ties vertices. The vertices of a tie with too many members are pinned.
    fn tie(&mut self, options: &Options) {
        let mut ties = Vec::new();
        let store = &mut self.fans.store;
        for tie in options.locks.ties.iter().filter(|tie| tie.len() > 1) {
            let few = tie.len() <= MOST_MEMBERS;
            let flag = if few { VertexFlags::TIED } else { VertexFlags::PINNED };
            let members: Vec<VertexId> = tie.iter().map(|v| VertexId(self.order.id(*v))).collect();
            members.iter().for_each(|v| store.all[v.index()].flags.set(flag));
            if few {
                self.input.held.tied += tie.len();
                ties.push(members);
            } else {
                self.input.held.locked += tie.len();
            }
        }
        self.whole.ties = (!ties.is_empty()).then(|| Ties::new(ties));
    }

    /// Finds the components that may vanish.
    fn find_components(&mut self, mut is_held: Vec<bool>, options: &Options, below: f64) {
        for v in options.locks.ties.iter().filter(|tie| tie.len() > 1).flatten() {
            is_held[v.index()] = true;
        }
        let faces = numbers(self.mesh, &self.order, self.faces.as_deref());
        let pieces = Pieces {
            frame: &self.frame,
            order: &self.order,
            vertices: &self.fans.store.whole(),
            is_held: &is_held,
            single_sided: options.single_sided,
        };
        self.whole.components = Components::new(&pieces, faces, below);
    }

    /// Counts the handles, and makes room for cutting them.
    fn find_handles(&mut self) {
        let store = &mut self.fans.store;
        if !store.copied.is_empty() {
            return;
        }
        let components = self.whole.components.as_ref().map_or(1, Components::number);
        let genus = genus(&store.whole(), self.fans.faces, components);
        if genus > 0 {
            let faces = numbers(self.mesh, &self.order, self.faces.as_deref()).collect();
            let handles = Handles::new(genus, faces, store.own() as u32);
            store.add_spare(PER_CUT * genus);
            self.whole.handles = Some(handles);
        }
    }

    /// Applies the locks. Returns for each vertex of the input whether it is locked.
    fn lock(&mut self, options: &Options) -> Vec<bool> {
        self.fans.store.protection = options.protection_of_cost() as f32;
        let mut is_locked = vec![false; self.mesh.positions.len()];
        let locks = &options.locks;
        if locks.of_vertex.is_empty() && !options.lock_boundary {
            return is_locked;
        }
        // Where a fan of copies ends, the surface may go on.
        let with_copies = options.lock_boundary && self.input.non_manifold_vertices > 0;
        let connectivity = with_copies.then(|| clean::connect(self.mesh).0);
        let own = self.fans.store.own() as u32;
        let mut vertices = self.fans.store.whole();
        for v in 0..own {
            let input = VertexId(self.order.input(v));
            let lock = locks.of(input);
            let on_boundary = options.lock_boundary
                && match &connectivity {
                    Some(connectivity) => connectivity.marks(input).boundary(),
                    None => vertices.neighbours(v).contains(&GHOST),
                };
            let flags = &mut vertices.get_mut(v).flags;
            match if on_boundary { Lock::Locked } else { lock } {
                Lock::Free => {}
                Lock::Protected => {
                    flags.set(VertexFlags::PROTECTED);
                    self.input.held.protected += 1;
                }
                Lock::Locked => {
                    flags.set(VertexFlags::PINNED);
                    is_locked[input.index()] = true;
                    self.input.held.locked += 1;
                }
            }
        }
        for copy in own..own + vertices.copied.len() as u32 {
            let of = vertices.get(vertices.origin(copy)).flags;
            vertices.get_mut(copy).flags.set(VertexFlags(of.0 & VertexFlags::PROTECTED.0));
        }
        is_locked
    }

    /// Returns what was found in the input.
    pub(crate) fn input(&self) -> InputSummary {
        self.input
    }

    /// Returns the number of faces to simplify.
    pub(crate) fn live_faces(&self) -> usize {
        self.fans.faces
    }

    fn run<S: AttributeStore + 'm>(self, attributes: S) -> Box<dyn Run + 'm> {
        let Self { mesh, frame, order, fans, faces, whole, polish, .. } = self;
        let partition = Partition::new(fans.store, attributes, fans.faces, whole);
        Box::new(KernelRun::new(KernelInput { mesh, frame, order, faces, polish }, partition))
    }
}

impl<'m, M: Metric + 'm> Prepared<'m, M> {
    /// Builds the attribute quadrics, and costs all vertices.
    pub(crate) fn start(mut self, options: &Options) -> Box<dyn Run + 'm> {
        if options.topology == Topology::Free {
            self.find_handles();
        }
        let faces = numbers(self.mesh, &self.order, self.faces.as_deref());
        let Some(corners) = Corners::new(self.mesh, faces, self.fans.store.all.len()) else {
            let metric = self.metric;
            return self.run(NoAttributes(metric));
        };
        let layers = AttributeLayers::new(self.mesh, &self.frame, &options.weights, MAX_CHANNELS);
        let seams_hold = options.topology == Topology::Keep;
        match layers.channels() {
            // Code for fewer channels is worth its size only with the default method.
            0..=2 if M::IS_MEMORYLESS => self.with_attributes::<2>(layers, corners, seams_hold),
            3 if M::IS_MEMORYLESS => self.with_attributes::<3>(layers, corners, seams_hold),
            0..=5 => self.with_attributes::<5>(layers, corners, seams_hold),
            _ => self.with_attributes::<MAX_CHANNELS>(layers, corners, seams_hold),
        }
    }

    fn with_attributes<const K: usize>(
        mut self,
        layers: AttributeLayers<'m>,
        corners: Corners<'m>,
        seams_hold: bool,
    ) -> Box<dyn Run + 'm> {
        let faces = numbers(self.mesh, &self.order, self.faces.as_deref());
        let vertices = &mut self.fans.store.whole();
        let mut wedges = WedgeStore::<M, K>::new(layers, corners, vertices, faces);
        wedges.hold_seams(seams_hold);
        self.run(wedges)
    }
}

fn boundary_weight(asked: f64) -> f32 {
    asked.min(MAX_BOUNDARY_WEIGHT) as f32
}
