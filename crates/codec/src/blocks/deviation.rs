//! Distance of a moved vertex and its surroundings from the original surface, and back.

use glam::DVec3;
use rayon::prelude::*;

use super::original::OriginalSurface;

/// Limit on the faces around a vertex from which points are sampled. Without it, and without
/// [`SEARCHED`], the apex of a cone costs the square of its faces.
const SAMPLED: usize = 32;
/// Limit on the faces around a vertex that are searched for the closest point.
const SEARCHED: usize = 128;
/// Vertices that share a running maximum.
const CHUNK: usize = 4096;

/// Faces among which the closest point to a sample of a vertex's faces is sought.
pub(super) struct Neighbourhood<'s> {
    surface: &'s OriginalSurface,
    pub(super) vertex: usize,
    /// Faces around the vertex, then those around its neighbours, each once.
    faces: Vec<u32>,
}

/// What [`Neighbourhood::deviation`] need not tell apart: distances up to `enough`, and distances
/// of `most` and more.
#[derive(Clone, Copy)]
pub(super) struct Limits {
    pub(super) enough: f64,
    pub(super) most: f64,
}

impl OriginalSurface {
    /// Returns the largest deviation of all vertices.
    pub(super) fn max_deviation(&self, moved: &[DVec3]) -> f64 {
        let chunks = (0..self.places.len().div_ceil(CHUNK)).into_par_iter();
        let farthest = |chunk: usize| {
            let last = self.places.len().min((chunk + 1) * CHUNK);
            (chunk * CHUNK..last).fold(0.0, |enough: f64, v| {
                enough.max(self.deviation(v, moved, Limits { enough, most: f64::INFINITY }))
            })
        };
        chunks.map(farthest).reduce(|| 0.0, f64::max)
    }

    /// As [`Neighbourhood::deviation`], without a neighbourhood where no vertex moved far.
    pub(super) fn deviation(&self, vertex: usize, moved: &[DVec3], limits: Limits) -> f64 {
        if self.is_still(vertex, moved, limits.enough) {
            return 0.0;
        }
        Neighbourhood::new(self, vertex).deviation(moved, limits)
    }

    /// Returns true if neither a vertex nor a neighbour moved farther than `enough`.
    pub(super) fn is_still(&self, vertex: usize, moved: &[DVec3], enough: f64) -> bool {
        let is_short = |&v: &u32| moved[v as usize].length_squared() <= enough * enough;
        is_short(&(vertex as u32))
            && self.faces_around(vertex).all(|face| face.corners.iter().all(is_short))
    }
}

impl<'s> Neighbourhood<'s> {
    pub(super) fn new(surface: &'s OriginalSurface, vertex: usize) -> Self {
        let ring = surface.ring(vertex);
        let mut faces: Vec<u32> = ring.iter().take(SEARCHED).copied().collect();
        let around = faces.len();
        if around <= SAMPLED {
            let corners = ring.iter().flat_map(|&face| surface.faces[face as usize].corners);
            let others = corners.filter(|&corner| corner as usize != vertex);
            faces.extend(others.flat_map(|v| surface.ring(v as usize).iter().take(SAMPLED)));
            faces[around..].sort_unstable();
            let mut kept = around;
            for at in around..faces.len() {
                let face = faces[at];
                if !faces[..around].contains(&face) && faces[kept - 1] != face {
                    faces[kept] = face;
                    kept += 1;
                }
            }
            faces.truncate(kept);
        }
        Self { surface, vertex, faces }
    }

    /// Returns the largest distance between a vertex, or sample points of its edges and faces, and
    /// the other surface, in both directions.
    ///
    /// Returns 0 if it is at most `enough`, and infinity if it is `most` or more.
    pub(super) fn deviation(&self, moved: &[DVec3], limits: Limits) -> f64 {
        let v = self.vertex as u32;
        let mut most = limits.enough * limits.enough;
        let limit = limits.most * limits.most;
        if self.faces.is_empty() {
            // All its faces have no area.
            most = most.max(moved[self.vertex].length_squared());
        }
        for &face in self.faces.iter().take(self.surface.ring(self.vertex).len().min(SAMPLED)) {
            let a = self.surface.faces[face as usize].after(v);
            let b = self.surface.faces[face as usize].after(a);
            // The vertex, quarter points of an edge, and points within the face.
            for of in [
                [v, v, v, v],
                [v, v, v, a],
                [v, v, a, a],
                [v, a, a, a],
                [v, v, a, b],
                [v, a, a, b],
                [v, a, b, b],
            ] {
                most = most.max(self.squared_distance(of, face, moved, [most, limit]));
                if most >= limit {
                    return f64::INFINITY;
                }
            }
        }
        if most > limits.enough * limits.enough { most.sqrt() } else { 0.0 }
    }

    /// Returns the squared distance of the mean of four corners of a face from the other surface,
    /// or any number below `enough`, or any above `limit`.
    fn squared_distance(
        &self,
        of: [u32; 4],
        face: u32,
        moved: &[DVec3],
        [enough, limit]: [f64; 2],
    ) -> f64 {
        let places = &self.surface.places;
        let was = of.iter().map(|&v| places[v as usize]).sum::<DVec3>() * 0.25;
        let by = of.iter().map(|&v| moved[v as usize]).sum::<DVec3>() * 0.25;
        // It is this far from its original position at most.
        if by.length_squared() <= enough {
            return 0.0;
        }
        let place = |v: u32| places[v as usize];
        let to_was = self.nearest(was + by, face, place, enough);
        if to_was >= limit {
            return to_was;
        }
        to_was.max(self.nearest(was, face, |v| places[v as usize] + moved[v as usize], enough))
    }

    /// Returns the squared distance from a point of `own` to the nearest face, or to the first one
    /// that is near enough.
    fn nearest(&self, p: DVec3, own: u32, place: impl Fn(u32) -> DVec3, enough: f64) -> f64 {
        let mut nearest = f64::INFINITY;
        // Its own face is mostly near enough.
        for &face in [own].iter().chain(&self.faces) {
            let corners = self.surface.faces[face as usize].corners.map(&place);
            nearest = nearest.min(p.distance_squared(closest(p, corners)));
            if nearest <= enough {
                break;
            }
        }
        nearest
    }
}

/// Returns the point of a triangle that is closest to `p`.
fn closest(p: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let normal = (b - a).cross(c - a);
    let inside = |a: DVec3, b: DVec3| (b - a).cross(p - a).dot(normal) >= 0.0;
    if normal != DVec3::ZERO && inside(a, b) && inside(b, c) && inside(c, a) {
        return p - normal * ((p - a).dot(normal) / normal.length_squared());
    }
    let on = |a: DVec3, b: DVec3| {
        let along = b - a;
        let part = (p - a).dot(along) / along.length_squared();
        // An edge of length 0 gives NaN, which ends here as 0.
        a + along * if part > 0.0 { part.min(1.0) } else { 0.0 }
    };
    let nearer = |x: DVec3, y: DVec3| {
        if y.distance_squared(p) < x.distance_squared(p) { y } else { x }
    };
    nearer(nearer(on(a, b), on(b, c)), on(c, a))
}
