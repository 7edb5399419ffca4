//! Preview of the attributes after a contraction, with the test for faces flipped in texture space.
//!
//! A face shall keep the sign of its area in uv, or have next to none there. Otherwise a part of
//! the texture would be seen twice, once mirrored.

use crate::kernel::attributes::scratch::Scratch;
use crate::kernel::attributes::wedge_quadrics::WedgeQuadrics;
use crate::kernel::collapse::edge_ring::{EdgeRing, chunk, row3};
use crate::kernel::collapse::{Collapse, Ends};
use crate::kernel::mesh::one_ring::{Vertices, is_seam};
use crate::kernel::metric::Metric;
use crate::kernel::simd::{LANES, Row, SimdTask};

/// Square of the area in uv, relative to that on the surface, below which a face counts as flat,
/// for textures of weight one.
const FLAT: f32 = 1.6e-3;

/// Returns [`FLAT`] for textures of another weight.
#[inline(always)]
fn flat(weight: f32) -> f32 {
    let area = weight * weight;
    FLAT * area * area
}

/// SIMD task of a preview near a seam.
pub(crate) struct UvFlipsAtSeams<'a, 'm, 'v, M, const K: usize> {
    pub(crate) wedges: &'a mut WedgeQuadrics<'m, M, K>,
    pub(crate) vertices: &'a Vertices<'v>,
    pub(crate) edge_ring: &'a EdgeRing,
    pub(crate) collapse: &'a Collapse,
}

impl<M: Metric, const K: usize> SimdTask for UvFlipsAtSeams<'_, '_, '_, M, K> {
    type Output = bool;

    #[inline(always)]
    fn work(self) -> bool {
        self.wedges.preview_at_seams(self.vertices, self.edge_ring, self.collapse)
    }
}

impl<M: Metric, const K: usize> WedgeQuadrics<'_, M, K> {
    /// Returns true if an end of the edge or a vertex of its ring is on a seam.
    #[inline(always)]
    pub(crate) fn has_seam(&self, vertices: &Vertices, edge_ring: &EdgeRing, ends: Ends) -> bool {
        let any = |v: &u32| is_seam(vertices, *v);
        any(&ends.v0) || any(&ends.v1) || edge_ring.ids().iter().any(any)
    }

    /// Computes the new attribute values away from seams, where slots are vertices. Returns true if
    /// a face flips in texture space.
    #[inline(always)]
    pub(crate) fn preview_smooth(&mut self, edge_ring: &EdgeRing, collapse: &Collapse) -> bool {
        let Ends { v0, v1, .. } = collapse.ends;
        self.scratch.values = self.values(collapse, [v0, v1]);
        let (of_v0, of_v1) = (self.quadric(v0).values(), self.quadric(v1).values());
        let Self { quadrics, scratch, none, layers, .. } = self;
        for i in 0..=edge_ring.len.next_multiple_of(LANES) {
            let id = edge_ring.ids[if i < edge_ring.len { i } else { 0 }];
            let quadric = quadrics.of_vertex(id).unwrap_or(none);
            for (row, channel) in scratch.first.iter_mut().zip(&quadric.channels) {
                row[i] = channel.w;
            }
        }
        let flat = flat(layers.uv_weight);
        layers.uvs().any(|u| scratch.folds::<false>(edge_ring, (u, flat), [&of_v0, &of_v1]))
    }

    /// Computes the new values near a seam. Returns whether a face flips in uv.
    #[inline(always)]
    fn preview_at_seams(
        &mut self,
        vertices: &Vertices,
        edge_ring: &EdgeRing,
        collapse: &Collapse,
    ) -> bool {
        self.scratch.slots.find(&self.seams, vertices, edge_ring, &collapse.ends);
        self.find_values(collapse);
        let Self { quadrics, scratch, none, layers, .. } = self;
        for i in 0..edge_ring.len {
            let of = |slot: u32| quadrics.get(slot).unwrap_or(none).values();
            let [was, a, b] = scratch.slots.spokes[i].map(of);
            let apex = scratch.slots.apexes[i];
            let renewed = scratch.renewed.iter().find(|renewed| renewed.slot == apex);
            let now = renewed.map_or_else(|| of(apex), |renewed| renewed.values);
            for k in 0..K {
                scratch.first[k][i] = a[k];
                scratch.second[k][i] = b[k];
                scratch.before[k][i] = was[k];
                scratch.after[k][i] = now[k];
            }
        }
        let flat = flat(layers.uv_weight);
        layers.uvs().any(|u| scratch.folds::<true>(edge_ring, (u, flat), [&[0.0; K]; 2]))
    }
}

impl<const K: usize> Scratch<K> {
    /// Returns true if more faces face the minority side in the plane of the channels `u` and `u +
    /// 1` than before. Areas below `flat` do not count.
    #[inline(always)]
    fn folds<const SEAMS: bool>(
        &self,
        edge_ring: &EdgeRing,
        (u, flat): (usize, f32),
        ends: [&[f32; K]; 2],
    ) -> bool {
        let (mut before, mut after) = (UvOrientations::default(), UvOrientations::default());
        for start in edge_ring.lane_starts() {
            let corners = |k: usize| -> [Row; 4] {
                if SEAMS {
                    let (first, second) = (&self.first[k], &self.second[k]);
                    let (before, after) = (&self.before[k], &self.after[k]);
                    return [
                        *chunk(first, start),
                        *chunk(second, start),
                        *chunk(before, start),
                        *chunk(after, start),
                    ];
                }
                let (of_v1, mut before): (&Row, Row) =
                    (chunk(&edge_ring.of_v1, start), [0.0; LANES]);
                for lane in 0..LANES {
                    let part = of_v1[lane];
                    before[lane] = ends[0][k] * (1.0 - part) + part * ends[1][k];
                }
                let first = &self.first[k];
                [*chunk(first, start), *chunk(first, start + 1), before, [self.values[k]; LANES]]
            };
            let ([ax, bx, x0, x1], [ay, by, y0, y1]) = (corners(u), corners(u + 1));
            let (old, new) = (row3(&edge_ring.old, start), row3(&edge_ring.new, start));
            for lane in 0..LANES {
                let area = |x: f32, y: f32| {
                    (ax[lane] - x) * (by[lane] - y) - (ay[lane] - y) * (bx[lane] - x)
                };
                let (old, new) = (old.get(lane), new.get(lane));
                // Lanes beyond the end are degenerate, and the ghost's faces have no area either.
                before.count(area(x0[lane], y0[lane]), old.dot(old), flat);
                after.count(area(x1[lane], y1[lane]), new.dot(new), flat);
            }
        }
        after.fewer() > before.fewer()
    }
}

/// Number of faces by orientation in uv.
#[derive(Default)]
struct UvOrientations {
    up: u32,
    down: u32,
}

impl UvOrientations {
    /// Counts a face by twice its area in uv and the square of that on the surface.
    #[inline(always)]
    fn count(&mut self, area: f32, on_surface: f32, flat: f32) {
        let counts = (area * area > on_surface * flat) & (on_surface > 0.0);
        self.up += u32::from(counts & (area > 0.0));
        self.down += u32::from(counts & (area < 0.0));
    }

    fn fewer(&self) -> u32 {
        self.up.min(self.down)
    }
}
