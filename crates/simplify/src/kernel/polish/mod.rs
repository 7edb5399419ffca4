//! Fits the free vertices of a level to the input once more, all together.
//!
//! Contractions place each vertex by what the surface was just before, and forget the input. Here
//! points of the input pull on the faces of the level that are nearest to them, along the normals of
//! these faces, and all vertices move to where the sum of squared distances is least, if points
//! stay with their faces. The volume of each component is then what it was.
//!
//! | file | holds |
//! |---|---|
//! | `nearest` | the face of the level nearest to a point of the input |
//! | `fit` | sums of squared distances by face, and the moves that make them least |
//! | `volume` | the volume of components |

mod fit;
mod nearest;
mod volume;

use glam::{DVec3, Vec3};
use meshlod_mesh::{Connectivity, Mesh, VertexId};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::kernel::mesh::local_frame::Frame;
use fit::LevelFit;
use nearest::{Hit, NearestFaces};
use volume::Volumes;

/// Part of the weight of faces that their corners have; the middles have the rest. With middles
/// alone, means are up to 3 % greater.
const OF_CORNERS: f32 = 0.25;

/// Most points of the input for each face of the level.
const PER_FACE: usize = 40;

/// Number of points that are looked up at a time.
const BLOCK: usize = 1 << 16;

/// Largest displacement of a vertex, as a part of its shortest edge.
const FARTHEST: f64 = 0.4;

/// Smallest cosine by which a face may turn.
const MIN_COSINE: f64 = 0.7;

/// Displacements below this in the frame, in which the input's edges are about one long, are left
/// out: what is exact stays so.
const LEAST: f64 = 1e-3;

/// The input of a run, and where its vertices are in a level.
pub(crate) struct Origin<'a> {
    pub(crate) input: &'a Mesh,
    /// Vertex of the level that each vertex of the input was contracted into; `NO_VERTEX` if it has
    /// gone.
    pub(crate) heirs: &'a [u32],
    pub(crate) frame: Frame,
}

/// Moves vertices of a level of the input to where they fit it best, but for those that stay and
/// boundaries.
///
/// Cost: O(n) for n faces of the input.
pub(crate) fn polish(level: &mut Mesh, origin: &Origin<'_>, stays: &[bool]) {
    let connectivity = Connectivity::new(&level.faces, level.positions.len());
    let [on_seam, is_shared] = [on_seams(level), shared_places(level)];
    let is_free = |v: usize| {
        let is_held = stays[v] || on_seam[v] || is_shared[v];
        !is_held && !connectivity.marks(VertexId::new(v)).boundary()
    };
    let free: Vec<bool> = (0..level.positions.len()).map(is_free).collect();
    let nearest = NearestFaces::new(level, &connectivity, origin.frame);
    let mut fit = LevelFit::new(&nearest);
    origin.each_hit(&nearest, |hit| fit.add(&hit));
    let mut moves = fit.moves(&connectivity, &level.faces, &free);
    moves.iter_mut().filter(|by| by.length() < LEAST).for_each(|by| *by = DVec3::ZERO);
    moves.iter_mut().for_each(|by| *by *= origin.frame.unit);
    limit(&mut moves, level, &connectivity);
    fit.hold_worst(&mut moves, &level.faces, origin.frame.unit);
    let before = level.positions.clone();
    put_back_turned(level, &mut moves);
    let volumes = Volumes::new(level);
    for (at, by) in level.positions.iter_mut().zip(&moves) {
        *at = (DVec3::from(*at) + *by).into();
    }
    volumes.restore(level, &moves);
    volumes.put_back(level, &before, |face, now| has_turned(face, &before, now));
}

impl Origin<'_> {
    /// Looks up points of the input, and hands them on in a fixed order: the middles of its faces and
    /// a corner of every second one, or some of them, evenly, where there are many for each face of
    /// the level.
    fn each_hit(&self, nearest: &NearestFaces<'_>, mut see: impl FnMut(Hit)) {
        let Self { input, heirs, frame } = self;
        let place = |v: VertexId| frame.to_local(input.positions[v.index()]);
        let area = |[a, b, c]: [Vec3; 3]| (b - a).cross(c - a).length();
        let of_face = |face: [VertexId; 3]| {
            let corners = face.map(place);
            let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
            let weight = (1.0 - OF_CORNERS) * area(corners);
            nearest.hit(middle, face.map(|v| heirs[v.index()]), weight)
        };
        let of_corner = |face: [VertexId; 3], corner: VertexId| {
            let weight = 2.0 * OF_CORNERS * area(face.map(place));
            nearest.hit(place(corner), [heirs[corner.index()]; 3], weight)
        };
        let faces = input.faces.len();
        let all = faces + faces / 2;
        let count = all.min(PER_FACE * nearest.normals.len());
        let look = |i: usize| match i * all / count {
            i if i < faces => of_face(input.faces[i]),
            i => {
                let face = input.faces[2 * (i - faces)];
                of_corner(face, face[i % 3])
            }
        };
        for first in (0..count).step_by(BLOCK) {
            let block = first..(first + BLOCK).min(count);
            let hits: Vec<Option<Hit>> = block.into_par_iter().map(look).collect();
            hits.into_iter().flatten().for_each(&mut see);
        }
    }
}

/// Returns for each vertex whether charts, materials or objects meet there.
fn on_seams(level: &Mesh) -> Vec<bool> {
    let mut on_seam = vec![false; level.positions.len()];
    let mut first = vec![None; level.positions.len()];
    for (face, corners) in level.faces.iter().enumerate() {
        let labels =
            [&level.materials, &level.objects].map(|all| all.as_ref().map(|all| all.of(face)));
        let wedges = level.attributes.as_ref().map(|all| all.corners[face]);
        for (k, v) in corners.iter().enumerate() {
            let own = (labels, wedges.map(|wedges| wedges[k]));
            on_seam[v.index()] |= *first[v.index()].get_or_insert(own) != own;
        }
    }
    on_seam
}

/// Returns for each vertex whether another is at the same place: surfaces meet there.
fn shared_places(level: &Mesh) -> Vec<bool> {
    let mut is_shared = vec![false; level.positions.len()];
    let mut first: FxHashMap<[u64; 3], usize> = FxHashMap::default();
    for (v, at) in level.positions.iter().enumerate() {
        // Zero has two signs.
        let other = *first.entry(at.map(|x| (x + 0.0).to_bits())).or_insert(v);
        if other != v {
            (is_shared[v], is_shared[other]) = (true, true);
        }
    }
    is_shared
}

/// Shortens moves to what the edges around allow.
fn limit(moves: &mut [DVec3], level: &Mesh, connectivity: &Connectivity) {
    let place = |v: VertexId| DVec3::from(level.positions[v.index()]);
    for (v, by) in moves.iter_mut().enumerate().filter(|(_, by)| **by != DVec3::ZERO) {
        let v = VertexId::new(v);
        let around = connectivity.star(v).iter().flat_map(|face| level.faces[face.index()]);
        let lengths = around.filter(|&w| w != v).map(|w| place(w).distance_squared(place(v)));
        let most = FARTHEST * lengths.fold(f64::INFINITY, f64::min).sqrt();
        *by = by.clamp_length_max(most);
    }
}

/// Leaves out moves of the vertices of faces that would turn too far.
fn put_back_turned(level: &Mesh, moves: &mut [DVec3]) {
    loop {
        let place = |v: usize| DVec3::from(level.positions[v]) + moves[v];
        let moved: Vec<[f64; 3]> = (0..moves.len()).map(|v| place(v).into()).collect();
        let turned = level.faces.iter().filter(|face| has_turned(face, &level.positions, &moved));
        let turned: Vec<[VertexId; 3]> = turned.copied().collect();
        // Faces whose vertices all stay have not turned, so this ends.
        turned.iter().flatten().for_each(|v| moves[v.index()] = DVec3::ZERO);
        if turned.is_empty() {
            return;
        }
    }
}

/// Returns true if a face has turned too far. One without area may become anything.
fn has_turned(face: &[VertexId; 3], from: &[[f64; 3]], to: &[[f64; 3]]) -> bool {
    let [old, new] = [from, to].map(|positions| {
        let [a, b, c] = face.map(|v| DVec3::from(positions[v.index()]));
        (b - a).cross(c - a)
    });
    let is_same = face.iter().all(|v| from[v.index()] == to[v.index()]);
    !is_same && old.dot(new) < MIN_COSINE * old.length() * new.length()
}
