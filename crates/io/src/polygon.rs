//! Triangulation of convex and concave polygons, always into `n - 2` triangles, with bounded work.

use std::ops::RangeInclusive;

use glam::{DVec2, DVec3};
use meshlod_mesh::Buckets;

/// Budget of tips, cells and points to examine per corner of the polygon; once it is spent, the
/// rest becomes a fan. Only adversarial polygons reach it: 10^5 corners then take about 0.5 s.
const LOOKS_PER_CORNER: usize = 1000;

/// A quad is split along corners 1–3 only when that diagonal is clearly the shorter one, so that
/// the rounding of a regular grid does not turn its diagonals at random.
const CLEARLY_SHORTER: f64 = 1.0 - 1e-6;

/// Splits a polygon and appends `n - 2` triangles to `out`, each as three *positions in `polygon`*
/// (`0..n`, not vertex indices), so that a corner's attributes can follow.
///
/// Every triangle keeps the polygon's orientation, and its first corner comes first where possible.
/// A triangle passes through as `[0, 1, 2]`. A quad is split along its shorter diagonal if that one
/// lies inside, else along the other. A larger polygon is split by ear clipping in the coordinate
/// plane it is most parallel to. Collinear corners and repeated vertices keep their triangles
/// (possibly of zero area), and keyholes are followed. A self-intersecting or zero-area remainder
/// becomes a fan. Fewer than three corners give nothing.
///
/// Every entry of `polygon` must be an index into `positions`. Cost: O(n) for convex polygons,
/// about O(n log n) for usual ones, never above `LOOKS_PER_CORNER`·n.
/// # References
/// [Mei75] (two ears); [Ebe02] for the reflex-only containment test; differs: a grid over the
/// reflex corners, a limit on the work, no corner is dropped.
pub fn triangulate(positions: &[[f64; 3]], polygon: &[u32], out: &mut Vec<[u32; 3]>) {
    match polygon.len() {
        0..=2 => {}
        3 => out.push([0, 1, 2]),
        4 => {
            let corner = |i: usize| DVec3::from(positions[polygon[i] as usize]);
            out.extend(split_quad([corner(0), corner(1), corner(2), corner(3)]));
        }
        _ => EarClipper::new(positions, polygon).run(out),
    }
}

/// Splits a quad along the shorter diagonal that does not fold it over.
fn split_quad(q: [DVec3; 4]) -> [[u32; 3]; 2] {
    let normal = (q[2] - q[0]).cross(q[3] - q[1]);
    let faces_up = |[a, b, c]: [usize; 3]| (q[b] - q[a]).cross(q[c] - q[a]).dot(normal) > 0.0;
    let valid_02 = faces_up([0, 1, 2]) && faces_up([0, 2, 3]);
    let valid_13 = faces_up([0, 1, 3]) && faces_up([1, 2, 3]);
    let shorter_13 = q[1].distance_squared(q[3]) < q[0].distance_squared(q[2]) * CLEARLY_SHORTER;
    if valid_13 && (shorter_13 || !valid_02) {
        [[0, 1, 3], [1, 2, 3]]
    } else {
        [[0, 1, 2], [0, 2, 3]]
    }
}

/// Strictness of the ear test. Levels are tried in this order; each clip returns to the first.
#[derive(Clone, Copy, PartialEq)]
enum Care {
    /// Convex tip with no corner inside its triangle or on its diagonal.
    Strict,
    /// Tip of zero area: a repeated vertex, a spike, a collinear corner.
    Flat,
    /// Any convex tip; needed where the polygon crosses itself.
    Convex,
    /// Any tip; the remaining polygon has no interior.
    Any,
}

impl Care {
    fn less(self) -> Self {
        match self {
            Self::Strict => Self::Flat,
            Self::Flat => Self::Convex,
            Self::Convex | Self::Any => Self::Any,
        }
    }
}

/// Polygon as a doubly linked ring of corners from which ears are clipped.
struct EarClipper {
    points: Vec<DVec2>,
    spatial: Vec<DVec3>,
    previous: Vec<u32>,
    next: Vec<u32>,
    /// True for a reflex or flat corner that is still in the ring: only such a corner can block an
    /// ear.
    blocks: Vec<bool>,
    grid: ReflexGrid,
    looks_left: usize,
}

impl EarClipper {
    fn new(positions: &[[f64; 3]], polygon: &[u32]) -> Self {
        let spatial: Vec<DVec3> =
            polygon.iter().map(|&v| DVec3::from(positions[v as usize])).collect();
        let points = project(&spatial);
        let n = points.len();
        let turn = |i: usize| area(points[(i + n - 1) % n], points[i], points[(i + 1) % n]);
        // `!(… > 0)` rather than `<= 0`: overflowed coordinates must block, too.
        let blocks: Vec<bool> = (0..n).map(|i| !is_convex(turn(i))).collect();
        let blockers: Vec<u32> = (0..n as u32).filter(|&i| blocks[i as usize]).collect();
        Self {
            previous: (0..n).map(|i| ((i + n - 1) % n) as u32).collect(),
            next: (0..n).map(|i| ((i + 1) % n) as u32).collect(),
            grid: ReflexGrid::new(&points, blockers),
            looks_left: n * LOOKS_PER_CORNER,
            points,
            spatial,
            blocks,
        }
    }

    fn run(mut self, out: &mut Vec<[u32; 3]>) {
        let mut left = self.points.len();
        let mut tip = 1;
        let mut care = Care::Strict;
        // Consecutive tips that were not ears: after a full round the test is relaxed.
        let mut refused = 0;
        while left > 4 {
            self.looks_left = self.looks_left.saturating_sub(1);
            if self.looks_left == 0 {
                care = Care::Any;
            }
            if self.is_ear(tip, care) {
                let following = self.next[tip as usize];
                out.push(rotated([self.previous[tip as usize], tip, following]));
                self.cut(tip);
                left -= 1;
                (care, refused) = (Care::Strict, 0);
                // Skipping one corner keeps ears from sharing one vertex, which would make slivers.
                tip = self.next[following as usize];
            } else {
                refused += 1;
                tip = self.next[tip as usize];
                if refused >= left {
                    (care, refused) = (care.less(), 0);
                }
            }
        }
        let first = self.first_in_ring(tip);
        let mut ring = [first; 4];
        for i in 1..4 {
            ring[i] = self.next[ring[i - 1] as usize];
        }
        let quad = split_quad(ring.map(|corner| self.spatial[corner as usize]));
        out.extend(quad.map(|triangle| triangle.map(|i| ring[i as usize])));
    }

    /// Reports whether the triangle at `tip` may be clipped.
    fn is_ear(&mut self, tip: u32, care: Care) -> bool {
        let ends = [self.previous[tip as usize], self.next[tip as usize]];
        let [a, c] = ends.map(|end| self.points[end as usize]);
        let b = self.points[tip as usize];
        let turn = area(a, b, c);
        match care {
            Care::Strict => is_convex(turn) && !self.is_blocked([a, b, c]),
            Care::Flat => turn == 0.0,
            Care::Convex => is_convex(turn),
            Care::Any => true,
        }
    }

    /// Reports whether a corner of the ring lies inside a triangle or on its border. Corners equal
    /// to one of the triangle's own do not count: keyholes pass through the same point twice.
    fn is_blocked(&mut self, triangle: [DVec2; 3]) -> bool {
        let [a, b, c] = triangle;
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let inside = |p: DVec2| {
            !triangle.contains(&p)
                && area(a, b, p) >= 0.0
                && area(b, c, p) >= 0.0
                && area(c, a, p) >= 0.0
        };
        let (columns, rows) = self.grid.cells_between(low, high);
        for row in rows {
            for column in columns.clone() {
                let corners = self.grid.cell(column, row);
                self.looks_left = self.looks_left.saturating_sub(1 + corners.len());
                let hit = |&place: &u32| {
                    let i = self.grid.corners[place as usize] as usize;
                    self.blocks[i] && inside(self.points[i])
                };
                if corners.iter().any(hit) {
                    return true;
                }
            }
        }
        false
    }

    /// Removes `tip` from the ring; its neighbours may have become convex.
    fn cut(&mut self, tip: u32) {
        let (before, after) = (self.previous[tip as usize], self.next[tip as usize]);
        self.next[before as usize] = after;
        self.previous[after as usize] = before;
        self.blocks[tip as usize] = false;
        for i in [before, after].map(|end| end as usize) {
            if self.blocks[i] {
                let [a, c] = [self.previous[i], self.next[i]].map(|j| self.points[j as usize]);
                self.blocks[i] = !is_convex(area(a, self.points[i], c));
            }
        }
    }

    /// Returns the smallest of the last four corners.
    fn first_in_ring(&self, corner: u32) -> u32 {
        let mut first = corner;
        let mut at = self.next[corner as usize];
        while at != corner {
            first = first.min(at);
            at = self.next[at as usize];
        }
        first
    }
}

/// Uniform grid of the reflex corners over the polygon's bounding box, about one corner per cell.
struct ReflexGrid {
    frame: Frame,
    /// For each cell, indices into `corners`.
    cells: Buckets,
    corners: Vec<u32>,
}

/// Origin and resolution of the grid.
struct Frame {
    low: DVec2,
    cells_per_unit: DVec2,
    side: usize,
}

impl ReflexGrid {
    fn new(points: &[DVec2], corners: Vec<u32>) -> Self {
        let side = ((corners.len() as f64).sqrt() as usize).max(1);
        let low = points.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let high = points.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        let frame = Frame { low, cells_per_unit: side as f64 / (high - low), side };
        let cells = corners.iter().map(|&i| {
            let [column, row] = frame.place(points[i as usize]);
            row * side + column
        });
        Self { cells: Buckets::new(side * side, cells), frame, corners }
    }

    fn cells_between(
        &self,
        low: DVec2,
        high: DVec2,
    ) -> (RangeInclusive<usize>, RangeInclusive<usize>) {
        let ([left, bottom], [right, top]) = (self.frame.place(low), self.frame.place(high));
        (left..=right, bottom..=top)
    }

    /// Returns the corners in a cell, as indices into `corners`.
    fn cell(&self, column: usize, row: usize) -> &[u32] {
        self.cells.of(row * self.frame.side + column)
    }
}

impl Frame {
    /// Returns the column and row of a point; `as` saturates, so nothing falls outside.
    fn place(&self, p: DVec2) -> [usize; 2] {
        let cell = (p - self.low) * self.cells_per_unit;
        [cell.x, cell.y].map(|x| (x as usize).min(self.side - 1))
    }
}

/// Projects the polygon to the coordinate plane it is most parallel to, so that it runs
/// counter-clockwise. Dropping an axis keeps the coordinates' bits, so equal points stay equal.
fn project(points: &[DVec3]) -> Vec<DVec2> {
    let origin = points[0];
    // Newell's normal about a local origin: twice the area in each coordinate plane.
    let normal: DVec3 = points
        .iter()
        .zip(points.iter().cycle().skip(1))
        .map(|(&a, &b)| (a - origin).cross(b - origin))
        .sum();
    let size = normal.abs();
    let flatten = |p: &DVec3| {
        let (flat, side) = if size.x >= size.y && size.x >= size.z {
            (DVec2::new(p.y, p.z), normal.x)
        } else if size.y >= size.z {
            (DVec2::new(p.z, p.x), normal.y)
        } else {
            (DVec2::new(p.x, p.y), normal.z)
        };
        if side < 0.0 { DVec2::new(flat.y, flat.x) } else { flat }
    };
    points.iter().map(flatten).collect()
}

/// Returns twice the signed area of a triangle; positive if counter-clockwise.
fn area(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

fn is_convex(turn: f64) -> bool {
    turn > 0.0
}

/// Rotates a triangle so that its smallest corner comes first.
fn rotated([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// The triangles of a polygon over all of `positions`, after checking their number and that
    /// every polygon edge is the edge of one triangle.
    fn split(positions: &[[f64; 3]]) -> Vec<[u32; 3]> {
        let n = positions.len() as u32;
        let polygon: Vec<u32> = (0..n).collect();
        let mut out = Vec::new();
        triangulate(positions, &polygon, &mut out);
        assert_eq!(out.len(), polygon.len() - 2);
        for i in 0..n {
            let edge = (i, (i + 1) % n);
            let uses = out.iter().filter(|&&[a, b, c]| [(a, b), (b, c), (c, a)].contains(&edge));
            assert_eq!(uses.count(), 1, "edge {edge:?} of {out:?}");
        }
        out
    }

    fn signed_areas(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Vec<f64> {
        let at = |i: u32| DVec3::from(positions[i as usize]);
        triangles.iter().map(|&[a, b, c]| (at(b) - at(a)).cross(at(c) - at(a)).z / 2.0).collect()
    }

    /// Splits and checks that no triangle is turned over and that together they cover `expected`.
    fn covers(positions: &[[f64; 3]], expected: f64) {
        let areas = signed_areas(positions, &split(positions));
        assert!(areas.iter().all(|&a| a >= 0.0), "{areas:?}");
        let sum: f64 = areas.iter().sum();
        assert!((sum - expected).abs() < 1e-9 * expected, "{sum} is not {expected}");
    }

    fn flat<const N: usize>(points: [[f64; 2]; N]) -> [[f64; 3]; N] {
        points.map(|[x, y]| [x, y, 0.0])
    }

    #[test]
    fn a_square_is_split_from_its_first_corner() {
        let square = flat([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        assert_eq!(split(&square), [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn a_kite_is_split_by_its_short_diagonal() {
        let kite = flat([[0.0, 0.0], [2.0, -0.5], [4.0, 0.0], [2.0, 0.5]]);
        assert_eq!(split(&kite), [[0, 1, 3], [1, 2, 3]]);
    }

    #[test]
    fn a_dart_is_split_at_its_reflex_corner_wherever_that_is() {
        let dart = flat([[0.0, 0.0], [4.0, 2.0], [0.0, 4.0], [1.0, 2.0]]);
        for shift in 0..4 {
            let mut turned = dart;
            turned.rotate_left(shift);
            covers(&turned, 6.0);
        }
    }

    #[test]
    fn concave_polygons_are_covered_once() {
        let l = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
        covers(&flat(l), 5.0);
        let u = [
            [0.0, 0.0],
            [3.0, 0.0],
            [3.0, 3.0],
            [2.0, 3.0],
            [2.0, 1.0],
            [1.0, 1.0],
            [1.0, 3.0],
            [0.0, 3.0],
        ];
        covers(&flat(u), 7.0);
    }

    #[test]
    fn collinear_corners_get_area_where_they_can() {
        let five = flat([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [0.0, 3.0]]);
        let areas = signed_areas(&five, &split(&five));
        assert!(areas.iter().all(|&a| a > 0.0), "{areas:?}");
    }

    #[test]
    fn a_keyhole_leaves_its_hole_open() {
        let keyhole = flat([
            [0.0, 0.0],
            [4.0, 0.0],
            [4.0, 4.0],
            [0.0, 4.0],
            [0.0, 0.0],
            [1.0, 1.0],
            [1.0, 3.0],
            [3.0, 3.0],
            [3.0, 1.0],
            [1.0, 1.0],
        ]);
        covers(&keyhole, 12.0);
    }

    #[test]
    fn every_plane_and_turn_keeps_the_orientation() {
        let l = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
        for axis in 0..3 {
            for flip in [false, true] {
                let mut points = l.map(|[x, y]| {
                    let mut p = [7.0; 3];
                    (p[(axis + 1) % 3], p[(axis + 2) % 3]) = (x, y);
                    p
                });
                if flip {
                    points.reverse();
                }
                let sign = if flip { -1.0 } else { 1.0 };
                let at = |i: u32| DVec3::from(points[i as usize]);
                for [a, b, c] in split(&points) {
                    let normal = (at(b) - at(a)).cross(at(c) - at(a));
                    assert!(normal[axis] * sign > 0.0);
                }
            }
        }
    }

    #[test]
    fn without_area_or_with_crossings_all_triangles_still_come() {
        split(&[[1.0, 2.0, 3.0]; 7]);
        split(&flat([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [4.0, 0.0], [5.0, 0.0]]));
        let pentagram = [0.0, 2.0, 4.0, 1.0, 3.0].map(|i: f64| (i * TAU / 5.0).sin_cos());
        split(&pentagram.map(|(y, x)| [x, y, 0.0]));
        split(&pentagram.map(|(y, x)| [x * 1e200, y * 1e200, 0.0]));
        split(&pentagram.map(|(y, x)| [x * f64::MAX, y * f64::MAX, 0.0]));
    }

    #[test]
    fn repeated_vertices_keep_their_triangles() {
        let positions = flat([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        let mut out = Vec::new();
        triangulate(&positions, &[0, 1, 1, 2, 3, 3], &mut out);
        assert_eq!(out.len(), 4);
        triangulate(&positions, &[0, 1], &mut out);
        assert_eq!(out.len(), 4);
    }

    #[test]
    fn a_star_of_100_000_corners_is_covered_once() {
        let n = 100_000;
        let star: Vec<[f64; 3]> = (0..n)
            .map(|i| {
                let (y, x) = (f64::from(i) * TAU / f64::from(n)).sin_cos();
                let radius = if i % 2 == 0 { 1.0 } else { 0.5 };
                [x * radius, y * radius, 0.0]
            })
            .collect();
        let mut out = Vec::new();
        let polygon: Vec<u32> = (0..n as u32).collect();
        triangulate(&star, &polygon, &mut out);
        let areas = signed_areas(&star, &out);
        assert_eq!(areas.len(), star.len() - 2);
        assert!(areas.iter().all(|&a| a >= 0.0));
        let expected = f64::from(n) / 2.0 * 0.5 * (TAU / f64::from(n)).sin();
        let sum: f64 = areas.iter().sum();
        assert!((sum - expected).abs() < 1e-6, "{sum} is not {expected}");
    }

    #[test]
    fn a_polygon_made_to_be_slow_ends() {
        // A zigzag whose every corner crosses all others: no ear is ever strict.
        let zigzag: Vec<[f64; 3]> = (0..100_000)
            .map(|i| [f64::from(i % 2), f64::from((i * 7919) % 100_003), 0.0])
            .collect();
        let polygon: Vec<u32> = (0..100_000).collect();
        let mut out = Vec::new();
        triangulate(&zigzag, &polygon, &mut out);
        assert_eq!(out.len(), 99_998);
    }
}
