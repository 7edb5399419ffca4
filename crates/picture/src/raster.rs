//! Exact rasterization of triangles, with integer edge functions.

use crate::project::{Point, SUBSTEPS};

/// Rectangle of samples; `end` is exclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SampleRect {
    pub start: [i32; 2],
    pub end: [i32; 2],
}

impl SampleRect {
    /// Intersects the rectangle with the bounding box of a triangle; empty if `start` is not below
    /// `end`.
    #[inline]
    pub(crate) fn clipped_to(&self, triangle: &[Point; 3]) -> Self {
        let [a, b, c] = triangle;
        let half = SUBSTEPS / 2;
        let first = |low: i32| (low + half - 1).div_euclid(SUBSTEPS);
        let after = |high: i32| (high - half).div_euclid(SUBSTEPS) + 1;
        Self {
            start: [
                self.start[0].max(first(a.x.min(b.x).min(c.x))),
                self.start[1].max(first(a.y.min(b.y).min(c.y))),
            ],
            end: [
                self.end[0].min(after(a.x.max(b.x).max(c.x))),
                self.end[1].min(after(a.y.max(b.y).max(c.y))),
            ],
        }
    }

    #[inline]
    pub(crate) fn is_empty(&self) -> bool {
        self.start[0] >= self.end[0] || self.start[1] >= self.end[1]
    }
}

/// Visits every sample in the rectangle that the triangle covers, with its nearness.
///
/// Top-left rule: a sample on an edge belongs to the triangle for which it is a top or left edge,
/// so triangles with a common edge cover each of its samples exactly once. Either orientation is
/// drawn.
///
/// # References
/// [Pin88] edge functions.
#[inline]
pub(crate) fn cover(
    triangle: &[Point; 3],
    window: &SampleRect,
    mut visit: impl FnMut(i32, i32, f32),
) {
    let window = window.clipped_to(triangle);
    if window.is_empty() {
        return;
    }
    let [a, mut b, mut c] = *triangle;
    let area = cross(a, b, c);
    if area == 0 {
        return;
    }
    if area < 0 {
        (b, c) = (c, b);
    }
    let slope = Slope::new(*triangle);
    let edges = [Edge::new(b, c), Edge::new(c, a), Edge::new(a, b)];
    let mut row = edges.each_ref().map(|edge| edge.at(window.start));
    for y in window.start[1]..window.end[1] {
        let mut here = row;
        for x in window.start[0]..window.end[0] {
            // The sign bit of the union is set if any of the three is negative.
            if here[0] | here[1] | here[2] >= 0 {
                visit(x, y, slope.at(x, y));
            }
            for (value, edge) in here.iter_mut().zip(&edges) {
                *value += edge.step_x;
            }
        }
        for (value, edge) in row.iter_mut().zip(&edges) {
            *value += edge.step_y;
        }
    }
}

/// Reports whether the corners of a triangle run clockwise on screen: its front faces away.
#[inline]
pub(crate) fn is_clockwise(&[a, b, c]: &[Point; 3]) -> bool {
    cross(a, b, c) > 0
}

/// Returns twice the area of a triangle, in square substeps; positive if clockwise on screen.
#[inline]
fn cross(a: Point, b: Point, c: Point) -> i64 {
    let [abx, aby] = [i64::from(b.x - a.x), i64::from(b.y - a.y)];
    let [acx, acy] = [i64::from(c.x - a.x), i64::from(c.y - a.y)];
    abx * acy - aby * acx
}

/// Edge function of a clockwise triangle: not negative on the inner side. The edge itself counts as
/// inside only if it is a top or left edge.
struct Edge {
    from: Point,
    step_x: i64,
    step_y: i64,
    bias: i64,
}

impl Edge {
    fn new(from: Point, to: Point) -> Self {
        let (dx, dy) = (i64::from(to.x - from.x), i64::from(to.y - from.y));
        let top_or_left = dy < 0 || (dy == 0 && dx > 0);
        let step = i64::from(SUBSTEPS);
        Self { from, step_x: -dy * step, step_y: dx * step, bias: i64::from(!top_or_left) }
    }

    fn at(&self, sample: [i32; 2]) -> i64 {
        let [x, y] = sample.map(|s| s * SUBSTEPS + SUBSTEPS / 2);
        let (dx, dy) = (self.step_y / i64::from(SUBSTEPS), self.step_x / -i64::from(SUBSTEPS));
        dx * i64::from(y - self.from.y) - dy * i64::from(x - self.from.x) - self.bias
    }
}

/// Nearness as a linear function over the samples.
#[derive(Debug, PartialEq)]
struct Slope {
    origin: [f64; 2],
    at_origin: f64,
    per_sample: [f64; 2],
    range: [f32; 2],
}

impl Slope {
    /// Computes the function with the corners in sorted order, so that two faces over the same
    /// three points are exactly equally near, and the lower id wins.
    fn new(mut corners: [Point; 3]) -> Self {
        corners.sort_unstable_by_key(|p| (p.x, p.y, p.nearness.to_bits()));
        let [a, b, c] = corners;
        let [abx, aby] = [f64::from(b.x - a.x), f64::from(b.y - a.y)];
        let [acx, acy] = [f64::from(c.x - a.x), f64::from(c.y - a.y)];
        let [ab, ac] = [b, c].map(|p| f64::from(p.nearness) - f64::from(a.nearness));
        let scale = f64::from(SUBSTEPS) / cross(a, b, c) as f64;
        let near = corners.map(|p| p.nearness);
        Self {
            origin: [a.x, a.y].map(|s| f64::from(s - SUBSTEPS / 2) / f64::from(SUBSTEPS)),
            at_origin: f64::from(a.nearness),
            per_sample: [(ab * acy - ac * aby) * scale, (ac * abx - ab * acx) * scale],
            range: [near[0].min(near[1]).min(near[2]), near[0].max(near[1]).max(near[2])],
        }
    }

    /// Evaluates the function, clamped to the range of the corners: slivers have unreliable slopes.
    #[inline]
    fn at(&self, x: i32, y: i32) -> f32 {
        let (dx, dy) = (f64::from(x) - self.origin[0], f64::from(y) - self.origin[1]);
        let nearness = self.at_origin + dx * self.per_sample[0] + dy * self.per_sample[1];
        (nearness as f32).clamp(self.range[0], self.range[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: i32, y: i32) -> Point {
        Point { x, y, nearness: 0.5 }
    }

    /// Number of triangles over `points` that cover each sample of a square.
    fn counts(points: &[Point], faces: &[[usize; 3]], side: i32) -> Vec<u32> {
        let window = SampleRect { start: [0, 0], end: [side, side] };
        let mut counts = vec![0; (side * side) as usize];
        for face in faces {
            cover(&face.map(|i| points[i]), &window, |x, y, _| {
                counts[(y * side + x) as usize] += 1
            });
        }
        counts
    }

    /// A small generator, enough to scatter points.
    fn scatter(state: &mut u64, below: i32) -> i32 {
        *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((*state >> 33) % below as u64) as i32
    }

    #[test]
    fn a_fan_covers_every_sample_of_its_square_once() {
        let side = 16;
        let far = side * SUBSTEPS;
        let mut state = 1;
        for round in 0..500 {
            // Every other round the middle lies on a sample, so that edges run through samples.
            let at = if round % 2 == 0 { 1 } else { SUBSTEPS / 2 };
            let mut inner = || (1 + scatter(&mut state, far / at - 1)) * at;
            let middle = point(inner(), inner());
            let points = [point(0, 0), point(far, 0), point(far, far), point(0, far), middle];
            // Orientation must not matter.
            let faces = [[0, 1, 4], [2, 1, 4], [2, 3, 4], [4, 3, 0]];
            let counts = counts(&points, &faces, side);
            assert!(counts.iter().all(|&n| n == 1), "{middle:?} {counts:?}");
        }
    }

    #[test]
    fn a_rumpled_grid_covers_every_inner_sample_once() {
        let (side, cells) = (32, 40);
        let (far, step) = (side * SUBSTEPS, side * SUBSTEPS / cells);
        let mut state = 7;
        let mut points = Vec::new();
        for i in 0..=cells {
            for j in 0..=cells {
                let inner = |k: i32| k > 0 && k < cells;
                let mut shift = |k| if inner(k) { scatter(&mut state, step / 3) } else { 0 };
                let edge = |k: i32| if k == cells { far } else { k * step };
                points.push(point(edge(i) + shift(i), edge(j) + shift(j)));
            }
        }
        let at = |i: i32, j: i32| (i * (cells + 1) + j) as usize;
        let faces: Vec<_> = (0..cells * cells)
            .flat_map(|k| {
                let (i, j) = (k / cells, k % cells);
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect();
        assert!(counts(&points, &faces, side).iter().all(|&n| n == 1));
    }

    #[test]
    fn a_line_and_a_point_cover_nothing() {
        let points = [point(0, 0), point(2560, 2560), point(1280, 1280)];
        assert_eq!(counts(&points, &[[0, 1, 2], [0, 0, 0]], 8), vec![0; 64]);
    }

    #[test]
    fn windows_agree_on_what_is_covered() {
        let triangle = [point(-300, 20), point(5000, 900), point(700, 4500)];
        let mut whole = Vec::new();
        let window = |start, end| SampleRect { start, end };
        cover(&triangle, &window([0, 0], [16, 16]), |x, y, near| whole.push((y, x, near)));
        let mut parts = Vec::new();
        for (sx, sy) in [(0, 0), (8, 0), (0, 8), (8, 8)] {
            let part = window([sx, sy], [sx + 8, sy + 8]);
            cover(&triangle, &part, |x, y, near| parts.push((y, x, near)));
        }
        parts.sort_by_key(|&(y, x, _)| (y, x));
        assert_eq!(whole, parts);
    }

    #[test]
    fn nearness_is_linear_between_the_corners() {
        let corner = |x, y, nearness| Point { x: x * 256 + 128, y: y * 256 + 128, nearness };
        let triangle = [corner(0, 0, 0.0), corner(8, 0, 0.8), corner(0, 8, 0.4)];
        cover(&triangle, &SampleRect { start: [0, 0], end: [9, 9] }, |x, y, near| {
            assert!((near - (0.1 * x as f32 + 0.05 * y as f32)).abs() < 1e-6, "{x} {y} {near}");
        });
    }

    #[test]
    fn nearness_does_not_depend_on_the_order_of_corners() {
        let mut state = 3;
        for _ in 0..100 {
            let mut corner = || {
                let [x, y] = [9000, 9000].map(|below| scatter(&mut state, below));
                Point { x, y, nearness: scatter(&mut state, 1 << 24) as f32 / 16_777_259.0 }
            };
            let [a, b, c] = [corner(), corner(), corner()];
            for turned in [[b, c, a], [c, a, b], [c, b, a], [b, a, c], [a, c, b]] {
                assert_eq!(Slope::new([a, b, c]), Slope::new(turned));
            }
        }
    }

    #[test]
    fn the_farthest_coordinates_do_not_overflow() {
        let far = 1 << 29;
        let triangle = [point(-far, -far), point(far, -far), point(0, far)];
        let mut covered = 0;
        let window = SampleRect { start: [0, 0], end: [4, 4] };
        cover(&triangle, &window, |_, _, _| covered += 1);
        assert_eq!(covered, 16);
    }
}
