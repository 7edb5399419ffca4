//! From a mesh to vertices with rings, in the engine's frame.

use meshlod_mesh::{Bounds, Lock, Mesh, VertexId};

use crate::clean;
use crate::engine::Run;
use crate::fast::coat::Coat;
use crate::fast::dress::Corners;
use crate::fast::fans::Fans;
use crate::fast::frame::Frame;
use crate::fast::looks::{Bare, Looks};
use crate::fast::memoryless::Memoryless;
use crate::fast::order::Order;
use crate::fast::painted::Painted;
use crate::fast::parts::Parts;
use crate::fast::ring::GHOST;
use crate::fast::rule::Rule;
use crate::fast::split::{self, Split};
use crate::fast::vertex::Flags;
use crate::fast::work::{Source, Work};
use crate::locks::Held;
use crate::options::{AttributeWeights, Options};
use crate::simplifier::Input;
use crate::surface::MOST_FACES;

/// As many channels of attributes count at most; the rest of them only moves along.
const MOST_CHANNELS: usize = 8;

/// No boundary counts for more: floats would run out, and nothing changes any more.
const MOST_BOUNDARY_WEIGHT: f64 = 1e9;

/// A mesh about to be simplified.
pub(super) struct Prepared<'m, R> {
    rule: R,
    mesh: &'m Mesh,
    frame: Frame,
    order: Order,
    fans: Fans,
    /// The faces on copies of vertices, or without those that repeat another, where there are any.
    faces: Option<Vec<[u32; 3]>>,
    input: Input,
}

impl<'m, R: Rule + 'm> Prepared<'m, R> {
    /// `None` where copies of vertices do not make it manifold, or a vertex has copies with more faces
    /// than anybody looks at.
    pub(super) fn new(rule: R, mesh: &'m Mesh, bounds: &Bounds, options: &Options) -> Option<Self> {
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
            duplicate_faces = split::drop_duplicates(&mut all, &fans.irregular);
            if duplicate_faces > 0 {
                fans = Fans::new::<R>((&places, Vec::new()), count, |i| all[i], weight);
            }
            faces = Some(all);
        }
        let irregular = std::mem::take(&mut fans.irregular);
        if let Some(all) = faces.as_mut().filter(|_| !irregular.is_empty()) {
            let Split { faces, copied } =
                split::split(std::mem::take(all), &irregular, places.len());
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
            flags.set(Flags::PINNED);
            flags.set(Flags::SPLIT);
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
                    None => vertices.settled(v).contains(&GHOST),
                };
            let flags = &mut vertices.get_mut(v).flags;
            match if on_boundary { Lock::Locked } else { lock } {
                Lock::Free => {}
                Lock::Protected => {
                    flags.set(Flags::PROTECTED);
                    self.input.held.protected += 1;
                }
                Lock::Locked => {
                    flags.set(Flags::PINNED);
                    self.input.held.locked += 1;
                }
            }
        }
        for copy in own..own + vertices.copied.len() as u32 {
            let of = vertices.get(vertices.origin(copy)).flags;
            vertices.get_mut(copy).flags.set(Flags(of.0 & Flags::PROTECTED.0));
        }
    }

    /// What was found in the input.
    pub(super) fn input(&self) -> Input {
        self.input
    }

    /// How many faces there are to work on.
    pub(super) fn live_faces(&self) -> usize {
        self.fans.faces
    }

    /// Costs all vertices of a mesh without attributes.
    pub(super) fn start_bare(self) -> Box<dyn Run + 'm> {
        let rule = self.rule;
        self.work(Bare(rule))
    }

    fn work<L: Looks + 'm>(self, looks: L) -> Box<dyn Run + 'm> {
        let Self { mesh, frame, order, fans, faces, .. } = self;
        let parts = Parts::new(fans.store, looks, fans.faces);
        Box::new(Work::new(Source { mesh, frame, order, faces }, parts))
    }
}

impl<'m> Prepared<'m, Memoryless> {
    /// Costs all vertices, and what is at them.
    pub(super) fn start(self, weights: &AttributeWeights) -> Box<dyn Run + 'm> {
        let faces = numbers(self.mesh, &self.order, self.faces.as_deref());
        let Some(corners) = Corners::new(self.mesh, faces, self.fans.store.all.len()) else {
            return self.start_bare();
        };
        let coat = Coat::new(self.mesh, &self.frame, weights, MOST_CHANNELS);
        match coat.channels() {
            0..=2 => self.paint::<2>(coat, corners),
            3 => self.paint::<3>(coat, corners),
            4..=5 => self.paint::<5>(coat, corners),
            _ => self.paint::<MOST_CHANNELS>(coat, corners),
        }
    }

    fn paint<const K: usize>(mut self, coat: Coat<'m>, corners: Corners<'m>) -> Box<dyn Run + 'm> {
        let faces = numbers(self.mesh, &self.order, self.faces.as_deref());
        let looks = Painted::<K>::new(coat, corners, &mut self.fans.store.whole(), faces);
        self.work(looks)
    }
}

fn boundary_weight(asked: f64) -> f32 {
    asked.min(MOST_BOUNDARY_WEIGHT) as f32
}

/// The faces of a mesh by the engine's names, or those on copies of vertices.
pub(super) fn numbers<'a>(
    mesh: &'a Mesh,
    order: &'a Order,
    split: Option<&'a [[u32; 3]]>,
) -> impl Iterator<Item = [u32; 3]> + Clone + 'a {
    (0..mesh.faces.len()).map(move |i| match split {
        Some(split) => split[i],
        None => order.face(&mesh.faces[i]),
    })
}

/// Whether all copies of some vertex have more faces together than the general engine looks at: each
/// time that one of them takes another vertex in, whoever observes would look at all.
fn is_crowded(fans: &mut Fans, irregular: &[u32]) -> bool {
    let first_copy = fans.store.own() as u32;
    let vertices = fans.store.whole();
    let mut faces: Vec<usize> = irregular.iter().map(|&v| vertices.settled(v).len()).collect();
    for (copy, of) in (first_copy..).zip(vertices.copied) {
        if let Ok(at) = irregular.binary_search(of) {
            faces[at] += vertices.settled(copy).len();
        }
    }
    faces.iter().any(|&faces| faces > MOST_FACES)
}
