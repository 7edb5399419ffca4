//! Update of attributes by a contraction away from seams, where slots are vertices.

use glam::{Vec3, Vec4};

use crate::kernel::attributes::attribute_quadric::AttributeQuadric;
use crate::kernel::attributes::scratch::Scratch;
use crate::kernel::attributes::wedge_quadrics::WedgeQuadrics;
use crate::kernel::collapse::edge_ring::{EdgeRing, ROOM, chunk, row3};
use crate::kernel::collapse::{Collapse, Ends, edge_ring};
use crate::kernel::mesh::one_ring::GHOST;
use crate::kernel::metric::Metric;
use crate::kernel::metric::edge_quadric::outer;
use crate::kernel::simd::{LANES, Row, Row3, TINY, sum_of, transpose_back};

impl<M: Metric, const K: usize> WedgeQuadrics<'_, M, K> {
    /// Applies the last preview of a contraction away from seams.
    #[inline(always)]
    pub(crate) fn apply_smooth(&mut self, edge_ring: &EdgeRing, collapse: &Collapse) {
        let Ends { v0, v1, .. } = collapse.ends;
        let (of_v0, of_v1) = (self.quadric(v0).values(), self.quadric(v1).values());
        let Self { quadrics, scratch, .. } = self;
        let values = scratch.values;
        let mut new = scratch.quadric_changes::<M, false>(
            edge_ring,
            collapse.displacement,
            [&of_v0, &of_v1, &values],
        );
        for (channel, value) in new.channels.iter_mut().zip(values) {
            channel.w = value;
        }
        let mut last = scratch.changes[edge_ring.len - 1];
        for i in 0..edge_ring.len {
            let change = scratch.changes[i];
            let id = edge_ring.ids[i];
            if id != GHOST {
                let quadric = quadrics.of_vertex_mut(id);
                quadric.add(&last);
                quadric.add(&change);
            }
            last = change;
        }
        for wing in [0, edge_ring.of_v0] {
            if edge_ring.ghost != Some(wing) {
                let quadric = quadrics.of_vertex_mut(edge_ring.ids[wing]);
                quadric.take(&dying_quadric::<M, K>(
                    edge_ring,
                    wing,
                    [&of_v0, &of_v1, &quadric.values()],
                ));
            }
        }
        *quadrics.of_vertex_mut(v0) = new;
        *self.merged_into.of_vertex_mut(v1) = v0;
        if collapse.displacement != Vec3::ZERO {
            *self.merged_into.of_vertex_mut(v0) = v0;
        }
    }
}

impl<const K: usize> Scratch<K> {
    /// Computes the change of each spoke's quadric, and at seams also its new quadric. Returns the
    /// sum over the new faces, which is used away from seams. There the values of both ends and of
    /// the new vertex are those of all apexes.
    #[inline(always)]
    // Long because it is one loop over lanes, whose rows stay in registers from end to end.
    pub(crate) fn quadric_changes<M: Metric, const SEAMS: bool>(
        &mut self,
        edge_ring: &EdgeRing,
        by: Vec3,
        [of_v0, of_v1, values]: [&[f32; K]; 3],
    ) -> AttributeQuadric<K> {
        let none = [0.0; LANES];
        let (mut sums, mut squares) = ([[none; 3]; K], [none; 7]);
        for start in edge_ring.lane_starts() {
            let spokes = edge_ring.spokes(start);
            let at_v1 = spokes.of_v1;
            let old = GradientFaces::new::<M>(
                &spokes,
                |lane| edge_ring.along * at_v1[lane],
                row3(&edge_ring.old, start),
            );
            let new = GradientFaces::new::<M>(&spokes, |_| by, row3(&edge_ring.new, start));
            let (mut changes, mut news) = ([[none; 3]; K], [[none; 3]; K]);
            let (mut was, mut now) = ([none; 6], [none; 6]);
            for k in 0..K {
                let to_a: &Row = chunk(&self.first[k], start);
                let (to_b, at_first, at_last): (&Row, Row, Row) = if SEAMS {
                    let (before, after) = (&self.before[k], &self.after[k]);
                    (chunk(&self.second[k], start), *chunk(before, start), *chunk(after, start))
                } else {
                    let mut at_first = none;
                    for lane in 0..LANES {
                        let part = at_v1[lane];
                        at_first[lane] = of_v0[k] * (1.0 - part) + of_v1[k] * part;
                    }
                    (chunk(&self.first[k], start + 1), at_first, [values[k]; LANES])
                };
                for lane in 0..LANES {
                    let (a, b) = (to_a[lane], to_b[lane]);
                    let before = old.slope(lane, a - at_first[lane], b - at_first[lane]);
                    let after = new.slope(lane, a - at_last[lane], b - at_last[lane]);
                    add_squares(&mut was, lane, before);
                    add_squares(&mut now, lane, after);
                    put(&mut changes[k], lane, after - before);
                    put(&mut news[k], lane, after);
                    for (sum, after) in sums[k].iter_mut().zip(after.to_array()) {
                        sum[lane] += after;
                    }
                }
            }
            let (mut change, mut after) = ([none; 7], [none; 7]);
            for lane in 0..LANES {
                for i in 0..6 {
                    after[i][lane] = now[i][lane] * new.scale[lane];
                    change[i][lane] = after[i][lane] - was[i][lane] * old.scale[lane];
                }
                after[6][lane] = new.weight[lane];
                change[6][lane] = new.weight[lane] - old.weight[lane];
                for (sum, after) in squares.iter_mut().zip(&after) {
                    sum[lane] += after[lane];
                }
            }
            write(&mut self.changes, start, &change, &changes);
            if SEAMS {
                write(&mut self.new, start, &after, &news);
            }
        }
        let [xx, yy, zz, xy, xz, yz, weight] = &squares;
        let mut quadric = AttributeQuadric::EMPTY;
        quadric.squares = [
            Vec4::new(sum_of(xx), sum_of(yy), sum_of(zz), sum_of(xy)),
            Vec4::new(sum_of(xz), sum_of(yz), sum_of(weight), 0.0),
        ];
        for (channel, [x, y, z]) in quadric.channels.iter_mut().zip(&sums) {
            *channel = Vec4::new(sum_of(x), sum_of(y), sum_of(z), 0.0);
        }
        quadric
    }
}

#[inline(always)]
fn put(rows: &mut [Row; 3], lane: usize, Vec3 { x, y, z }: Vec3) {
    (rows[0][lane], rows[1][lane], rows[2][lane]) = (x, y, z);
}

#[inline(always)]
fn add_squares(squares: &mut [Row; 6], lane: usize, slope: Vec3) {
    for (sum, square) in squares.iter_mut().zip(outer(slope)) {
        sum[lane] += square;
    }
}

/// Writes the quadrics of eight spokes.
#[inline(always)]
fn write<const K: usize>(
    to: &mut [AttributeQuadric<K>; ROOM],
    start: usize,
    squares: &[Row; 7],
    channels: &[[Row; 3]; K],
) {
    let none = [0.0; LANES];
    let [xx, yy, zz, xy, xz, yz, weight] = *squares;
    let first = transpose_back([xx, yy, zz, xy]);
    let second = transpose_back([xz, yz, weight, none]);
    for lane in 0..LANES {
        to[start + lane].squares = [first[lane], second[lane]];
    }
    for (k, &[x, y, z]) in channels.iter().enumerate() {
        let rows = transpose_back([x, y, z, none]);
        for lane in 0..LANES {
            to[start + lane].channels[k] = rows[lane];
        }
    }
}

/// Eight faces, and how a channel's gradient on them follows from its values.
struct GradientFaces {
    along_a: Row3,
    along_b: Row3,
    weight: Row,
    /// Inverse of the weight.
    scale: Row,
    /// Weight divided by the square of the normal.
    per_square: Row,
}

impl GradientFaces {
    /// A zero normal stands for no face.
    #[inline(always)]
    fn new<M: Metric>(
        spokes: &edge_ring::Spokes,
        apex: impl Fn(usize) -> Vec3,
        normals: Row3,
    ) -> Self {
        let none = [0.0; LANES];
        let mut faces = Self {
            along_a: Row3::ZERO,
            along_b: Row3::ZERO,
            weight: none,
            scale: none,
            per_square: none,
        };
        for lane in 0..LANES {
            let (apex, normal) = (apex(lane), normals.get(lane));
            let (weight, per_square) = M::face_weight(normal.dot(normal));
            faces.along_a.set(lane, (spokes.b.get(lane) - apex).cross(normal));
            faces.along_b.set(lane, normal.cross(spokes.a.get(lane) - apex));
            faces.weight[lane] = weight;
            faces.scale[lane] = (weight + TINY).recip();
            faces.per_square[lane] = per_square;
        }
        faces
    }

    /// Returns the gradient times the weight.
    #[inline(always)]
    fn slope(&self, lane: usize, to_a: f32, to_b: f32) -> Vec3 {
        (self.along_a.get(lane) * to_a + self.along_b.get(lane) * to_b) * self.per_square[lane]
    }
}

/// Returns the quadric of a dying face from the values at both ends and at the wing.
pub(crate) fn dying_quadric<M: Metric, const K: usize>(
    edge_ring: &EdgeRing,
    wing: usize,
    [v0, v1, other]: [&[f32; K]; 3],
) -> AttributeQuadric<K> {
    let (mut to_v1, mut to_wing) = ([0.0; K], [0.0; K]);
    for k in 0..K {
        (to_v1[k], to_wing[k]) = (v1[k] - v0[k], other[k] - v0[k]);
    }
    AttributeQuadric::face::<M>(edge_ring.along, edge_ring.relative(wing), to_v1, to_wing)
}
