//! The triangles between the points of a ring that bend least.

use glam::DVec3;

use crate::zero_area::has_zero_area;

/// A ring of points, and what lies across its edges.
pub struct Ring {
    /// In the order in which triangles go round.
    pub points: Vec<[f64; 3]>,
    /// The tip of the triangle across the edge from each point to the next.
    pub tips: Vec<[f64; 3]>,
}

/// What a choice of triangles costs: the sharpest bend between neighbours, those across the ring
/// included, then the area [Lie03].
#[derive(Clone, Copy, PartialEq, PartialOrd)]
struct Cost {
    /// 1 less the cosine of the angle between normals, 0 where it is flat.
    bend: f64,
    area: f64,
}

/// The triangles that close a ring, as places around it: of all ways to use only its points, the one
/// that bends least where it bends most, and of these the one of least area.
///
/// No edge between points that are not next to each other is one of which `is_edge` says that it is
/// there already, and no triangle is without area. `None` where there is no such way.
///
/// Cost: O(n³), by going from short spans of the ring to long ones [BS95]; see [`triangles_weighed`].
pub fn patch(ring: &Ring, is_edge: impl Fn(usize, usize) -> bool) -> Option<Vec<[usize; 3]>> {
    let n = ring.points.len();
    if n < 3 {
        return None;
    }
    let mut spans = Spans { ring, n, best: vec![None; n * n] };
    for length in 2..n {
        for from in 0..n - length {
            let to = from + length;
            // The longest span is an edge of the ring.
            if length < n - 1 && is_edge(from, to) {
                continue;
            }
            spans.choose(from, to);
        }
    }
    spans.triangles()
}

/// How many triangles [`patch`] weighs for a ring of so many points: what its time grows with.
pub fn triangles_weighed(points: usize) -> usize {
    points * points.saturating_sub(1) * points.saturating_sub(2) / 6
}

/// For each span of the ring, from one place to a later one, the best triangles between its points.
struct Spans<'a> {
    ring: &'a Ring,
    n: usize,
    /// By both ends, either first: so that those from one place, and those to one, lie side by side.
    best: Vec<Option<Span>>,
}

/// The best triangles between the points of a span.
#[derive(Clone, Copy)]
struct Span {
    cost: Cost,
    /// The third corner of the triangle at the edge that closes the span.
    middle: u32,
    /// Its normal.
    normal: DVec3,
}

impl Spans<'_> {
    fn at(&self, place: usize) -> DVec3 {
        self.ring.points[place].into()
    }

    fn choose(&mut self, from: usize, to: usize) {
        let mut best: Option<Span> = None;
        for middle in from + 1..to {
            if let Some(span) = self.span([from, middle, to], best.map(|best| best.cost)) {
                best = Some(span);
            }
        }
        self.best[from * self.n + to] = best;
        self.best[to * self.n + from] = best;
    }

    /// A triangle and the best of both spans beside it, if that costs less than `least`.
    fn span(&self, [from, middle, to]: [usize; 3], least: Option<Cost>) -> Option<Span> {
        let is_less = |cost: Cost| least.is_none_or(|least| cost < least);
        let [before, after] = [self.cost(from, middle)?, self.cost(to, middle)?];
        // Of most, the sides alone cost too much; of what is flat, the area.
        let sides = Cost { bend: before.bend.max(after.bend), area: before.area + after.area };
        if !is_less(sides) {
            return None;
        }
        let corners = [from, middle, to].map(|place| self.at(place));
        let cross = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let area = sides.area + 0.5 * cross.length();
        if !area.is_finite() || !is_less(Cost { bend: sides.bend, area }) {
            return None;
        }
        let normal = cross.normalize_or_zero();
        let bends = [self.bend(normal, from, middle), self.bend(normal, middle, to)];
        let mut bend = sides.bend.max(bends[0]).max(bends[1]);
        if to - from == self.n - 1 {
            let across = normal_across([self.at(to), self.at(from)], self.ring.tips[to].into());
            bend = bend.max(1.0 - normal.dot(across));
        }
        let cost = Cost { bend, area };
        let fits = is_less(cost) && !has_zero_area(corners.map(Into::into));
        fits.then_some(Span { cost, middle: middle as u32, normal })
    }

    /// The cost of the span between two places; an edge of the ring costs nothing.
    fn cost(&self, one: usize, other: usize) -> Option<Cost> {
        if one.abs_diff(other) == 1 {
            return Some(Cost { bend: 0.0, area: 0.0 });
        }
        self.best[one * self.n + other].map(|span| span.cost)
    }

    /// The bend between a triangle and what lies across its edge from one place to a later one.
    fn bend(&self, normal: DVec3, from: usize, to: usize) -> f64 {
        let across = match self.best[from * self.n + to] {
            Some(span) => span.normal,
            None => normal_across([self.at(from), self.at(to)], self.ring.tips[from].into()),
        };
        1.0 - normal.dot(across)
    }

    fn triangles(&self) -> Option<Vec<[usize; 3]>> {
        self.best[self.n - 1]?;
        let mut triangles = Vec::with_capacity(self.n - 2);
        let mut open = vec![(0, self.n - 1)];
        while let Some((from, to)) = open.pop() {
            let Some(span) = self.best[from * self.n + to] else { continue };
            let middle = span.middle as usize;
            triangles.push([from, middle, to]);
            open.extend([(from, middle), (middle, to)]);
        }
        Some(triangles)
    }
}

/// The normal of the triangle across an edge, which it runs along the other way.
fn normal_across([from, to]: [DVec3; 2], tip: DVec3) -> DVec3 {
    (from - to).cross(tip - to).normalize_or_zero()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The best of a span by trying all, each as [`Spans`] does: the cost, and the triangles, the one
    /// at the closing edge last.
    fn by_trying(ring: &Ring, from: usize, to: usize) -> Option<(Cost, Vec<[usize; 3]>)> {
        if to == from + 1 {
            return Some((Cost { bend: 0.0, area: 0.0 }, Vec::new()));
        }
        let at = |place: usize| DVec3::from(ring.points[place]);
        let cross = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
        let normal = |corners| cross(corners).normalize_or_zero();
        let mut best: Option<(Cost, Vec<[usize; 3]>)> = None;
        for middle in from + 1..to {
            let sides = [[from, middle], [middle, to]].map(|[a, b]| by_trying(ring, a, b));
            let [Some(before), Some(after)] = sides else { continue };
            let corners = [from, middle, to].map(at);
            if has_zero_area(corners.map(Into::into)) {
                continue;
            }
            let mut bend = before.0.bend.max(after.0.bend);
            for ((_, triangles), [a, b]) in [(&before, [from, middle]), (&after, [middle, to])] {
                let across = match triangles.last() {
                    Some(triangle) => normal(triangle.map(at)),
                    None => normal([at(b), at(a), ring.tips[a].into()]),
                };
                bend = bend.max(1.0 - normal(corners).dot(across));
            }
            if to - from == ring.points.len() - 1 {
                let across = normal([at(from), at(to), ring.tips[to].into()]);
                bend = bend.max(1.0 - normal(corners).dot(across));
            }
            let area = before.0.area + after.0.area + 0.5 * cross(corners).length();
            let cost = Cost { bend, area };
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, [before.1, after.1, vec![[from, middle, to]]].concat()));
            }
        }
        best
    }

    proptest! {
        /// On a small lattice, where many triangles are as good or have no area, and off it.
        #[test]
        fn the_triangles_are_those_found_by_trying_all(
            points in prop::collection::vec(prop::array::uniform3(-2..3_i8), 3..9),
            tips in prop::collection::vec(prop::array::uniform3(-2..3_i8), 9),
            shift in prop::array::uniform9(0.0..1.0),
            shifts in any::<bool>(),
        ) {
            let place = |(i, p): (usize, &[i8; 3])| {
                let shift = if shifts { shift[i] } else { 0.0 };
                p.map(|x| f64::from(x) + shift * f64::from(x).sin())
            };
            let ring = Ring {
                points: points.iter().enumerate().map(place).collect(),
                tips: tips.iter().enumerate().map(place).take(points.len()).collect(),
            };
            let sorted = |mut triangles: Vec<[usize; 3]>| {
                triangles.sort_unstable();
                triangles
            };
            let found = patch(&ring, |_, _| false).map(sorted);
            prop_assert_eq!(found, by_trying(&ring, 0, points.len() - 1).map(|(_, all)| sorted(all)));
        }
    }
}
