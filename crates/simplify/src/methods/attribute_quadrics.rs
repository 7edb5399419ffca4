//! Attribute quadrics [Hop99]: the attribute term of the quadric methods.
//!
//! Every attribute is linear over a face. So a face expects a vertex not only to lie on its plane,
//! but also to have the values that the face would have at that position. The faces around a wedge
//! expect different values. Whatever value it takes, the least sum of squares is that of the faces'
//! deviations from their mean, a quadric in the position alone: the Schur complement of [Hop99],
//! written as a variance. Merging two wedges adds, for each attribute, the squared difference of
//! their means, so nothing large is ever subtracted.

use glam::DVec3;
use meshlod_mesh::{FaceId, VertexId, WedgeId};

use crate::engine::policy::Memory;
use crate::methods::attribute_metric::AttributeMetric;
use crate::methods::channels::Channels;
use crate::methods::quadric::Quadric;
use crate::methods::slopes::Slopes;
use crate::surface::contracted::Contracted;
use crate::surface::neighbourhood::Neighbourhood;
use crate::surface::wedges::Wedges;
use crate::surface::{Placed, Surface};

/// Fraction of the accumulated quadric that a new wedge keeps; the rest comes from its current
/// faces. FLIP at 10 % of the faces, views of 512 pixels, weights of 0.01 and 0.3:
///
/// | memory | flight helmet | duck | pirate | spot | bream |
/// |---|---|---|---|---|---|
/// | 1 | .0805 | .1722 | .2640 | .1864 | .1733 |
/// | 0.5 | .0510 | .1576 | .2245 | .1725 | .1684 |
/// | 0.1 | .0504 | .1561 | .2167 | .1723 | .1653 |
/// | 0 | .0511 | .1547 | .2182 | .1764 | .1664 |
///
/// Wedges on seams and boundaries fade as well, because the attribute term has no constraint planes
/// to preserve.
const MEMORY: f64 = 0.1;

/// Linear function of one channel of a wedge: at `x` from its vertex the surrounding faces expect,
/// on average, value + off + slope·x.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Channel {
    slope: DVec3,
    off: f64,
    value: f64,
}

impl Channel {
    /// Returns the function relative to a vertex moved by `by`, with another value.
    fn moved(self, by: DVec3, value: f64) -> Self {
        Self { off: self.off + self.slope.dot(by) + (self.value - value), value, ..self }
    }
}

/// Mean attribute functions of the faces around a wedge, weighted by area.
#[derive(Clone, Debug, Default)]
struct WedgeQuadric {
    weight: f64,
    channels: Vec<Channel>,
}

/// Attribute quadrics of all wedges of a surface.
pub(crate) struct AttributeQuadrics {
    channels: Channels,
    count: usize,
    /// Total weight, by wedge.
    weights: Vec<f64>,
    /// Mean channel functions, `count` per wedge.
    expected: Vec<Channel>,
    /// Variance of the faces around each wedge, summed by vertex.
    spreads: Vec<Quadric>,
    /// Wedge of each vertex that has only one.
    single_wedge: Vec<Option<WedgeId>>,
    merged: Merged,
}

/// Result of a contraction, kept from before the surface changes until after.
#[derive(Default)]
struct Merged {
    wedges: Vec<(WedgeId, WedgeQuadric)>,
    spread: Quadric,
    /// Origin of the functions and of the variance.
    at: DVec3,
}

impl AttributeQuadrics {
    pub(crate) fn new(surface: &Surface, wedges: &Wedges, channels: Channels) -> Self {
        let count = channels.count();
        let value = |value| Channel { value, ..Channel::default() };
        let values = (0..wedges.count()).map(WedgeId::new);
        let expected = values.flat_map(|w| channels.values(wedges, w).map(value)).collect();
        let mut this = Self {
            count,
            weights: vec![0.0; wedges.count()],
            expected,
            spreads: vec![Quadric::default(); surface.vertex_count()],
            single_wedge: vec![None; surface.vertex_count()],
            merged: Merged::default(),
            channels,
        };
        for v in (0..surface.vertex_count()).map(VertexId::new) {
            let corners = || surface.star(v).map(|face| (face, surface.corner(face, v)));
            this.single_wedge[v.index()] = only(corners().map(|(face, k)| wedges.at(face, k)));
            for (face, k) in corners() {
                this.add_face(wedges, surface, (v, face, k), 1.0);
            }
        }
        this
    }

    #[inline]
    fn of(&self, wedge: WedgeId) -> &[Channel] {
        &self.expected[wedge.index() * self.count..][..self.count]
    }

    fn of_mut(&mut self, wedge: WedgeId) -> &mut [Channel] {
        &mut self.expected[wedge.index() * self.count..][..self.count]
    }

    /// Adds a face at its corner k, at vertex v.
    fn add_face(
        &mut self,
        wedges: &Wedges,
        surface: &Surface,
        (v, face, k): (VertexId, FaceId, usize),
        share: f64,
    ) {
        let corners = surface.face(face);
        let origin = surface.position(v);
        let [a, b] = [1, 2].map(|i| surface.position(corners[(k + i) % 3]) - origin);
        let Some(slopes) = Slopes::of(a, b) else { return };
        let of = wedges.of(face);
        let [own, at_a, at_b] = [0, 1, 2].map(|i| of[(k + i) % 3].index() * self.count);
        let weight = share * slopes.area;
        let total = self.weights[own / self.count] + weight;
        let part = weight / total;
        let between = weight - weight * part;
        let mut spread = self.spreads[v.index()];
        for i in 0..self.count {
            let channel = self.expected[own + i];
            let [to_a, to_b] = [at_a, at_b].map(|at| self.expected[at + i].value - channel.value);
            let slope = slopes.slope(to_a, to_b) - channel.slope;
            spread.add_linear(slope, -channel.off, between);
            self.expected[own + i].slope += slope * part;
            self.expected[own + i].off -= channel.off * part;
        }
        self.spreads[v.index()] = spread;
        self.weights[own / self.count] = total;
    }

    /// Adds the squared difference of two wedges' mean functions, relative to the vertex of `a`;
    /// the vertex of `b` is at `by`.
    #[inline]
    fn between(&self, sum: &mut Quadric, a: WedgeId, b: WedgeId, by: DVec3) {
        let weight = harmonic(self.weights[a.index()], self.weights[b.index()]);
        for (a, b) in self.of(a).iter().zip(self.of(b)) {
            let off = (b.value - a.value) + (b.off - a.off) - b.slope.dot(by);
            sum.add_linear(b.slope - a.slope, off, weight);
        }
    }

    /// Returns the squared residual of the value of `kept` at its vertex against the mean functions
    /// of `gone`, whose vertex is at `by`.
    #[inline]
    fn residual(&self, kept: WedgeId, gone: WedgeId, by: DVec3) -> f64 {
        let off = |(kept, gone): (&Channel, &Channel)| {
            (gone.value - kept.value + gone.off - gone.slope.dot(by)).powi(2)
        };
        self.weights[gone.index()] * self.of(kept).iter().zip(self.of(gone)).map(off).sum::<f64>()
    }

    /// Returns the squared residual of a wedge's value against the mean functions of its own faces.
    #[inline]
    fn own_residual(&self, wedge: WedgeId) -> f64 {
        self.weights[wedge.index()] * self.of(wedge).iter().map(|c| c.off * c.off).sum::<f64>()
    }

    /// Returns the variance at the ends of an edge, relative to the first, and the offset of the
    /// second.
    #[inline]
    fn spread(&self, surface: &Surface, [v0, v1]: [VertexId; 2]) -> (Quadric, DVec3) {
        let by = surface.position(v1) - surface.position(v0);
        (self.spreads[v0.index()] + self.spreads[v1.index()].seen_from(-by), by)
    }

    /// Returns the pairs of wedges that meet along an edge.
    fn pairs(&self, surface: &Surface, ends: [VertexId; 2]) -> Vec<[WedgeId; 2]> {
        let mut pairs = Vec::with_capacity(4);
        surface.wedges.iter().for_each(|wedges| wedges.pair(surface, ends, &mut pairs));
        pairs
    }

    #[inline]
    fn single_wedge_pair(&self, [v0, v1]: [VertexId; 2]) -> Option<[WedgeId; 2]> {
        Some([self.single_wedge[v0.index()]?, self.single_wedge[v1.index()]?])
    }

    /// Merges the wedges of an edge into those of its end `kept`. Returns the merged functions and
    /// the total variance, relative to that end.
    fn join(
        &self,
        surface: &Surface,
        pairs: &[[WedgeId; 2]],
        ends: [VertexId; 2],
    ) -> (Vec<(WedgeId, WedgeQuadric)>, Quadric) {
        let (mut spread, by) = self.spread(surface, ends);
        let mut joined: Vec<(WedgeId, WedgeQuadric)> = Vec::with_capacity(pairs.len());
        for (i, &[kept, gone]) in pairs.iter().enumerate() {
            if joined.iter().all(|(wedge, _)| *wedge != kept) {
                let channels = self.of(kept).to_vec();
                joined.push((kept, WedgeQuadric { weight: self.weights[kept.index()], channels }));
            }
            // A wedge that meets several becomes the first.
            if pairs[..i].iter().all(|before| before[1] != gone) {
                let into = joined.iter_mut().find(|(wedge, _)| *wedge == kept);
                into.into_iter().for_each(|(_, into)| self.absorb(into, gone, by, &mut spread));
            }
        }
        (joined, spread)
    }

    /// Adds the functions of `gone`, whose vertex is at `by`.
    fn absorb(&self, into: &mut WedgeQuadric, gone: WedgeId, by: DVec3, spread: &mut Quadric) {
        let weight = self.weights[gone.index()];
        let between = harmonic(into.weight, weight);
        into.weight += weight;
        let part = if into.weight > 0.0 { weight / into.weight } else { 0.0 };
        for (into, gone) in into.channels.iter_mut().zip(self.of(gone)) {
            let gone = gone.moved(-by, into.value);
            let (slope, off) = (gone.slope - into.slope, gone.off - into.off);
            spread.add_linear(slope, off, between);
            into.slope += slope * part;
            into.off += off * part;
        }
    }
}

impl AttributeMetric for AttributeQuadrics {
    #[inline]
    fn free(&self, geometry: Quadric, surface: &Surface, of: &Contracted) -> Quadric {
        let &[v0, v1] = &of[..] else { return geometry };
        if let Some([a, b]) = self.single_wedge_pair([v0, v1]) {
            let (mut sum, by) = self.spread(surface, [v0, v1]);
            self.between(&mut sum, a, b, by);
            return geometry + sum;
        }
        let pairs = self.pairs(surface, [v0, v1]);
        geometry + self.join(surface, &pairs, [v0, v1]).1
    }

    #[inline]
    fn staying(
        &self,
        geometry: Quadric,
        surface: &Surface,
        of: &Contracted,
        kept: usize,
    ) -> Quadric {
        let &[v0, v1] = &of[..] else { return geometry };
        let (sum, by) = self.spread(surface, [v0, v1]);
        let by = if kept == 0 { by } else { -by };
        let pairs = match self.single_wedge_pair([v0, v1]) {
            Some(pair) => &[pair][..],
            None => &self.pairs(surface, [v0, v1]),
        };
        let residual = |(i, pair): (usize, &[WedgeId; 2])| {
            let (stays, goes) = (pair[kept], pair[1 - kept]);
            let first = |end: usize| pairs[..i].iter().all(|before| before[end] != pair[end]);
            let own = if first(kept) { self.own_residual(stays) } else { 0.0 };
            own + if first(1 - kept) { self.residual(stays, goes, by) } else { 0.0 }
        };
        let residual: f64 = pairs.iter().enumerate().map(residual).sum();
        (geometry + sum).raised(residual)
    }
}

impl Memory for AttributeQuadrics {
    fn merge(&mut self, surface: &Surface, neighbourhood: &Neighbourhood, placed: &Placed) {
        let &[v0, v1] = &neighbourhood.contracted()[..] else { return };
        let swap = placed.kept == 1;
        let ends = if swap { [v1, v0] } else { [v0, v1] };
        let turn = |&[a, b]: &[WedgeId; 2]| if swap { [b, a] } else { [a, b] };
        let pairs: Vec<_> = neighbourhood.wedge_pairs.iter().map(turn).collect();
        let (wedges, spread) = self.join(surface, &pairs, ends);
        self.merged = Merged { wedges, spread, at: surface.position(ends[0]) };
    }

    fn renew(&mut self, surface: &Surface, neighbourhood: &Neighbourhood, placed: &Placed) {
        let Some(wedges) = &surface.wedges else { return };
        let v = neighbourhood.contracted()[placed.kept];
        let Merged { wedges: merged, spread, at } = std::mem::take(&mut self.merged);
        let by = placed.position - at;
        let corners = || neighbourhood.spokes().iter().map(|spoke| (spoke.face, spoke.corner()));
        self.single_wedge[v.index()] = only(corners().map(|(face, k)| wedges.at(face, k)));
        self.spreads[v.index()] = spread.seen_from(by) * MEMORY;
        // A wedge that met no other starts without memory.
        for (face, k) in corners() {
            let wedge = wedges.at(face, k);
            self.start(wedges, wedge);
        }
        for (wedge, expected) in merged {
            self.weights[wedge.index()] = expected.weight * MEMORY;
            for (channel, before) in self.of_mut(wedge).iter_mut().zip(expected.channels) {
                *channel = before.moved(by, channel.value);
            }
        }
        for (face, k) in corners() {
            self.add_face(wedges, surface, (v, face, k), 1.0 - MEMORY);
        }
    }
}

impl AttributeQuadrics {
    /// Resets a wedge to its current values, without any weight.
    fn start(&mut self, wedges: &Wedges, wedge: WedgeId) {
        self.weights[wedge.index()] = 0.0;
        let channels = &mut self.expected[wedge.index() * self.count..][..self.count];
        for (channel, value) in channels.iter_mut().zip(self.channels.values(wedges, wedge)) {
            *channel = Channel { value, ..Channel::default() };
        }
    }
}

/// Returns the weight of the squared difference of two means.
#[inline]
fn harmonic(a: f64, b: f64) -> f64 {
    let sum = a + b;
    if sum > 0.0 { a * (b / sum) } else { 0.0 }
}

/// Returns the common value if all items are equal.
fn only(mut all: impl Iterator<Item = WedgeId>) -> Option<WedgeId> {
    let first = all.next()?;
    all.all(|other| other == first).then_some(first)
}

#[cfg(test)]
mod tests {
    use meshlod_mesh::{Attributes, Connectivity, Layer, LayerKind, Mesh};
    use meshlod_samples as samples;

    use super::*;
    use crate::options::AttributeWeights;

    /// Torus with its positions as uvs.
    fn torus(uv: fn([f64; 3]) -> [f64; 2]) -> (Surface, AttributeQuadrics) {
        let mut mesh = samples::torus(300);
        let values = mesh.positions.iter().flat_map(|&p| uv(p)).map(|x| x as f32).collect();
        mesh.attributes = Some(Attributes {
            corners: mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect(),
            wedge_count: mesh.positions.len(),
            layers: vec![Layer { kind: LayerKind::Uv(0), name: String::new(), width: 2, values }],
        });
        start(&mesh)
    }

    fn start(mesh: &Mesh) -> (Surface, AttributeQuadrics) {
        let surface = Surface::new(mesh, &Connectivity::new(&mesh.faces, mesh.positions.len()));
        let weights = AttributeWeights { normal: 0.0, uv: 1.0, color: 0.0 };
        let channels = Channels::new(&surface, &weights).unwrap();
        let quadrics = AttributeQuadrics::new(&surface, surface.wedges.as_ref().unwrap(), channels);
        (surface, quadrics)
    }

    /// Value that each face around the vertices expects at `x` in a channel, with its area.
    fn expected(
        (surface, this): &(Surface, AttributeQuadrics),
        ends: [VertexId; 2],
        channel: usize,
        x: DVec3,
    ) -> Vec<(f64, f64)> {
        let of_face = |face: FaceId| {
            let [a, b, c] = surface.face(face).map(|v| surface.position(v));
            let normal = (b - a).cross(c - a);
            let shares = [(b, c), (c, a), (a, b)]
                .map(|(p, q)| (p - x).cross(q - x).dot(normal) / normal.length_squared());
            let values = surface.face(face).map(|v| this.of(WedgeId(v.0))[channel].value);
            (shares.iter().zip(values).map(|(s, v)| s * v).sum(), 0.5 * normal.length())
        };
        ends.iter().flat_map(|&v| surface.star(v)).map(of_face).collect()
    }

    fn squares(expected: &[(f64, f64)], value: f64) -> f64 {
        expected.iter().map(|(e, area)| area * (e - value).powi(2)).sum()
    }

    fn mean(expected: &[(f64, f64)]) -> f64 {
        let area: f64 = expected.iter().map(|(_, area)| area).sum();
        expected.iter().map(|(e, area)| e * area).sum::<f64>() / area
    }

    #[test]
    fn the_cost_is_that_of_the_best_value_by_all_faces_around() {
        let bent = torus(|[x, y, z]| [x * y + z * z, x - y * y]);
        let (surface, this) = &bent;
        for face in [0, 77, 200] {
            let [v0, v1, _] = surface.face(FaceId(face));
            let cost = this.free(Quadric::default(), surface, &Contracted::edge([v0, v1]));
            for x in [DVec3::ZERO, DVec3::new(0.1, -0.2, 0.05)] {
                let wanted: f64 = [0, 1]
                    .map(|i| expected(&bent, [v0, v1], i, surface.position(v0) + x))
                    .map(|all| squares(&all, mean(&all)))
                    .iter()
                    .sum();
                let found = cost.at(x);
                assert!(wanted > 1e-6 && (found - wanted).abs() < 1e-9, "{found}, not {wanted}");
            }
        }
    }

    #[test]
    fn what_stays_costs_by_its_own_value() {
        let bent = torus(|[x, y, z]| [x * y + z * z, x - y * y]);
        let (surface, this) = &bent;
        let [v0, v1, _] = surface.face(FaceId(42));
        for (kept, v) in [v0, v1].into_iter().enumerate() {
            let edge = Contracted::edge([v0, v1]);
            let cost = this.staying(Quadric::default(), surface, &edge, kept);
            let at = surface.position(v);
            let found = cost.at(at - surface.position(v0));
            let of = |i: usize| this.of(WedgeId(v.0))[i].value;
            let wanted: f64 =
                (0..2).map(|i| squares(&expected(&bent, [v0, v1], i, at), of(i))).sum();
            assert!(wanted > 1e-6 && (found - wanted).abs() < 1e-9, "{found}, not {wanted}");
        }
    }

    #[test]
    fn what_is_linear_on_a_flat_costs_nothing() {
        let mut mesh = meshlod_fixtures::grid(4);
        let uv = |p: &[f64; 3]| [p[0] as f32 + 100.0, (2.0 * p[1] - p[0]) as f32];
        mesh.attributes = Some(Attributes {
            corners: mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect(),
            wedge_count: mesh.positions.len(),
            layers: vec![Layer {
                kind: LayerKind::Uv(0),
                name: String::new(),
                width: 2,
                values: mesh.positions.iter().flat_map(uv).collect(),
            }],
        });
        let (surface, this) = start(&mesh);
        for face in 0..mesh.faces.len() {
            let [v0, v1, _] = surface.face(FaceId::new(face));
            let edge = Contracted::edge([v0, v1]);
            let cost = this.free(Quadric::default(), &surface, &edge);
            assert!(cost.at(DVec3::new(5.0, -3.0, 2.0)) < 1e-20);
        }
    }
}
