//! Triangulation of a hole that bends the surface least.

use glam::DVec3;

use crate::zero_area::has_zero_area;

/// Vertices around a hole, with the faces across its edges.
pub struct HoleOutline {
    /// Positions of the vertices, in the order in which the new triangles traverse them.
    pub points: Vec<[f64; 3]>,
    /// Third corner of the existing face at each edge of the hole, from each point to the next.
    pub tips: Vec<[f64; 3]>,
}

/// Cost of a triangulation: the sharpest bend between neighbours, including those across the
/// outline, then the area [Lie03].
#[derive(Clone, Copy, PartialEq, PartialOrd)]
struct Cost {
    /// 1 minus the cosine of the angle between normals; 0 if flat.
    bend: f64,
    area: f64,
}

/// Triangulates a hole without new points and returns the triangles as indices around the outline.
///
/// Minimizes the sharpest bend and, among equals, the area. No inner edge is one for which
/// `is_edge` returns true, as it exists already, and no triangle has zero area. `None` if there is
/// no such triangulation.
///
/// Cost: O(n³), by dynamic programming from short spans of the outline to long ones [BS95]; see
/// [`triangles_weighed`].
pub fn triangulate(
    outline: &HoleOutline,
    is_edge: impl Fn(usize, usize) -> bool,
) -> Option<Vec<[usize; 3]>> {
    let n = outline.points.len();
    if n < 3 {
        return None;
    }
    let mut spans = Spans { outline, n, best: vec![None; n * n] };
    for length in 2..n {
        for from in 0..n - length {
            let to = from + length;
            // The longest span is closed by an edge of the outline.
            if length < n - 1 && is_edge(from, to) {
                continue;
            }
            spans.choose(from, to);
        }
    }
    spans.triangles()
}

/// Returns the number of triangles that [`triangulate`] weighs for an outline of `points` points,
/// which determines its time.
pub fn triangles_weighed(points: usize) -> usize {
    points * points.saturating_sub(1) * points.saturating_sub(2) / 6
}

/// Best triangulations of all spans, a span being the points from one index to a later one.
struct Spans<'a> {
    outline: &'a HoleOutline,
    n: usize,
    /// Indexed by both ends in either order, so that spans from one end and to one end are
    /// contiguous.
    best: Vec<Option<Span>>,
}

/// Best triangulation of a span.
#[derive(Clone, Copy)]
struct Span {
    cost: Cost,
    /// Third corner of the triangle at the edge that closes the span.
    middle: u32,
    /// Normal of that triangle.
    normal: DVec3,
}

impl Spans<'_> {
    fn at(&self, index: usize) -> DVec3 {
        self.outline.points[index].into()
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

    /// Combines a triangle with the best triangulations of both spans beside it, if that costs less
    /// than `least`.
    fn span(&self, [from, middle, to]: [usize; 3], least: Option<Cost>) -> Option<Span> {
        let is_less = |cost: Cost| least.is_none_or(|least| cost < least);
        let [before, after] = [self.cost(from, middle)?, self.cost(to, middle)?];
        // For most triangles the spans beside them already cost too much; in flat holes the area
        // does.
        let sides = Cost { bend: before.bend.max(after.bend), area: before.area + after.area };
        if !is_less(sides) {
            return None;
        }
        let corners = [from, middle, to].map(|index| self.at(index));
        let cross = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let area = sides.area + 0.5 * cross.length();
        if !area.is_finite() || !is_less(Cost { bend: sides.bend, area }) {
            return None;
        }
        let normal = cross.normalize_or_zero();
        let bends = [self.bend(normal, from, middle), self.bend(normal, middle, to)];
        let mut bend = sides.bend.max(bends[0]).max(bends[1]);
        if to - from == self.n - 1 {
            let across = normal_across([self.at(to), self.at(from)], self.outline.tips[to].into());
            bend = bend.max(1.0 - normal.dot(across));
        }
        let cost = Cost { bend, area };
        let fits = is_less(cost) && !has_zero_area(corners.map(Into::into));
        fits.then_some(Span { cost, middle: middle as u32, normal })
    }

    /// Returns the cost of the span between two indices; an edge of the outline costs nothing.
    fn cost(&self, one: usize, other: usize) -> Option<Cost> {
        if one.abs_diff(other) == 1 {
            return Some(Cost { bend: 0.0, area: 0.0 });
        }
        self.best[one * self.n + other].map(|span| span.cost)
    }

    /// Returns the bend between a triangle and what lies across its edge from one index to a later
    /// one.
    fn bend(&self, normal: DVec3, from: usize, to: usize) -> f64 {
        let across = match self.best[from * self.n + to] {
            Some(span) => span.normal,
            None => normal_across([self.at(from), self.at(to)], self.outline.tips[from].into()),
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

/// Returns the normal of the triangle across an edge, which it traverses in the other direction.
fn normal_across([from, to]: [DVec3; 2], tip: DVec3) -> DVec3 {
    (from - to).cross(tip - to).normalize_or_zero()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Finds the best triangulation of a span by exhaustive search, with the cost of [`Spans`]; the
    /// triangle at the closing edge comes last.
    fn by_trying(outline: &HoleOutline, from: usize, to: usize) -> Option<(Cost, Vec<[usize; 3]>)> {
        if to == from + 1 {
            return Some((Cost { bend: 0.0, area: 0.0 }, Vec::new()));
        }
        let at = |place: usize| DVec3::from(outline.points[place]);
        let cross = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
        let normal = |corners| cross(corners).normalize_or_zero();
        let mut best: Option<(Cost, Vec<[usize; 3]>)> = None;
        for middle in from + 1..to {
            let sides = [[from, middle], [middle, to]].map(|[a, b]| by_trying(outline, a, b));
            let [Some(before), Some(after)] = sides else { continue };
            let corners = [from, middle, to].map(at);
            if has_zero_area(corners.map(Into::into)) {
                continue;
            }
            let mut bend = before.0.bend.max(after.0.bend);
            for ((_, triangles), [a, b]) in [(&before, [from, middle]), (&after, [middle, to])] {
                let across = match triangles.last() {
                    Some(triangle) => normal(triangle.map(at)),
                    None => normal([at(b), at(a), outline.tips[a].into()]),
                };
                bend = bend.max(1.0 - normal(corners).dot(across));
            }
            if to - from == outline.points.len() - 1 {
                let across = normal([at(from), at(to), outline.tips[to].into()]);
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
        /// On a small lattice, where many triangles are equally good or have no area, and off it.
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
            let outline = HoleOutline {
                points: points.iter().enumerate().map(place).collect(),
                tips: tips.iter().enumerate().map(place).take(points.len()).collect(),
            };
            let sorted = |mut triangles: Vec<[usize; 3]>| {
                triangles.sort_unstable();
                triangles
            };
            let found = triangulate(&outline, |_, _| false).map(sorted);
            prop_assert_eq!(found, by_trying(&outline, 0, points.len() - 1).map(|(_, all)| sorted(all)));
        }
    }
}
