//! What a contraction would make of attributes, found before it is decided; and whether a face turns
//! over in its texture.
//!
//! A face that is left shall have the same sign of its area in uv as before, or next to no area there.
//! Else what the texture shows would be there twice, once the wrong way round.

use crate::kernel::attributes::scratch::Scratch;
use crate::kernel::attributes::wedge_quadrics::WedgeQuadrics;
use crate::kernel::collapse::edge_ring::{EdgeRing, chunk, row3};
use crate::kernel::collapse::{Collapse, Ends};
use crate::kernel::mesh::one_ring::{Vertices, is_seam};
use crate::kernel::metric::Metric;
use crate::kernel::simd::{LANES, Row, SimdTask};

/// The square of the area in the texture, as a part of that on the surface, that is none; where a length in
/// the texture is one on the surface.
const FLAT: f32 = 1.6e-3;

/// [`FLAT`] where a length in the texture is so many on the surface.
#[inline(always)]
fn flat(weight: f32) -> f32 {
    let area = weight * weight;
    FLAT * area * area
}

/// A look ahead where something around has a seam.
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
    /// Whether anything around has a seam.
    #[inline(always)]
    pub(crate) fn has_seam(&self, vertices: &Vertices, edge_ring: &EdgeRing, ends: Ends) -> bool {
        let any = |v: &u32| is_seam(vertices, *v);
        any(&ends.v0) || any(&ends.v1) || edge_ring.ids().iter().any(any)
    }

    /// Where nothing around has a seam: slots are vertices. Whether a face turns over in its texture.
    #[inline(always)]
    pub(crate) fn preview_smooth(&mut self, edge_ring: &EdgeRing, collapse: &Collapse) -> bool {
        let Ends { v0, v1, .. } = collapse.ends;
        self.scratch.values = self.values(collapse, [v0, v1]);
        let (of_v0, of_v1) = (self.quadric(v0).values(), self.quadric(v1).values());
        let Self { quadrics, scratch, none, layers, .. } = self;
        for i in 0..=edge_ring.len.next_multiple_of(LANES) {
            let id = edge_ring.ids[if i < edge_ring.len { i } else { 0 }];
            let quadric = quadrics.get(id as usize).unwrap_or(none);
            for (row, channel) in scratch.first.iter_mut().zip(&quadric.channels) {
                row[i] = channel.w;
            }
        }
        let flat = flat(layers.uv_weight);
        layers.uvs().any(|u| scratch.folds::<false>(edge_ring, (u, flat), [&of_v0, &of_v1]))
    }

    /// The same where something has.
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
            let of = |slot: u32| quadrics.get(slot as usize).unwrap_or(none).values();
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
    /// Whether more faces look the other way than most in the plane of two channels, from `u` on, than
    /// did before. Less than `flat` is no area.
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
                // Lanes past the end are faces of one point, and the ghost's have no area either.
                before.count(area(x0[lane], y0[lane]), old.dot(old), flat);
                after.count(area(x1[lane], y1[lane]), new.dot(new), flat);
            }
        }
        after.fewer() > before.fewer()
    }
}

/// How many faces look which way in a texture.
#[derive(Default)]
struct UvOrientations {
    up: u32,
    down: u32,
}

impl UvOrientations {
    /// Adds a face by twice its area in the texture, and the square of that on the surface.
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
