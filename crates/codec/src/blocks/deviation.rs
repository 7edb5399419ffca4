//! Distance of a moved vertex and its surroundings from the original surface, and back.

use glam::DVec3;
use meshlod_spatial::closest_point;
use rayon::prelude::*;

use super::original::OriginalSurface;

/// Limit on the faces around a vertex from which points are sampled. Without it, and without
/// [`SEARCHED`], the apex of a cone costs the square of its faces.
const SAMPLED: usize = 32;
/// Limit on the faces around a vertex that are searched for the closest point.
const SEARCHED: usize = 128;
/// Vertices that are examined first for the largest deviation.
const FIRST: usize = 64;
/// Other vertices that share a running maximum.
const CHUNK: usize = 4096;

/// Faces among which the closest point to a sample of a vertex's faces is sought.
pub(super) struct Neighbourhood<'s> {
    surface: &'s OriginalSurface,
    pub(super) vertex: usize,
    /// Faces around the vertex, then those around its neighbours, each once.
    faces: Vec<u32>,
}

/// Limits of [`Neighbourhood::deviation`]: it need not tell distances up to `enough` apart, nor those
/// of `most` and more.
#[derive(Clone, Copy)]
pub(super) struct Limits {
    pub(super) enough: f64,
    pub(super) most: f64,
}

impl OriginalSurface {
    /// Returns the largest deviation of all vertices.
    pub(super) fn max_deviation(&self, moved: &[DVec3]) -> f64 {
        let farther = |enough: f64, &v: &usize| {
            enough.max(self.deviation(v, moved, Limits { enough, most: f64::INFINITY }))
        };
        let mut vertices: Vec<usize> = (0..self.places.len()).collect();
        let first = FIRST.min(vertices.len());
        // With those that left their planes the most, few others need more than a glance.
        if first < vertices.len() {
            let far: Vec<f64> =
                vertices.par_iter().map(|&v| self.plane_distance(v, moved[v])).collect();
            vertices
                .select_nth_unstable_by(first, |&a, &b| far[b].total_cmp(&far[a]).then(a.cmp(&b)));
        }
        let (first, others) = vertices.split_at(first);
        let enough = first.iter().fold(0.0, farther);
        let chunks = others.par_chunks(CHUNK).map(|chunk| chunk.iter().fold(enough, farther));
        chunks.reduce(|| enough, f64::max)
    }

    /// As [`Neighbourhood::deviation`], with a glance first that spares most vertices the search.
    pub(super) fn deviation(&self, vertex: usize, moved: &[DVec3], limits: Limits) -> f64 {
        if self.is_near(vertex, moved, limits.enough) {
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
        let sampled = self.surface.ring(self.vertex).len().min(SAMPLED);
        for (at, &face) in self.faces[..sampled].iter().enumerate() {
            let a = self.surface.faces[face as usize].after(v);
            let b = self.surface.faces[face as usize].after(a);
            let mut near = [face; 2];
            // Quarter points of an edge, points within the face, and the vertex.
            let points = [[v, v, v, a], [v, v, a, a], [v, a, a, a], [v, v, a, b], [v, a, a, b]];
            let vertex = (at == 0).then_some([v; 4]);
            for of in vertex.into_iter().chain(points).chain([[v, a, b, b]]) {
                most = most.max(self.squared_distance(of, &mut near, moved, [most, limit]));
                if most >= limit {
                    return f64::INFINITY;
                }
            }
        }
        if most > limits.enough * limits.enough { most.sqrt() } else { 0.0 }
    }

    /// Returns the squared distance of the mean of four corners of a face from the other surface,
    /// or any number below `enough`, or any above `limit`.
    ///
    /// `near` has the faces that were near enough for the last point, in either direction.
    fn squared_distance(
        &self,
        of: [u32; 4],
        near: &mut [u32; 2],
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
        let [near_was, near_is] = near;
        let to_was = self.nearest(was + by, near_was, |v| places[v as usize], enough);
        if to_was >= limit {
            return to_was;
        }
        let place = |v: u32| places[v as usize] + moved[v as usize];
        to_was.max(self.nearest(was, near_is, place, enough))
    }

    /// Returns the squared distance from a point to the nearest face, or to the first one that is
    /// near enough, with `near` before all others.
    fn nearest(&self, p: DVec3, near: &mut u32, place: impl Fn(u32) -> DVec3, enough: f64) -> f64 {
        let mut nearest = (f64::INFINITY, *near);
        for &face in [*near].iter().chain(&self.faces) {
            let corners = self.surface.faces[face as usize].corners.map(&place);
            let distance = p.distance_squared(closest_point(p, &corners));
            if distance < nearest.0 {
                nearest = (distance, face);
            }
            if distance <= enough {
                break;
            }
        }
        *near = nearest.1;
        nearest.0
    }
}
