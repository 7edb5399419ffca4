//! Sharpness of the surface at each vertex, for the priorities of face constriction [LJ05].
//!
//! The turn of an edge is D = 1 − Na·Nb of its two faces, 0 to 2 (eq. 3). A vertex has the mean of
//! its edges' turns, and a weight derived from how they differ.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::{DVec3, Vec3};
use meshlod_mesh::{FaceId, VertexId};
use rayon::prelude::*;

use crate::engine::policy::Memory;
use crate::surface::contracted::Contracted;
use crate::surface::neighbourhood::Neighbourhood;
use crate::surface::{Flags, Placed, Surface};

/// Number of faces by which the turns of a hub are sampled.
const MOST_FACES: usize = 64;

/// Valence up to which a small buffer is enough; most vertices stay below.
const FEW_FACES: usize = 12;

/// Statistics of the turns of the surface at the edges of a vertex; a turn is 1 minus the cosine of
/// the angle between the normals of an edge's two faces.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Turns {
    /// Mean of the turns, G in [LJ05].
    pub(crate) mean: f64,
    /// Variance of the turns, VAR in [LJ05].
    pub(crate) variance: f64,
    /// Greatest deviation of a turn from the mean.
    pub(crate) farthest: f64,
}

impl Turns {
    fn of(turns: &[f32]) -> Self {
        if turns.is_empty() {
            return Self::default();
        }
        let mean = turns.iter().sum::<f32>() / turns.len() as f32;
        let (mut squares, mut farthest) = (0.0, 0.0f32);
        for turn in turns {
            let off = (turn - mean).abs();
            squares += off * off;
            farthest = farthest.max(off);
        }
        Self {
            mean: mean.into(),
            variance: (squares / turns.len() as f32).into(),
            farthest: farthest.into(),
        }
    }
}

/// Mean turn and weight of a vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crease {
    pub(crate) mean: f32,
    pub(crate) weight: f32,
}

/// Creases of a surface, computed on demand: half of those that a contraction changes are changed
/// again before they are read.
pub(crate) struct Creases {
    found: Vec<Cached>,
    normals: Vec<Vec3>,
    weigh: fn(&Turns) -> f64,
}

impl Creases {
    /// Prepares the creases of an unchanged surface; `weigh` computes a vertex's weight from its
    /// turns.
    pub(crate) fn new(surface: &Surface, weigh: fn(&Turns) -> f64) -> Self {
        let normal = |f: usize| unit_normal(surface, FaceId::new(f));
        Self {
            found: (0..surface.vertex_count()).map(|_| Cached::default()).collect(),
            normals: (0..surface.face_count()).into_par_iter().map(normal).collect(),
            weigh,
        }
    }

    /// Returns the unit normal of a face; zero for one without area.
    #[inline]
    pub(crate) fn normal(&self, face: FaceId) -> DVec3 {
        self.normals[face.index()].as_dvec3()
    }

    /// Returns the crease of a vertex.
    #[inline]
    pub(crate) fn at(&self, surface: &Surface, v: VertexId) -> Crease {
        let cached = &self.found[v.index()];
        cached.get().unwrap_or_else(|| {
            let turns = match surface.valence(v) {
                ..=FEW_FACES => turns::<FEW_FACES>(surface, &self.normals, v),
                _ => turns::<MOST_FACES>(surface, &self.normals, v),
            };
            cached.set(Crease { mean: turns.mean as f32, weight: (self.weigh)(&turns) as f32 })
        })
    }

    /// Returns the weighted mean of the vertices' mean turns (eqs. 2 and 6), 0 to 2; the plain mean
    /// if all weights are zero.
    #[inline]
    pub(crate) fn turn(&self, surface: &Surface, of: &Contracted) -> f64 {
        let (mut sum, mut weights, mut plain) = (0.0, 0.0, 0.0);
        for &v in of.iter() {
            let Crease { mean, weight } = self.at(surface, v);
            sum += f64::from(mean) * f64::from(weight);
            weights += f64::from(weight);
            plain += f64::from(mean);
        }
        if weights > 0.0 { sum / weights } else { plain / of.len() as f64 }
    }
}

impl Memory for Creases {
    const KNOWS_RING: bool = true;

    fn renew(&mut self, surface: &Surface, neighbourhood: &Neighbourhood, placed: &Placed) {
        for spoke in neighbourhood.spokes() {
            self.normals[spoke.face.index()] = unit_normal(surface, spoke.face);
        }
        let kept = neighbourhood.contracted()[placed.kept];
        for v in neighbourhood.ring().iter().map(|r| r.id).chain([kept]) {
            self.found[v.index()] = Cached::default();
        }
    }
}

fn unit_normal(surface: &Surface, face: FaceId) -> Vec3 {
    surface.area_normal(face).normalize_or_zero().as_vec3()
}

/// Lazily computed crease. Threads that compute it at the same time find the same value.
struct Cached(AtomicU64);

impl Default for Cached {
    fn default() -> Self {
        Self(AtomicU64::new(Self::NOTHING))
    }
}

impl Cached {
    /// Bits that encode no crease: a mean is never NaN.
    const NOTHING: u64 = u64::MAX;

    #[inline]
    fn get(&self) -> Option<Crease> {
        let bits = self.0.load(Ordering::Relaxed);
        let half = |shift: u32| f32::from_bits((bits >> shift) as u32);
        (bits != Self::NOTHING).then(|| Crease { mean: half(32), weight: half(0) })
    }

    fn set(&self, crease: Crease) -> Crease {
        let Crease { mean, weight } = crease;
        let bits = u64::from(mean.to_bits()) << 32 | u64::from(weight.to_bits());
        self.0.store(bits, Ordering::Relaxed);
        crease
    }
}

/// Computes the turns of the edges between the first `N` faces of a vertex.
fn turns<const N: usize>(surface: &Surface, normals: &[Vec3], v: VertexId) -> Turns {
    // For each face, the corners after and before the vertex, and the normal.
    let (mut next, mut last) = ([VertexId(0); N], [VertexId(0); N]);
    let mut normal = [Vec3::ZERO; N];
    let mut count = 0;
    for (face, place) in surface.star(v).zip(0..N) {
        let [a, b, c] = surface.face(face);
        (next[place], last[place]) = match v {
            _ if v == a => (b, c),
            _ if v == b => (c, a),
            _ => (a, b),
        };
        normal[place] = normals[face.index()];
        count = place + 1;
    }
    let (next, last, normal) = (&next[..count], &last[..count], &normal[..count]);
    let mut turns = [0.0; N];
    let mut found = 0;
    for (&to, ours) in next.iter().zip(normal) {
        // 1 − a·b of unit vectors, without its cancellation.
        let across = last.iter().zip(normal).find(|&(&other, _)| other == to);
        let turn = across.map(|(_, theirs)| 0.5 * (*ours - *theirs).length_squared());
        if let Some(turn) = turn.or_else(|| boundary_turn(surface, v, to, next, last)) {
            turns[found] = turn;
            found += 1;
        }
    }
    Turns::of(&turns[..found])
}

/// Returns the turn of the boundary where it leaves a vertex for `to`. It counts like that of an
/// edge; otherwise the corners of a boundary would be as cheap as its straight parts.
#[cold]
fn boundary_turn(
    surface: &Surface,
    v: VertexId,
    to: VertexId,
    next: &[VertexId],
    last: &[VertexId],
) -> Option<f32> {
    if !surface.flags(v).any(Flags::BOUNDARY) {
        return None;
    }
    let from = last.iter().find(|from| !next.contains(from))?;
    let [from, at, to] = [*from, v, to].map(|v| surface.position(v));
    Some((1.0 - (at - from).normalize_or_zero().dot((to - at).normalize_or_zero())) as f32)
}
