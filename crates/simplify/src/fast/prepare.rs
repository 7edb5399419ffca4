//! From a mesh to vertices with rings, in the engine's frame.

use meshlod_mesh::{Bounds, Lock, Mesh, VertexId};

use crate::clean;
use crate::fast::engine::Engine;
use crate::fast::fans::Fans;
use crate::fast::frame::Frame;
use crate::fast::split::{self, Split};
use crate::fast::vertex::Flags;
use crate::fast::work::Work;
use crate::locks::Held;
use crate::options::Options;
use crate::simplifier::Input;
use crate::surface::MOST_FACES;

/// A mesh about to be simplified.
pub(super) struct Prepared<'m> {
    mesh: &'m Mesh,
    frame: Frame,
    fans: Fans,
    /// The faces on copies of vertices, or without those that repeat another, where there are any.
    faces: Option<Vec<[u32; 3]>>,
    input: Input,
}

impl<'m> Prepared<'m> {
    /// `None` where copies of vertices do not make it manifold, or a vertex has copies with more faces
    /// than anybody looks at.
    pub(super) fn new(mesh: &'m Mesh, bounds: &Bounds, options: &Options) -> Option<Self> {
        let frame = Frame::new(mesh, bounds);
        let mut fans = fans_of(mesh, &frame, mesh.faces.iter().map(corners), Vec::new());
        let degenerate_faces = mesh.faces.len() - fans.faces;
        let (mut faces, mut duplicate_faces) = (None, 0);
        if !fans.irregular.is_empty() {
            let mut all: Vec<_> = mesh.faces.iter().map(corners).collect();
            duplicate_faces = split::drop_duplicates(&mut all, &fans.irregular);
            if duplicate_faces > 0 {
                fans = fans_of(mesh, &frame, all.iter().copied(), Vec::new());
            }
            faces = Some(all);
        }
        let irregular = std::mem::take(&mut fans.irregular);
        if let Some(all) = faces.as_mut().filter(|_| !irregular.is_empty()) {
            let Split { faces, copied } =
                split::split(std::mem::take(all), &irregular, mesh.positions.len() as u32);
            fans = fans_of(mesh, &frame, faces.iter().copied(), copied);
            *all = faces;
            if !fans.irregular.is_empty() || is_crowded(&fans, &irregular) {
                return None;
            }
        }
        let input = Input {
            degenerate_faces,
            duplicate_faces,
            non_manifold_vertices: irregular.len(),
            held: Held::default(),
        };
        let mut prepared = Self { mesh, frame, fans, faces, input };
        prepared.pin(&irregular);
        prepared.lock(options);
        Some(prepared)
    }

    /// Holds the copies of vertices together.
    fn pin(&mut self, irregular: &[u32]) {
        let vertices = &mut self.fans.vertices;
        let copies = vertices.ghost + 1..vertices.all.len() as u32;
        for v in irregular.iter().copied().chain(copies) {
            let flags = &mut vertices.get_mut(v).flags;
            flags.set(Flags::PINNED);
            flags.set(Flags::SPLIT);
        }
    }

    fn lock(&mut self, options: &Options) {
        let vertices = &mut self.fans.vertices;
        let locks = &options.locks.of_vertex;
        // Where copies end, the surface may go on.
        let with_copies = options.lock_boundary && self.input.non_manifold_vertices > 0;
        let connectivity = with_copies.then(|| clean::connect(self.mesh).0);
        for v in 0..vertices.ghost {
            let on_boundary = options.lock_boundary
                && match &connectivity {
                    Some(connectivity) => connectivity.marks(VertexId(v)).boundary(),
                    None => vertices.settled(v).contains(&vertices.ghost),
                };
            if on_boundary || locks.get(v as usize) == Some(&Lock::Locked) {
                vertices.get_mut(v).flags.set(Flags::PINNED);
                self.input.held.locked += 1;
            }
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

    /// Costs all vertices.
    pub(super) fn start(self) -> Work<'m> {
        let Self { mesh, frame, fans, faces, .. } = self;
        Work::new(mesh, frame, faces, Engine::new(fans.vertices, fans.faces))
    }
}

fn fans_of(
    mesh: &Mesh,
    frame: &Frame,
    faces: impl Iterator<Item = [u32; 3]>,
    copied: Vec<u32>,
) -> Fans {
    let places = mesh.positions.iter().map(|&position| frame.enter(position));
    if copied.is_empty() {
        return Fans::new(places, copied, faces);
    }
    let copies = copied.iter().map(|&v| frame.enter(mesh.positions[v as usize]));
    let places: Vec<_> = places.chain(copies).collect();
    Fans::new(places.into_iter(), copied, faces)
}

/// Whether all copies of some vertex have more faces together than the general engine looks at: each
/// time that one of them takes another vertex in, whoever observes would look at all.
fn is_crowded(fans: &Fans, irregular: &[u32]) -> bool {
    let vertices = &fans.vertices;
    let mut faces: Vec<usize> = irregular.iter().map(|&v| vertices.settled(v).len()).collect();
    for (copy, of) in (vertices.ghost + 1..).zip(&vertices.copied) {
        if let Ok(at) = irregular.binary_search(of) {
            faces[at] += vertices.settled(copy).len();
        }
    }
    faces.iter().any(|&faces| faces > MOST_FACES)
}

/// A face's vertices as numbers. `map` over its array is not inlined, and was a tenth of all time.
pub(super) fn corners(&[a, b, c]: &[VertexId; 3]) -> [u32; 3] {
    [a.0, b.0, c.0]
}
