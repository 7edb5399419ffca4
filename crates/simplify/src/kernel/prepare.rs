//! From a mesh to vertices with rings, in the engine's frame.

use crate::engine::Run;
use crate::kernel::attributes::AttributeModel;
use crate::kernel::attributes::bare::NoAttributes;
use crate::kernel::attributes::corners::Corners;
use crate::kernel::attributes::layers::AttributeLayers;
use crate::kernel::attributes::wedge_quadrics::WedgeQuadrics;
use crate::kernel::mesh::local_frame::Frame;
use crate::kernel::mesh::one_ring::GHOST;
use crate::kernel::mesh::vertex::VertexFlags;
use crate::kernel::metric::Metric;
use crate::kernel::metric::swept_volume::SweptVolume;
use crate::kernel::partition::Partition;
use crate::kernel::run::{KernelInput, KernelRun};
use crate::kernel::setup::build_rings::Fans;
use crate::kernel::setup::split_non_manifold;
use crate::kernel::setup::split_non_manifold::SplitFaces;
use crate::kernel::setup::vertex_order::{Order, numbers};
use crate::locks::Held;
use crate::options::{AttributeWeights, Options};
use crate::simplifier::Input;
use crate::surface::MOST_FACES;
use meshlod_mesh::{Bounds, Lock, Mesh, VertexId};

use crate::clean;

/// As many channels of attributes count at most; the rest of them only moves along.
const MOST_CHANNELS: usize = 8;

/// No boundary counts for more: floats would run out, and nothing changes any more.
const MOST_BOUNDARY_WEIGHT: f64 = 1e9;

/// A mesh about to be simplified.
pub(crate) struct Prepared<'m, R> {
    rule: R,
    mesh: &'m Mesh,
    frame: Frame,
    order: Order,
    fans: Fans,
    /// The faces on copies of vertices, or without those that repeat another, where there are any.
    faces: Option<Vec<[u32; 3]>>,
    input: Input,
}

impl<'m, R: Metric + 'm> Prepared<'m, R> {
    /// `None` where copies of vertices do not make it manifold, or a vertex has copies with more faces
    /// than anybody looks at.
    pub(crate) fn new(rule: R, mesh: &'m Mesh, bounds: &Bounds, options: &Options) -> Option<Self> {
        let frame = Frame::new(mesh, bounds);
        let (order, mut places) = Order::new(mesh, &frame);
        let count = mesh.faces.len();
        let face = |i: usize| order.face(&mesh.faces[i]);
        let weight = options.boundary_weight.map_or(R::BOUNDARY_WEIGHT, boundary_weight);
        let mut fans = Fans::new::<R>((&places, Vec::new()), count, face, weight);
        let degenerate_faces = count - fans.faces;
        let (mut faces, mut duplicate_faces) = (None, 0);
        if !fans.irregular.is_empty() {
            let mut all: Vec<_> = (0..count).map(face).collect();
            duplicate_faces = split_non_manifold::drop_duplicates(&mut all, &fans.irregular);
            if duplicate_faces > 0 {
                fans = Fans::new::<R>((&places, Vec::new()), count, |i| all[i], weight);
            }
            faces = Some(all);
        }
        let irregular = std::mem::take(&mut fans.irregular);
        if let Some(all) = faces.as_mut().filter(|_| !irregular.is_empty()) {
            let SplitFaces { faces, copied } =
                split_non_manifold::split(std::mem::take(all), &irregular, places.len());
            let copies: Vec<_> = copied.iter().map(|&v| places[v as usize]).collect();
            places.extend(copies);
            fans = Fans::new::<R>((&places, copied), count, |i| faces[i], weight);
            *all = faces;
            if !fans.irregular.is_empty() || is_crowded(&mut fans, &irregular) {
                return None;
            }
        }
        let input = Input {
            degenerate_faces,
            duplicate_faces,
            non_manifold_vertices: irregular.len(),
            held: Held::default(),
        };
        let mut prepared = Self { rule, mesh, frame, order, fans, faces, input };
        prepared.pin(&irregular);
        prepared.lock(options);
        Some(prepared)
    }

    /// Holds the copies of vertices together.
    fn pin(&mut self, irregular: &[u32]) {
        let store = &mut self.fans.store;
        let copies = store.own() as u32..store.all.len() as u32;
        for v in irregular.iter().copied().chain(copies) {
            let flags = &mut store.all[v as usize].flags;
            flags.set(VertexFlags::PINNED);
            flags.set(VertexFlags::SPLIT);
        }
    }

    fn lock(&mut self, options: &Options) {
        let locks = &options.locks.of_vertex;
        if locks.is_empty() && !options.lock_boundary {
            return;
        }
        // Where copies end, the surface may go on.
        let with_copies = options.lock_boundary && self.input.non_manifold_vertices > 0;
        let connectivity = with_copies.then(|| clean::connect(self.mesh).0);
        let own = self.fans.store.own() as u32;
        let mut vertices = self.fans.store.whole();
        for v in 0..own {
            let input = VertexId(self.order.input(v));
            let lock = locks.get(input.index()).copied().unwrap_or_default();
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
                    self.input.held.locked += 1;
                }
            }
        }
        for copy in own..own + vertices.copied.len() as u32 {
            let of = vertices.get(vertices.origin(copy)).flags;
            vertices.get_mut(copy).flags.set(VertexFlags(of.0 & VertexFlags::PROTECTED.0));
        }
    }

    /// What was found in the input.
    pub(crate) fn input(&self) -> Input {
        self.input
    }

    /// How many faces there are to work on.
    pub(crate) fn live_faces(&self) -> usize {
        self.fans.faces
    }

    /// Costs all vertices of a mesh without attributes.
    pub(crate) fn start_bare(self) -> Box<dyn Run + 'm> {
        let rule = self.rule;
        self.work(NoAttributes(rule))
    }

    fn work<L: AttributeModel + 'm>(self, model: L) -> Box<dyn Run + 'm> {
        let Self { mesh, frame, order, fans, faces, .. } = self;
        let parts = Partition::new(fans.store, model, fans.faces);
        Box::new(KernelRun::new(KernelInput { mesh, frame, order, faces }, parts))
    }
}

impl<'m> Prepared<'m, SweptVolume> {
    /// Costs all vertices, and what is at them.
    pub(crate) fn start(self, weights: &AttributeWeights) -> Box<dyn Run + 'm> {
        let faces = numbers(self.mesh, &self.order, self.faces.as_deref());
        let Some(corners) = Corners::new(self.mesh, faces, self.fans.store.all.len()) else {
            return self.start_bare();
        };
        let layers = AttributeLayers::new(self.mesh, &self.frame, weights, MOST_CHANNELS);
        match layers.channels() {
            0..=2 => self.paint::<2>(layers, corners),
            3 => self.paint::<3>(layers, corners),
            4..=5 => self.paint::<5>(layers, corners),
            _ => self.paint::<MOST_CHANNELS>(layers, corners),
        }
    }

    fn paint<const K: usize>(
        mut self,
        layers: AttributeLayers<'m>,
        corners: Corners<'m>,
    ) -> Box<dyn Run + 'm> {
        let faces = numbers(self.mesh, &self.order, self.faces.as_deref());
        let model = WedgeQuadrics::<K>::new(layers, corners, &mut self.fans.store.whole(), faces);
        self.work(model)
    }
}

fn boundary_weight(asked: f64) -> f32 {
    asked.min(MOST_BOUNDARY_WEIGHT) as f32
}

/// Whether all copies of some vertex have more faces together than the general engine looks at: each
/// time that one of them takes another vertex in, whoever observes would look at all.
fn is_crowded(fans: &mut Fans, irregular: &[u32]) -> bool {
    let first_copy = fans.store.own() as u32;
    let vertices = fans.store.whole();
    let mut faces: Vec<usize> = irregular.iter().map(|&v| vertices.neighbours(v).len()).collect();
    for (copy, of) in (first_copy..).zip(vertices.copied) {
        if let Ok(at) = irregular.binary_search(of) {
            faces[at] += vertices.neighbours(copy).len();
        }
    }
    faces.iter().any(|&faces| faces > MOST_FACES)
}
