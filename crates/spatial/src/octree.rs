//! An octree of cubes, each with the triangles that pass through it.

use glam::DVec3;

use crate::triangle::Triangle;

/// A cube with no more triangles is not split.
const FEW: usize = 16;
/// The deepest level.
const MAX_LEVEL: u8 = 16;
/// Splitting ends when the cubes together hold this many triangles for each there is: long ones pass
/// through many cubes.
const MOST_ENTRIES: usize = 64;
/// What rounding may take from a triangle, in sides of the whole: a few units of 2^-52, and room.
const SLACK: f64 = 1e-14;

/// The leaves of an octree over triangles.
///
/// The whole is a cube from the least corner of all triangles, with the longest side of their box.
/// A cube is split into eight while it has more than 16 triangles, down to level 16, level by level,
/// until all cubes together have 64 entries for each triangle. Cubes are closed: what touches a
/// cube passes through it. A triangle that misses a cube by less than 1e-14 of the whole may be
/// counted in.
#[derive(Clone, Debug, PartialEq)]
pub struct Octree {
    origin: [f64; 3],
    side: f64,
    cubes: Vec<Cube>,
}

/// A cube of an octree, with the triangles that pass through it.
#[derive(Clone, Debug, PartialEq)]
pub struct Cube {
    /// How often the whole was halved.
    pub level: u8,
    /// Which it is along each axis, of 2^level.
    pub at: [u32; 3],
    /// The triangles, lowest first; never none.
    pub triangles: Vec<u32>,
}

impl Octree {
    /// The octree over `count` triangles. Coordinates are finite, and below 1e300.
    ///
    /// Cost: about the number of entries times the levels.
    pub fn new(count: usize, triangle: impl Fn(u32) -> Triangle) -> Self {
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (lo, hi) =
            (0..count as u32).flat_map(&triangle).fold(empty, |(lo, hi), p| (lo.min(p), hi.max(p)));
        if count == 0 {
            return Self { origin: [0.0; 3], side: 0.0, cubes: Vec::new() };
        }
        let side = (hi - lo).max_element();
        // All at one point: any side will do.
        let scale = if side > 0.0 { side } else { 1.0 };
        let local = |i: u32| triangle(i).map(|p| (p - lo) / scale);
        let whole = Cube { level: 0, at: [0; 3], triangles: (0..count as u32).collect() };
        let cubes = split_all(whole, MOST_ENTRIES * count, local);
        Self { origin: lo.into(), side, cubes }
    }

    /// The least corner of the whole.
    pub fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// The side of the whole.
    pub fn side(&self) -> f64 {
        self.side
    }

    /// The leaves that triangles pass through: by level, then along the axes, the last one first.
    pub fn cubes(&self) -> &[Cube] {
        &self.cubes
    }
}

/// Splits level by level.
fn split_all(whole: Cube, most_entries: usize, local: impl Fn(u32) -> Triangle) -> Vec<Cube> {
    let (mut leaves, mut open) = (Vec::new(), vec![whole]);
    let mut entries = open[0].triangles.len();
    while !open.is_empty() {
        let mut finer = Vec::new();
        for cube in open {
            let full = cube.triangles.len() > FEW && cube.level < MAX_LEVEL;
            if !full || entries > most_entries {
                leaves.push(cube);
                continue;
            }
            entries -= cube.triangles.len();
            for child in split(&cube, &local) {
                entries += child.triangles.len();
                finer.push(child);
            }
        }
        open = finer;
    }
    leaves.sort_unstable_by_key(|cube| {
        let [x, y, z] = cube.at;
        (cube.level, z, y, x)
    });
    leaves
}

/// The parts of a cube that triangles pass through.
fn split(cube: &Cube, local: &impl Fn(u32) -> Triangle) -> Vec<Cube> {
    let level = cube.level + 1;
    let half = 0.5 / f64::from(1u32 << level);
    let children = (0..8u32).map(|i| {
        let at = [i & 1, i >> 1 & 1, i >> 2];
        Cube { level, at: [0, 1, 2].map(|k| 2 * cube.at[k] + at[k]), triangles: Vec::new() }
    });
    let mut children: Vec<Cube> = children.collect();
    for &i in &cube.triangles {
        let triangle = local(i);
        for child in &mut children {
            let center = DVec3::from(child.at.map(|k| f64::from(2 * k + 1))) * half;
            if passes_through(&triangle.map(|p| p - center), half) {
                child.triangles.push(i);
            }
        }
    }
    children.retain(|child| !child.triangles.is_empty());
    children
}

/// Whether a triangle may have a point in the cube of this half side about the origin.
/// # References
/// [AM01]: no axis parts them, of the cube's, the triangle's normal, and the products of edges;
/// differs: rounding only makes cubes larger.
fn passes_through(triangle: &Triangle, half: f64) -> bool {
    let [a, b, c] = *triangle;
    let half = half + SLACK;
    if (a.min(b).min(c)).max_element() > half || (a.max(b).max(c)).min_element() < -half {
        return false;
    }
    let normal = (b - a).cross(c - a);
    let parts = |axis: DVec3| {
        let along = triangle.map(|p| p.dot(axis));
        let least = along[0].min(along[1]).min(along[2]);
        let greatest = along[0].max(along[1]).max(along[2]);
        // What rounding may do to a dot product with coordinates below 2 in size.
        let reach =
            half * (axis.x.abs() + axis.y.abs() + axis.z.abs()) + SLACK * axis.abs().max_element();
        least > reach || greatest < -reach
    };
    let edges = [b - a, c - b, a - c];
    let crossed = |edge: DVec3| DVec3::AXES.map(|axis| axis.cross(edge));
    !parts(normal) && !edges.into_iter().flat_map(crossed).any(parts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closest_point;

    fn hashed(seed: u64) -> f64 {
        let mut z = seed.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn triangle(i: u32, size: f64) -> Triangle {
        let point =
            |k: u64| DVec3::from([0, 1, 2].map(|axis| hashed(u64::from(i) * 100 + k * 10 + axis)));
        [1, 2, 3].map(|k| point(0) + point(k) * size)
    }

    /// Samples of a triangle.
    fn points([a, b, c]: Triangle) -> impl Iterator<Item = DVec3> {
        (0..100).map(move |k| {
            let (u, v) = (hashed(k), hashed(k + 1000));
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            a + (b - a) * u + (c - a) * v
        })
    }

    fn holds(octree: &Octree, cube: &Cube, p: DVec3, slack: f64) -> bool {
        let side = octree.side() / f64::from(1u32 << cube.level);
        let lo = DVec3::from(octree.origin()) + DVec3::from(cube.at.map(f64::from)) * side;
        (p - lo).min_element() >= -slack && (lo + side - p).min_element() >= -slack
    }

    #[test]
    fn a_triangle_is_in_the_cubes_of_its_points_and_no_far_one() {
        for size in [0.02, 0.3, 2.0] {
            let octree = Octree::new(300, |i| triangle(i, size));
            for i in 0..300 {
                for p in points(triangle(i, size)) {
                    let mut at = octree.cubes().iter().filter(|cube| holds(&octree, cube, p, 0.0));
                    assert!(at.any(|cube| cube.triangles.contains(&i)), "{i} at {p}");
                }
            }
            for cube in octree.cubes() {
                let side = octree.side() / f64::from(1u32 << cube.level);
                let lo = DVec3::from(octree.origin()) + DVec3::from(cube.at.map(f64::from)) * side;
                for &i in &cube.triangles {
                    let near = closest_point(lo + side / 2.0, &triangle(i, size));
                    let reach = side * 0.5 * 3f64.sqrt();
                    assert!(near.distance(lo + side / 2.0) <= reach * 1.000001);
                }
            }
        }
    }

    #[test]
    fn cubes_are_few_where_triangles_are_long() {
        let octree = Octree::new(500, |i| triangle(i, 10.0));
        let entries: usize = octree.cubes().iter().map(|cube| cube.triangles.len()).sum();
        assert!(entries <= 500 * MOST_ENTRIES + 8 * 500, "{entries}");
    }

    #[test]
    fn points_and_nothing_have_cubes_too() {
        assert!(Octree::new(0, |_| [DVec3::ZERO; 3]).cubes().is_empty());
        let octree = Octree::new(40, |_| [DVec3::ONE; 3]);
        assert!(octree.cubes().iter().all(|cube| cube.triangles.len() == 40));
    }
}
