//! How sharply the surface turns at each vertex, for the priorities of face constriction [LJ05].
//!
//! The turn of an edge is D = 1 − Na·Nb of its two faces, 0 to 2 (eq. 3). A vertex has the mean of
//! its edges' turns, and a weight made of how they differ.

use glam::{DVec3, Vec3};
use meshlod_mesh::{FaceId, VertexId};
use rayon::prelude::*;

use crate::contracted::Contracted;
use crate::neighbourhood::Neighbourhood;
use crate::policy::Memory;
use crate::surface::{Placed, Surface};

/// Vertices of more faces keep what was found of them: a hub would be gone through again for each
/// face of its rim.
const MOST_FACES: usize = 64;

/// The turns at a vertex.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Turns {
    /// G: their mean.
    pub(crate) mean: f64,
    /// VAR: their variance.
    pub(crate) variance: f64,
    /// The greatest difference of one from the mean.
    pub(crate) farthest: f64,
}

impl Turns {
    fn of(turns: impl Iterator<Item = f64> + Clone) -> Self {
        let count = turns.clone().count();
        if count == 0 {
            return Self::default();
        }
        let mean = turns.clone().sum::<f64>() / count as f64;
        let off = |turn: f64| (turn - mean).abs();
        Self {
            mean,
            variance: turns.clone().map(|turn| off(turn).powi(2)).sum::<f64>() / count as f64,
            farthest: turns.map(off).fold(0.0, f64::max),
        }
    }
}

/// The mean turn and the weight of a vertex.
#[derive(Clone, Copy, Debug, Default)]
struct Crease {
    mean: f32,
    weight: f32,
}

/// The creases of a surface, and the unit normals they come from.
pub(crate) struct Creases {
    at: Vec<Crease>,
    normals: Vec<Vec3>,
    weigh: fn(&Turns) -> f64,
    around: Vec<Edge>,
}

/// An edge at a vertex, as one of its faces has it.
#[derive(Clone, Copy)]
struct Edge {
    other: VertexId,
    face: FaceId,
}

impl Creases {
    /// Of an untouched surface; `weigh` makes a vertex's weight of its turns.
    pub(crate) fn new(surface: &Surface, weigh: fn(&Turns) -> f64) -> Self {
        let normals: Vec<Vec3> = (0..surface.face_count())
            .into_par_iter()
            .map(|f| unit_normal(surface, FaceId::new(f)))
            .collect();
        let crease = |around: &mut Vec<Edge>, v: usize| {
            crease(surface, &normals, weigh, VertexId::new(v), around)
        };
        let at = (0..surface.vertex_count()).into_par_iter().map_init(Vec::new, crease).collect();
        Self { at, normals, weigh, around: Vec::new() }
    }

    /// The unit normal of a face; zero for one without area.
    #[inline]
    pub(crate) fn normal(&self, face: FaceId) -> DVec3 {
        self.normals[face.index()].as_dvec3()
    }

    #[inline]
    pub(crate) fn weight(&self, v: VertexId) -> f64 {
        self.at[v.index()].weight.into()
    }

    /// The mean of the vertices' mean turns by their weights (eqs. 2 and 6): 0 to 2. Where none has
    /// any weight, all weigh the same.
    #[inline]
    pub(crate) fn turn(&self, of: &Contracted) -> f64 {
        let (mut sum, mut weights, mut plain) = (0.0, 0.0, 0.0);
        for v in of.iter() {
            let Crease { mean, weight } = self.at[v.index()];
            sum += f64::from(mean) * f64::from(weight);
            weights += f64::from(weight);
            plain += f64::from(mean);
        }
        if weights > 0.0 { sum / weights } else { plain / of.len() as f64 }
    }
}

impl Memory for Creases {
    const KNOWS_RING: bool = true;

    fn renew(&mut self, surface: &Surface, hood: &Neighbourhood, placed: &Placed) {
        for spoke in hood.spokes() {
            self.normals[spoke.face.index()] = unit_normal(surface, spoke.face);
        }
        let kept = hood.contracted()[placed.kept];
        for v in hood.ring().iter().map(|r| r.id).chain([kept]) {
            if surface.valence(v) <= MOST_FACES {
                self.at[v.index()] =
                    crease(surface, &self.normals, self.weigh, v, &mut self.around);
            }
        }
    }
}

fn unit_normal(surface: &Surface, face: FaceId) -> Vec3 {
    surface.area_normal(face).normalize_or_zero().as_vec3()
}

fn crease(
    surface: &Surface,
    normals: &[Vec3],
    weigh: fn(&Turns) -> f64,
    v: VertexId,
    around: &mut Vec<Edge>,
) -> Crease {
    around.clear();
    for face in surface.star(v) {
        let (corners, k) = (surface.face(face), surface.corner(face, v));
        let edge = |k: usize| Edge { other: corners[k % 3], face };
        around.extend([edge(k + 1), edge(k + 2)]);
    }
    around.sort_unstable_by_key(|edge| (edge.other, edge.face));
    let inner = around.windows(2).filter(|pair| pair[0].other == pair[1].other).map(|pair| {
        let [a, b] = [pair[0], pair[1]].map(|edge| normals[edge.face.index()]);
        // 1 − a·b of unit vectors, without its cancellation.
        f64::from(0.5 * (a - b).length_squared())
    });
    let turns = Turns::of(inner.chain(boundary_turn(surface, v, around)));
    Crease { mean: turns.mean as f32, weight: weigh(&turns) as f32 }
}

/// The turn of the boundary at a vertex on it, which counts like that of an edge: its corners would
/// otherwise be as cheap as its straights.
fn boundary_turn(surface: &Surface, v: VertexId, around: &[Edge]) -> Option<f64> {
    let mut ends =
        around.chunk_by(|a, b| a.other == b.other).filter(|edges| edges.len() == 1).map(|e| e[0]);
    let (a, b, None) = (ends.next()?, ends.next()?, ends.next()) else { return None };
    let [a, b] =
        [a, b].map(|e| (surface.position(e.other) - surface.position(v)).normalize_or_zero());
    Some(1.0 + a.dot(b))
}
