//! The fast engine: `lindstrom-turk` of bare geometry at the speed of quadrics.
//!
//! It answers to the same rules as the general engine, which is its oracle, by other means: rings
//! instead of stars of faces, one queue entry a vertex instead of one an edge, floats, and costs from
//! nine numbers a vertex. docs/notes/fast-simplify.md tells why each of these.

mod cost;
mod engine;
mod fans;
mod frame;
mod hood;
mod lanes;
mod place;
mod queue;
mod ring;
mod split;
mod vertex;

use meshlod_mesh::{Bounds, Lock, Mesh, VertexId};

use crate::fast::engine::Engine;
use crate::fast::fans::Fans;
use crate::fast::frame::Frame;
use crate::fast::split::Split;
use crate::fast::vertex::Flags;
use crate::locks::Held;
use crate::options::{Method, Options, Report, SimplifyError, Target};
use crate::simplifier;
use crate::volume::VolumeLoss;

/// Whether [`simplify`] has a fast way for this; it takes the general engine's where it has not.
///
/// It has for `lindstrom-turk`, meshes without attributes, and locks that lock: no ties, nothing
/// protected, nothing that may vanish.
pub fn fits(mesh: &Mesh, options: &Options) -> bool {
    let Options { method, locks, vanish_below, .. } = options;
    *method == Method::LindstromTurk
        && mesh.attributes.is_none()
        && locks.ties.is_empty()
        && !locks.of_vertex.contains(&Lock::Protected)
        && vanish_below.is_none()
}

/// A coarser mesh, and what was done to get it, as [`crate::simplify`] gives it, several times as fast
/// where it [`fits`].
///
/// Vertices that are not manifold stay where they are. `volume` of the report is left empty, and its
/// estimate of the error is that of the costs alone, blind to tips that are cut off.
/// # Errors
/// As [`crate::simplify`].
pub fn simplify(
    mesh: &Mesh,
    target: Target,
    options: &Options,
) -> Result<(Mesh, Report), SimplifyError> {
    let bounds = simplifier::validate(mesh, options)?;
    let target = target.valid()?;
    let prepared = if fits(mesh, options) { Prepared::new(mesh, &bounds, options) } else { None };
    match prepared {
        Some(prepared) => Ok(prepared.simplify(target)),
        None => crate::simplify(mesh, target, options),
    }
}

/// A mesh about to be simplified.
struct Prepared<'m> {
    mesh: &'m Mesh,
    frame: Frame,
    fans: Fans,
    /// The faces on copies, where there are any.
    split: Option<Split>,
    non_manifold: usize,
    held: Held,
}

impl<'m> Prepared<'m> {
    /// `None` where copies of vertices do not make it manifold.
    fn new(mesh: &'m Mesh, bounds: &Bounds, options: &Options) -> Option<Self> {
        let frame = Frame::new(mesh, bounds);
        let places = mesh.positions.iter().map(|&p| frame.enter(p));
        let faces = mesh.faces.iter().map(corners);
        let mut fans = Fans::new(places.clone(), Vec::new(), faces.clone());
        let mut split = None;
        let irregular = std::mem::take(&mut fans.irregular);
        if !irregular.is_empty() {
            let parts = split::split(faces.collect(), &irregular, mesh.positions.len() as u32);
            let copies: Vec<_> =
                parts.copied.iter().map(|&v| frame.enter(mesh.positions[v as usize])).collect();
            let places: Vec<_> = places.chain(copies).collect();
            fans = Fans::new(places.into_iter(), parts.copied.clone(), parts.faces.iter().copied());
            if !fans.irregular.is_empty() {
                return None;
            }
            split = Some(parts);
        }
        let mut prepared =
            Self { mesh, frame, fans, split, non_manifold: irregular.len(), held: Held::default() };
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
        for v in 0..vertices.ghost {
            let on_boundary =
                options.lock_boundary && vertices.settled(v).contains(&vertices.ghost);
            if on_boundary || locks.get(v as usize) == Some(&Lock::Locked) {
                vertices.get_mut(v).flags.set(Flags::PINNED);
                self.held.locked += 1;
            }
        }
    }

    fn simplify(self, target: Target) -> (Mesh, Report) {
        let Self { mesh, frame, fans, split, non_manifold, held } = self;
        let duplicates = split.as_ref().map_or(0, |split| split.duplicates);
        let most_error = match target {
            Target::Error(error) => (error / frame.unit).powi(2),
            _ => f64::INFINITY,
        };
        let faces = target.faces_of(mesh.faces.len());
        let mut engine = Engine::new(fans.vertices, fans.faces, most_error);
        engine.run(faces);
        let report = Report {
            input_faces: mesh.faces.len(),
            degenerate_faces: mesh.faces.len() - fans.faces - duplicates,
            duplicate_faces: duplicates,
            non_manifold_vertices: non_manifold,
            held,
            output_faces: engine.live_faces,
            vanished: 0,
            reached: matches!(target, Target::Error(_)) || engine.live_faces <= faces,
            error_estimate: engine.error.sqrt() * frame.unit,
            refusals: engine.refusals,
            volume: VolumeLoss::default(),
        };
        (level(mesh, &frame, engine, split), report)
    }
}

/// The faces that are left, with what they use, in the input's order.
fn level(mesh: &Mesh, frame: &Frame, engine: Engine, split: Option<Split>) -> Mesh {
    let mut vertices = engine.vertices;
    let heirs: Vec<u32> = (0..vertices.all.len() as u32).map(|v| vertices.heir(v)).collect();
    let input = mesh.faces.iter().map(corners);
    let faces = match split {
        Some(split) => live(split.faces.iter().copied(), &heirs),
        None => live(input, &heirs),
    };
    let mut ids = vec![u32::MAX; vertices.ghost as usize];
    let mut level = Mesh::default();
    for (_, corners) in &faces {
        for &v in corners {
            ids[vertices.origin(v) as usize] = v;
        }
    }
    for (origin, id) in ids.iter_mut().enumerate().filter(|(_, id)| **id != u32::MAX) {
        let vertex = vertices.get(*id);
        let moved = vertex.flags.any(Flags::MOVED);
        level.positions.push(if moved {
            frame.leave(vertex.place())
        } else {
            mesh.positions[origin]
        });
        *id = level.positions.len() as u32 - 1;
    }
    let corner = |v: u32| VertexId(ids[vertices.origin(v) as usize]);
    level.faces = faces.iter().map(|&(_, [a, b, c])| [corner(a), corner(b), corner(c)]).collect();
    let kept: Vec<u32> = faces.iter().map(|&(face, _)| face).collect();
    level.materials = mesh.materials.as_ref().map(|labels| labels.select(&kept));
    level.objects = mesh.objects.as_ref().map(|labels| labels.select(&kept));
    level
}

/// The faces whose corners are still three, by what the corners have become.
fn live(faces: impl Iterator<Item = [u32; 3]>, heirs: &[u32]) -> Vec<(u32, [u32; 3])> {
    let heir = |v: u32| heirs[v as usize];
    let now = |(i, [a, b, c]): (usize, [u32; 3])| (i as u32, [heir(a), heir(b), heir(c)]);
    faces.enumerate().map(now).filter(|(_, [a, b, c])| a != b && b != c && c != a).collect()
}

/// A face's vertices as numbers. `map` over its array is not inlined, and was a tenth of all time.
fn corners(&[a, b, c]: &[VertexId; 3]) -> [u32; 3] {
    [a.0, b.0, c.0]
}
