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
/// Cost: O(n³), by going from short spans of the ring to long ones [BS95].
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

/// For each span of the ring, from one place to a later one, the best triangles between its points.
struct Spans<'a> {
    ring: &'a Ring,
    n: usize,
    /// Their cost, and the place of the third corner of the one at the edge that closes the span.
    best: Vec<Option<(Cost, usize)>>,
}

impl Spans<'_> {
    fn at(&self, place: usize) -> DVec3 {
        self.ring.points[place].into()
    }

    fn choose(&mut self, from: usize, to: usize) {
        let mut best: Option<(Cost, usize)> = None;
        for middle in from + 1..to {
            let Some(cost) = self.cost(from, middle, to) else { continue };
            if best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, middle));
            }
        }
        self.best[from * self.n + to] = best;
    }

    /// What a triangle and the best of both spans beside it cost.
    fn cost(&self, from: usize, middle: usize, to: usize) -> Option<Cost> {
        let [before, after] = [self.of(from, middle)?, self.of(middle, to)?];
        let corners = [from, middle, to].map(|place| self.at(place));
        let cross = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let area = 0.5 * cross.length();
        if !area.is_finite() || has_zero_area(corners.map(Into::into)) {
            return None;
        }
        let normal = cross.normalize_or_zero();
        let mut bend = before.bend.max(after.bend);
        bend = bend.max(self.bend(normal, from, middle)).max(self.bend(normal, middle, to));
        if to - from == self.n - 1 {
            bend =
                bend.max(bend_at(normal, [self.at(to), self.at(from)], self.ring.tips[to].into()));
        }
        Some(Cost { bend, area: before.area + after.area + area })
    }

    /// The cost of a span; an edge of the ring costs nothing.
    fn of(&self, from: usize, to: usize) -> Option<Cost> {
        if to == from + 1 {
            return Some(Cost { bend: 0.0, area: 0.0 });
        }
        self.best[from * self.n + to].map(|(cost, _)| cost)
    }

    /// The bend between a triangle and what lies across its edge from one place to a later one.
    fn bend(&self, normal: DVec3, from: usize, to: usize) -> f64 {
        let tip = match self.best[from * self.n + to] {
            Some((_, middle)) => self.at(middle),
            None => self.ring.tips[from].into(),
        };
        bend_at(normal, [self.at(from), self.at(to)], tip)
    }

    fn triangles(&self) -> Option<Vec<[usize; 3]>> {
        self.best[self.n - 1]?;
        let mut triangles = Vec::with_capacity(self.n - 2);
        let mut open = vec![(0, self.n - 1)];
        while let Some((from, to)) = open.pop() {
            let Some((_, middle)) = self.best[from * self.n + to] else { continue };
            triangles.push([from, middle, to]);
            open.extend([(from, middle), (middle, to)]);
        }
        Some(triangles)
    }
}

/// The bend between a triangle of a normal and the one across its edge, which goes the other way.
fn bend_at(normal: DVec3, [from, to]: [DVec3; 2], tip: DVec3) -> f64 {
    let across = (from - to).cross(tip - to).normalize_or_zero();
    1.0 - normal.dot(across)
}
