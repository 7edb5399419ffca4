//! Octree whose leaves list the triangles that pass through them.

use glam::DVec3;

use crate::triangle::Triangle;

/// A cell with no more triangles is not split.
const LEAF_TRIANGLES: usize = 16;
/// Deepest level.
const MAX_LEVEL: u8 = 16;
/// Splitting ends when the cells together hold this many entries per triangle, as long triangles
/// pass through many cells.
const MOST_ENTRIES: usize = 64;
/// Tolerance of the overlap test for rounding, relative to the root: some units of 2^-52 and a
/// margin.
const SLACK: f64 = 1e-14;

/// Octree over triangles, stored as its nonempty leaves; each lists the triangles that pass through
/// it.
///
/// The root is a cube at the least corner of the bounding box of all triangles, with the longest
/// side of that box. A cell is split into eight while it has more than 16 triangles, down to level
/// 16, level by level, until all cells together have 64 entries per triangle. Cells are closed: a
/// triangle that touches a cell passes through it. A triangle that misses a cell by less than 1e-14
/// of the root's side may be included.
#[derive(Clone, Debug, PartialEq)]
pub struct Octree {
    origin: [f64; 3],
    side: f64,
    leaves: Vec<OctreeLeaf>,
}

/// Leaf cell of an octree, with the triangles that pass through it.
#[derive(Clone, Debug, PartialEq)]
pub struct OctreeLeaf {
    /// Depth of the leaf: its side is the root cube's side divided by 2^level.
    pub level: u8,
    /// Position of the leaf in the grid of its level: an index per axis, below 2^level.
    pub at: [u32; 3],
    /// Indices of the triangles that pass through the leaf, at least one, in ascending order.
    pub triangles: Vec<u32>,
}

impl Octree {
    /// Builds the octree over `count` triangles, whose coordinates must be finite and below 1e300.
    ///
    /// Cost: about the number of entries times the number of levels.
    pub fn new(count: usize, triangle: impl Fn(u32) -> Triangle) -> Self {
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (lo, hi) =
            (0..count as u32).flat_map(&triangle).fold(empty, |(lo, hi), p| (lo.min(p), hi.max(p)));
        if count == 0 {
            return Self { origin: [0.0; 3], side: 0.0, leaves: Vec::new() };
        }
        let side = (hi - lo).max_element();
        // With all corners at one point, any side will do.
        let scale = if side > 0.0 { side } else { 1.0 };
        let local = |i: u32| triangle(i).map(|p| (p - lo) / scale);
        let root = OctreeLeaf { level: 0, at: [0; 3], triangles: (0..count as u32).collect() };
        let leaves = split_all(root, MOST_ENTRIES * count, local);
        Self { origin: lo.into(), side, leaves }
    }

    /// Returns the corner of the root cube with the smallest coordinates.
    pub fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// Returns the side length of the root cube.
    pub fn side(&self) -> f64 {
        self.side
    }

    /// Returns the leaves that triangles pass through, sorted by level, then by z, y and x.
    pub fn leaves(&self) -> &[OctreeLeaf] {
        &self.leaves
    }
}

/// Splits cells level by level and returns the leaves.
fn split_all(
    root: OctreeLeaf,
    most_entries: usize,
    local: impl Fn(u32) -> Triangle,
) -> Vec<OctreeLeaf> {
    let (mut leaves, mut open) = (Vec::new(), vec![root]);
    let mut entries = open[0].triangles.len();
    while !open.is_empty() {
        let mut finer = Vec::new();
        for cell in open {
            let full = cell.triangles.len() > LEAF_TRIANGLES && cell.level < MAX_LEVEL;
            if !full || entries > most_entries {
                leaves.push(cell);
                continue;
            }
            entries -= cell.triangles.len();
            for child in split(&cell, &local) {
                entries += child.triangles.len();
                finer.push(child);
            }
        }
        open = finer;
    }
    leaves.sort_unstable_by_key(|leaf| {
        let [x, y, z] = leaf.at;
        (leaf.level, z, y, x)
    });
    leaves
}

/// Returns the nonempty children of a cell.
fn split(cell: &OctreeLeaf, local: &impl Fn(u32) -> Triangle) -> Vec<OctreeLeaf> {
    let level = cell.level + 1;
    let half = 0.5 / f64::from(1u32 << level);
    let children = (0..8u32).map(|i| {
        let at = [i & 1, i >> 1 & 1, i >> 2];
        OctreeLeaf { level, at: [0, 1, 2].map(|k| 2 * cell.at[k] + at[k]), triangles: Vec::new() }
    });
    let mut children: Vec<OctreeLeaf> = children.collect();
    for &i in &cell.triangles {
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

/// Returns true if a triangle may meet the cube of half side `half` about the origin.
///
/// # References
/// [AM01]: no separating axis among the cube's axes, the triangle's normal and the products of
/// edges; differs: the cube is enlarged to cover rounding.
fn passes_through(triangle: &Triangle, half: f64) -> bool {
    let [a, b, c] = *triangle;
    let half = half + SLACK;
    if (a.min(b).min(c)).max_element() > half || (a.max(b).max(c)).min_element() < -half {
        return false;
    }
    let normal = (b - a).cross(c - a);
    let separates = |axis: DVec3| {
        let along = triangle.map(|p| p.dot(axis));
        let least = along[0].min(along[1]).min(along[2]);
        let greatest = along[0].max(along[1]).max(along[2]);
        // The slack covers the rounding of a dot product with coordinates below 2.
        let reach =
            half * (axis.x.abs() + axis.y.abs() + axis.z.abs()) + SLACK * axis.abs().max_element();
        least > reach || greatest < -reach
    };
    let edges = [b - a, c - b, a - c];
    let crossed = |edge: DVec3| DVec3::AXES.map(|axis| axis.cross(edge));
    !separates(normal) && !edges.into_iter().flat_map(crossed).any(separates)
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

    /// Returns random points of a triangle.
    fn points([a, b, c]: Triangle) -> impl Iterator<Item = DVec3> {
        (0..100).map(move |k| {
            let (u, v) = (hashed(k), hashed(k + 1000));
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            a + (b - a) * u + (c - a) * v
        })
    }

    fn holds(octree: &Octree, leaf: &OctreeLeaf, p: DVec3, slack: f64) -> bool {
        let side = octree.side() / f64::from(1u32 << leaf.level);
        let lo = DVec3::from(octree.origin()) + DVec3::from(leaf.at.map(f64::from)) * side;
        (p - lo).min_element() >= -slack && (lo + side - p).min_element() >= -slack
    }

    #[test]
    fn a_triangle_is_in_the_leaves_of_its_points_and_no_far_one() {
        for size in [0.02, 0.3, 2.0] {
            let octree = Octree::new(300, |i| triangle(i, size));
            for i in 0..300 {
                for p in points(triangle(i, size)) {
                    let mut at = octree.leaves().iter().filter(|leaf| holds(&octree, leaf, p, 0.0));
                    assert!(at.any(|leaf| leaf.triangles.contains(&i)), "{i} at {p}");
                }
            }
            for leaf in octree.leaves() {
                let side = octree.side() / f64::from(1u32 << leaf.level);
                let lo = DVec3::from(octree.origin()) + DVec3::from(leaf.at.map(f64::from)) * side;
                for &i in &leaf.triangles {
                    let near = closest_point(lo + side / 2.0, &triangle(i, size));
                    let reach = side * 0.5 * 3f64.sqrt();
                    assert!(near.distance(lo + side / 2.0) <= reach * 1.000001);
                }
            }
        }
    }

    #[test]
    fn leaves_are_few_where_triangles_are_long() {
        let octree = Octree::new(500, |i| triangle(i, 10.0));
        let entries: usize = octree.leaves().iter().map(|leaf| leaf.triangles.len()).sum();
        assert!(entries <= 500 * MOST_ENTRIES + 8 * 500, "{entries}");
    }

    #[test]
    fn points_and_empty_input_have_leaves_too() {
        assert!(Octree::new(0, |_| [DVec3::ZERO; 3]).leaves().is_empty());
        let octree = Octree::new(40, |_| [DVec3::ONE; 3]);
        assert!(octree.leaves().iter().all(|leaf| leaf.triangles.len() == 40));
    }
}
