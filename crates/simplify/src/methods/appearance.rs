//! Attributes in the quadrics [Hop99].
//!
//! Over a face every attribute is linear. So a face expects of a vertex not only that it is on its
//! plane, but that it has there the values that the face would have at that place. The faces around a
//! wedge expect different values; whatever value it takes, the least sum of squares is that of the
//! faces' deviations from their mean, a quadric in the position alone: the Schur complement of
//! [Hop99], written as a variance. Two wedges that become one add, for each attribute, the squared
//! difference of their means; so nothing large is ever subtracted.

use glam::DVec3;
use meshlod_mesh::{FaceId, VertexId, WedgeId};

use crate::contracted::Contracted;
use crate::methods::channels::Channels;
use crate::methods::quadric::Quadric;
use crate::neighbourhood::Neighbourhood;
use crate::policy::Memory;
use crate::surface::{Placed, Surface};
use crate::wedges::Wedges;

/// How much of what was expected a new wedge remembers; the rest is its faces as they are.
const MEMORY: f64 = 0.1;

/// Squared height of a face, against its longest edge, below which its attributes have no slope that
/// could be trusted.
const SLIVER: f64 = 1e-6;

/// What quadrics know of attributes: `()` for nothing.
pub(crate) trait Appearance: Memory {
    /// The cost of a contraction as a function of the position, seen from the first of the
    /// contracted, where the values may be what fits best.
    fn free(&self, geometry: Quadric, surface: &Surface, of: &Contracted) -> Quadric;

    /// The same where position and values stay those of one of the contracted.
    fn staying(
        &self,
        geometry: Quadric,
        surface: &Surface,
        of: &Contracted,
        kept: usize,
    ) -> Quadric;
}

impl Appearance for () {
    #[inline]
    fn free(&self, geometry: Quadric, _: &Surface, _: &Contracted) -> Quadric {
        geometry
    }

    #[inline]
    fn staying(&self, geometry: Quadric, _: &Surface, _: &Contracted, _: usize) -> Quadric {
        geometry
    }
}

/// One channel of a wedge: at `x` from its vertex the faces around expect, in the mean,
/// value + off + slope·x.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Channel {
    slope: DVec3,
    off: f64,
    value: f64,
}

impl Channel {
    /// The same, seen from `by` further and with another value.
    fn moved(self, by: DVec3, value: f64) -> Self {
        Self { off: self.off + self.slope.dot(by) + (self.value - value), value, ..self }
    }
}

/// What the faces around a wedge expect, and their weight: that of their areas.
#[derive(Clone, Debug, Default)]
struct Expected {
    weight: f64,
    channels: Vec<Channel>,
}

/// Attributes of a surface in quadrics.
pub(crate) struct Expectations {
    channels: Channels,
    count: usize,
    /// By wedge.
    weights: Vec<f64>,
    /// By wedge, `count` for each.
    expected: Vec<Channel>,
    /// By vertex: how far the faces around each of its wedges are from their mean.
    spreads: Vec<Quadric>,
    /// By vertex: its wedge, if it has one only.
    sole: Vec<Option<WedgeId>>,
    /// What a contraction makes, from before the surface changes until after.
    merged: Vec<(WedgeId, Expected)>,
    merged_spread: Quadric,
    merged_at: DVec3,
}

impl Expectations {
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
            sole: vec![None; surface.vertex_count()],
            merged: Vec::new(),
            merged_spread: Quadric::default(),
            merged_at: DVec3::ZERO,
            channels,
        };
        for v in (0..surface.vertex_count()).map(VertexId::new) {
            let corners = || surface.star(v).map(|face| (face, surface.corner(face, v)));
            this.sole[v.index()] = only(corners().map(|(face, k)| wedges.at(face, k)));
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

    /// Adds what a face expects of its corner k, at vertex v.
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

    /// The squared difference of what two wedges expect, seen from the vertex of `a`; that of `b` is
    /// `by` further.
    #[inline]
    fn between(&self, sum: &mut Quadric, a: WedgeId, b: WedgeId, by: DVec3) {
        let weight = harmonic(self.weights[a.index()], self.weights[b.index()]);
        for (a, b) in self.of(a).iter().zip(self.of(b)) {
            let off = (b.value - a.value) + (b.off - a.off) - b.slope.dot(by);
            sum.add_linear(b.slope - a.slope, off, weight);
        }
    }

    /// What the value of `kept` at its vertex costs by what `gone` expects, whose vertex is `by`
    /// further.
    #[inline]
    fn misfit(&self, kept: WedgeId, gone: WedgeId, by: DVec3) -> f64 {
        let off = |(kept, gone): (&Channel, &Channel)| {
            (gone.value - kept.value + gone.off - gone.slope.dot(by)).powi(2)
        };
        self.weights[gone.index()] * self.of(kept).iter().zip(self.of(gone)).map(off).sum::<f64>()
    }

    /// What the value of a wedge that stays costs by its own faces.
    #[inline]
    fn own_misfit(&self, wedge: WedgeId) -> f64 {
        self.weights[wedge.index()] * self.of(wedge).iter().map(|c| c.off * c.off).sum::<f64>()
    }

    /// The spreads at the ends of an edge, seen from the first, and how far on the second is.
    #[inline]
    fn spread(&self, surface: &Surface, [v0, v1]: [VertexId; 2]) -> (Quadric, DVec3) {
        let by = surface.position(v1) - surface.position(v0);
        (self.spreads[v0.index()] + self.spreads[v1.index()].seen_from(-by), by)
    }

    /// The wedges that meet along an edge.
    fn pairs(&self, surface: &Surface, ends: [VertexId; 2]) -> Vec<[WedgeId; 2]> {
        let mut pairs = Vec::with_capacity(4);
        surface.wedges.iter().for_each(|wedges| wedges.pair(surface, ends, &mut pairs));
        pairs
    }

    #[inline]
    fn sole_pair(&self, [v0, v1]: [VertexId; 2]) -> Option<[WedgeId; 2]> {
        Some([self.sole[v0.index()]?, self.sole[v1.index()]?])
    }

    /// What the wedges of an edge expect where they become those of its end `kept`; and the spread
    /// of it all, seen from there.
    fn join(
        &self,
        surface: &Surface,
        pairs: &[[WedgeId; 2]],
        ends: [VertexId; 2],
    ) -> (Vec<(WedgeId, Expected)>, Quadric) {
        let (mut spread, by) = self.spread(surface, ends);
        let mut joined: Vec<(WedgeId, Expected)> = Vec::with_capacity(pairs.len());
        for (i, &[kept, gone]) in pairs.iter().enumerate() {
            if joined.iter().all(|(wedge, _)| *wedge != kept) {
                let channels = self.of(kept).to_vec();
                joined.push((kept, Expected { weight: self.weights[kept.index()], channels }));
            }
            // One that meets several becomes the first.
            if pairs[..i].iter().all(|before| before[1] != gone) {
                let into = joined.iter_mut().find(|(wedge, _)| *wedge == kept);
                into.into_iter().for_each(|(_, into)| self.absorb(into, gone, by, &mut spread));
            }
        }
        (joined, spread)
    }

    /// Adds what `gone` expects, whose vertex is `by` further.
    fn absorb(&self, into: &mut Expected, gone: WedgeId, by: DVec3, spread: &mut Quadric) {
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

impl Appearance for Expectations {
    #[inline]
    fn free(&self, geometry: Quadric, surface: &Surface, of: &Contracted) -> Quadric {
        let &[v0, v1] = &of[..] else { return geometry };
        if let Some([a, b]) = self.sole_pair([v0, v1]) {
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
        let pairs = match self.sole_pair([v0, v1]) {
            Some(pair) => &[pair][..],
            None => &self.pairs(surface, [v0, v1]),
        };
        let misfit = |(i, pair): (usize, &[WedgeId; 2])| {
            let (stays, goes) = (pair[kept], pair[1 - kept]);
            let first = |end: usize| pairs[..i].iter().all(|before| before[end] != pair[end]);
            let own = if first(kept) { self.own_misfit(stays) } else { 0.0 };
            own + if first(1 - kept) { self.misfit(stays, goes, by) } else { 0.0 }
        };
        let misfit: f64 = pairs.iter().enumerate().map(misfit).sum();
        (geometry + sum).raised(misfit)
    }
}

impl Memory for Expectations {
    fn merge(&mut self, surface: &Surface, hood: &Neighbourhood, placed: &Placed) {
        let &[v0, v1] = &hood.contracted()[..] else { return };
        let swap = placed.kept == 1;
        let ends = if swap { [v1, v0] } else { [v0, v1] };
        let turn = |&[a, b]: &[WedgeId; 2]| if swap { [b, a] } else { [a, b] };
        let pairs: Vec<_> = hood.wedge_pairs.iter().map(turn).collect();
        (self.merged, self.merged_spread) = self.join(surface, &pairs, ends);
        self.merged_at = surface.position(ends[0]);
    }

    fn renew(&mut self, surface: &Surface, hood: &Neighbourhood, placed: &Placed) {
        let Some(wedges) = &surface.wedges else { return };
        let v = hood.contracted()[placed.kept];
        let by = placed.position - self.merged_at;
        let corners = || hood.spokes().iter().map(|spoke| (spoke.face, spoke.corner()));
        self.sole[v.index()] = only(corners().map(|(face, k)| wedges.at(face, k)));
        self.spreads[v.index()] = self.merged_spread.seen_from(by) * MEMORY;
        // One that met no other keeps no memory.
        for (face, k) in corners() {
            let wedge = wedges.at(face, k);
            self.start(wedges, wedge);
        }
        for (wedge, expected) in std::mem::take(&mut self.merged) {
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

impl Expectations {
    /// Gives a wedge its values as they are now, and nothing that is expected of it.
    fn start(&mut self, wedges: &Wedges, wedge: WedgeId) {
        self.weights[wedge.index()] = 0.0;
        let channels = &mut self.expected[wedge.index() * self.count..][..self.count];
        for (channel, value) in channels.iter_mut().zip(self.channels.values(wedges, wedge)) {
            *channel = Channel { value, ..Channel::default() };
        }
    }
}

/// The slope over a triangle of what is linear on it.
struct Slopes {
    /// Of a unit step to the first of the two other corners, and to the second.
    to: [DVec3; 2],
    area: f64,
}

impl Slopes {
    /// Of the triangle from the origin to `a` and `b`; none for a sliver.
    fn of(a: DVec3, b: DVec3) -> Option<Self> {
        let normal = a.cross(b);
        let squared = normal.length_squared();
        let longest = a.length_squared().max(b.length_squared()).max(a.distance_squared(b));
        (squared > SLIVER * longest * longest).then(|| Self {
            to: [b.cross(normal) / squared, normal.cross(a) / squared],
            area: 0.5 * squared.sqrt(),
        })
    }

    #[inline]
    fn slope(&self, to_a: f64, to_b: f64) -> DVec3 {
        self.to[0] * to_a + self.to[1] * to_b
    }
}

/// The weight of the squared difference of two means.
#[inline]
fn harmonic(a: f64, b: f64) -> f64 {
    let sum = a + b;
    if sum > 0.0 { a * (b / sum) } else { 0.0 }
}

/// The item that all are, if they are.
fn only(mut all: impl Iterator<Item = WedgeId>) -> Option<WedgeId> {
    let first = all.next()?;
    all.all(|other| other == first).then_some(first)
}
