//! Distance to the parts of a surface that are left, excluding up to two of them.
//!
//! Each part has a tree of its own, over its triangles in the order they come in, four by four.
//! Boxes are compared, to find a good tree, only over the parts. So building takes little time, a
//! part is removed or passed over as a whole, and a query tests four triangles at a time.

use std::ops::{Add, Mul, Sub};

use glam::{Vec3, Vec4};
use meshlod_mesh::FaceId;

use crate::box3::Box3;
use crate::build::build_over;
use crate::bvh;

/// Number of children of a node, and of triangles of a block.
const WIDTH: usize = 4;

/// Mark of a child that is a block of triangles.
const BLOCK: u32 = 1 << 31;

/// Child that is missing.
const MISSING: u32 = u32::MAX;

/// Mark of a child, or of a node, that has several parts.
const SEVERAL: u32 = u32::MAX;

/// Distance at which a point touches a triangle, as a part of the diagonal of all boxes: about the
/// rounding of places in `f32`. Where many parts meet, the search for a closer one would visit them
/// all.
const TOUCHING: f32 = 2e-7;

/// Added to squared lengths before they divide.
const TINY: f32 = 1e-36;

/// Bounding volume hierarchy over the parts of a surface, such as its connected components. Parts
/// can be removed, and distances exclude one or two parts.
///
/// Size: about 100 bytes a triangle. In single precision, as the places are: a distance is off by
/// about the rounding of the largest coordinate.
#[derive(Clone, Debug)]
pub struct PartBvh {
    /// The nodes of all parts, followed by the nodes over several parts.
    nodes: Vec<WideNode>,
    blocks: Vec<Block>,
    /// Index of the first node over several parts, which is the root.
    root: usize,
    /// Parts below each child of the nodes from the root on.
    below: Vec<[Below; WIDTH]>,
    /// Child that each node from the root on is, as an index into all children of `below`.
    parents: Vec<u32>,
    /// Child that each part is, as an index into all children of `below`.
    of_part: Vec<u32>,
    is_left: Vec<bool>,
    /// Square of the distance that touches.
    touching: f32,
}

/// Builder of a [`PartBvh`], to which parts are added one by one.
#[derive(Debug, Default)]
pub struct PartBvhBuilder {
    nodes: Vec<WideNode>,
    blocks: Vec<Block>,
    /// Root and box of each part.
    parts: Vec<(u32, Box3)>,
    /// Children of one depth, and the nodes over them.
    level: Vec<(u32, Box3)>,
    next: Vec<(u32, Box3)>,
}

/// Memory of searches in a [`PartBvh`], allocated once for many.
#[derive(Debug, Default)]
pub struct PartSearch(Vec<Waiting>);

/// Squared distances between which a search goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Within {
    /// Any part as near as this will do.
    pub enough: f32,
    /// No part farther away than this counts.
    pub most: f32,
}

/// Distance from a point to the nearest of several parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestPart {
    /// Squared distance; infinite if there is no part.
    pub distance_squared: f32,
    /// Number of the part; [`u32::MAX`] if there is none.
    pub part: u32,
}

/// Parts below a child of a node over several parts.
#[derive(Clone, Copy, Debug)]
struct Below {
    /// Number of the part, or [`SEVERAL`].
    part: u32,
    /// Number of parts left.
    left: u32,
}

/// Node with four children; boxes are stored by axis, one lane a child.
#[derive(Clone, Copy, Debug)]
struct WideNode {
    lo: Wide3,
    hi: Wide3,
    /// Indices of nodes, or of blocks with the mark [`BLOCK`].
    children: [u32; WIDTH],
}

/// Four triangles, by their boxes, a corner and the edges to both others. The last one of a part
/// fills up its last block.
#[derive(Clone, Copy, Debug)]
struct Block {
    lo: Wide3,
    hi: Wide3,
    corner: Wide3,
    edges: [Wide3; 2],
}

/// A child whose turn has not come, with the squared distance of its box.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    distance_squared: f32,
    child: u32,
    part: u32,
}

/// Four vectors, one a lane.
#[derive(Clone, Copy, Debug)]
struct Wide3 {
    x: Vec4,
    y: Vec4,
    z: Vec4,
}

impl PartBvhBuilder {
    /// Adds a part of at least one triangle, whose number is that of the parts before it. Triangles
    /// near each other should follow each other.
    ///
    /// Cost: O(n), n = triangles.
    pub fn add(&mut self, triangles: impl Iterator<Item = [Vec3; 3]>) {
        self.level.clear();
        let mut four = [[Vec3::ZERO; 3]; WIDTH];
        let mut count = 0;
        for triangle in triangles {
            four[count] = triangle;
            count += 1;
            if count == WIDTH {
                self.add_block(&four);
                count = 0;
            }
        }
        if count > 0 {
            let last = four[count - 1];
            four[count..].fill(last);
            self.add_block(&four);
        }
        let (root, mut bounds) = self.join_level();
        if root == MISSING {
            bounds = Box3::EMPTY;
        }
        self.parts.push((root, bounds));
    }

    fn add_block(&mut self, four: &[[Vec3; 3]; WIDTH]) {
        // `map` over an array is not inlined.
        let [[a, b, c], [d, e, f], [g, h, i], [j, k, l]] = *four;
        let [first, second, third] =
            [Wide3::of([a, d, g, j]), Wide3::of([b, e, h, k]), Wide3::of([c, f, i, l])];
        let (lo, hi) = (first.min(second).min(third), first.max(second).max(third));
        let bounds = Box3 {
            lo: Vec3::new(lo.x.min_element(), lo.y.min_element(), lo.z.min_element()),
            hi: Vec3::new(hi.x.max_element(), hi.y.max_element(), hi.z.max_element()),
        };
        self.level.push((BLOCK | self.blocks.len() as u32, bounds));
        let edges = [second - first, third - first];
        self.blocks.push(Block { lo, hi, corner: first, edges });
    }

    /// Joins the children of one depth four by four until there is one.
    fn join_level(&mut self) -> (u32, Box3) {
        while self.level.len() > 1 {
            self.next.clear();
            for children in self.level.chunks(WIDTH) {
                let bounds = children.iter().fold(Box3::EMPTY, |all, (_, own)| all.merged(own));
                self.next.push((self.nodes.len() as u32, bounds));
                self.nodes.push(WideNode::over(children));
            }
            std::mem::swap(&mut self.level, &mut self.next);
        }
        self.level.first().copied().unwrap_or((MISSING, Box3::EMPTY))
    }

    /// Builds the hierarchy over all parts.
    ///
    /// Cost: O(n log n), n = parts; in parallel. The result is the same for any number of threads.
    pub fn build(self) -> PartBvh {
        let Self { mut nodes, blocks, parts, .. } = self;
        let (root, count) = (nodes.len(), parts.len());
        let all = parts.iter().fold(Box3::EMPTY, |all, (_, own)| all.merged(own));
        let touching = (TOUCHING * (all.hi - all.lo).max(Vec3::ZERO).length()).powi(2);
        let (over, order) = build_over::<1>(count, |part| parts[part.index()].1);
        let mut below = vec![[Below { part: SEVERAL, left: 0 }; WIDTH]; over.len()];
        let mut parents = vec![u32::MAX; over.len()];
        let mut of_part = vec![u32::MAX; count];
        // Children follow their parents.
        for (index, node) in over.iter().enumerate().rev() {
            for child in 0..WIDTH {
                let (first, own) = (node.first[child] as usize, (WIDTH * index + child) as u32);
                match node.count[child] {
                    bvh::INNER => {
                        parents[first] = own;
                        below[index][child].left =
                            below[first].iter().map(|child| child.left).sum();
                    }
                    0 => {}
                    _ => {
                        let part = order[first];
                        of_part[part.index()] = own;
                        below[index][child] = Below { part: part.0, left: 1 };
                    }
                }
            }
        }
        nodes.extend(over.iter().map(|node| WideNode::of_parts(node, root, &order, &parts)));
        let is_left = vec![true; count];
        PartBvh { nodes, blocks, root, below, parents, of_part, is_left, touching }
    }
}

impl PartBvh {
    /// Removes a part, if it is left.
    ///
    /// Cost: O(log n), n = parts.
    pub fn remove(&mut self, part: u32) {
        if !std::mem::replace(&mut self.is_left[part as usize], false) {
            return;
        }
        let mut at = self.of_part[part as usize];
        while at != u32::MAX {
            let (node, child) = (at as usize / WIDTH, at as usize % WIDTH);
            self.below[node][child].left -= 1;
            at = self.parents[node];
        }
    }

    /// Returns true if a part has not been removed.
    #[inline]
    pub fn is_left(&self, part: u32) -> bool {
        self.is_left[part as usize]
    }

    /// Returns the nearest of the remaining parts but those of `except`, or one that touches the point
    /// or is near enough. [`u32::MAX`] is the number of no part.
    ///
    /// Cost: O(log n) for points near these parts, n = triangles.
    pub fn nearest(
        &self,
        point: Vec3,
        except: [u32; 2],
        within: Within,
        search: &mut PartSearch,
    ) -> NearestPart {
        let waiting = &mut search.0;
        let enough = within.enough.max(self.touching);
        let mut best = NearestPart { distance_squared: within.most, part: u32::MAX };
        let wide = Wide3::of([point; WIDTH]);
        waiting.clear();
        waiting.push(Waiting { distance_squared: 0.0, child: self.root as u32, part: SEVERAL });
        while let Some(Waiting { distance_squared, child, part }) = waiting.pop() {
            if distance_squared >= best.distance_squared {
                continue;
            }
            let reach = Vec4::splat(best.distance_squared);
            if child & BLOCK != 0 {
                let block = &self.blocks[(child & !BLOCK) as usize];
                if !from_boxes(block.lo, block.hi, wide).cmplt(reach).any() {
                    continue;
                }
                let found = block.distances_squared(wide).min_element();
                if found < best.distance_squared {
                    best = NearestPart { distance_squared: found, part };
                    if found <= enough {
                        break;
                    }
                }
                continue;
            }
            let Some(node) = self.nodes.get(child as usize) else { continue };
            let distances = from_boxes(node.lo, node.hi, wide);
            let below = (child as usize).checked_sub(self.root).map(|over| &self.below[over]);
            let bottom = waiting.len();
            let mut near = distances.cmplt(reach).bitmask();
            while near != 0 {
                let i = near.trailing_zeros() as usize;
                near &= near - 1;
                let part = match below.map(|below| below[i]) {
                    None => part,
                    Some(Below { left: 0, .. }) => continue,
                    Some(Below { part, .. }) if except.contains(&part) && part != SEVERAL => {
                        continue;
                    }
                    Some(Below { part, .. }) => part,
                };
                let own = Waiting { distance_squared: distances[i], child: node.children[i], part };
                waiting.push(own);
                // Farthest at the bottom, so that the nearest is popped first.
                let mut at = waiting.len() - 1;
                while at > bottom && waiting[at - 1].distance_squared < own.distance_squared {
                    waiting.swap(at - 1, at);
                    at -= 1;
                }
            }
        }
        best
    }
}

impl Within {
    /// All distances.
    pub const ANY: Self = Self { enough: 0.0, most: f32::INFINITY };
}

impl WideNode {
    /// Returns the node over up to four children with their boxes.
    fn over(children: &[(u32, Box3)]) -> Self {
        // A missing child is infinitely far away.
        let mut node = Self {
            lo: Wide3::of([Vec3::INFINITY; WIDTH]),
            hi: Wide3::of([Vec3::NEG_INFINITY; WIDTH]),
            children: [MISSING; WIDTH],
        };
        for (i, (child, bounds)) in children.iter().enumerate() {
            node.lo.set(i, bounds.lo);
            node.hi.set(i, bounds.hi);
            node.children[i] = *child;
        }
        node
    }

    /// Returns a node over several parts. Those of its children that are nodes follow `root`.
    fn of_parts(node: &bvh::Node, root: usize, order: &[FaceId], parts: &[(u32, Box3)]) -> Self {
        let [lo, hi] = [node.lo, node.hi].map(|[x, y, z]| Wide3 { x, y, z });
        let child = |i: usize| match node.count[i] {
            bvh::INNER => root as u32 + node.first[i],
            0 => MISSING,
            _ => parts[order[node.first[i] as usize].index()].0,
        };
        Self { lo, hi, children: [0, 1, 2, 3].map(child) }
    }
}

/// Returns the squared distances of a point from four boxes.
#[inline(always)]
fn from_boxes(lo: Wide3, hi: Wide3, p: Wide3) -> Vec4 {
    let along = |lo: Vec4, hi: Vec4, p: Vec4| {
        let distance = (lo - p).max(p - hi).max(Vec4::ZERO);
        distance * distance
    };
    along(lo.x, hi.x, p.x) + along(lo.y, hi.y, p.y) + along(lo.z, hi.z, p.z)
}

impl Block {
    /// Returns the squared distances of a point from the four triangles: the least of those from
    /// the three edges and, if it lies over the triangle, from its foot there. All are distances
    /// from points of the triangle, whatever its shape.
    #[inline(always)]
    fn distances_squared(&self, p: Wide3) -> Vec4 {
        let [ab, ac] = self.edges;
        let ap = p - self.corner;
        let (along_b, along_c) = (ab.dot(ap), ac.dot(ap));
        let (bb, bc, cc) = (ab.dot(ab), ab.dot(ac), ac.dot(ac));
        let part =
            |along: Vec4, squared: Vec4| (along / (squared + TINY)).max(Vec4::ZERO).min(Vec4::ONE);
        let from_b = (ap - ab * part(along_b, bb)).squared();
        let from_c = (ap - ac * part(along_c, cc)).squared();
        let (bp, opposite) = (ap - ab, ac - ab);
        let across = part(opposite.dot(bp), opposite.squared());
        let from_opposite = (bp - opposite * across).squared();
        let edges = from_b.min(from_c).min(from_opposite);
        // Barycentric coordinates of the foot, times the determinant.
        let (b, c) = (cc * along_b - bc * along_c, bb * along_c - bc * along_b);
        let all = bb * cc - bc * bc;
        let is_over = b.cmpgt(Vec4::ZERO) & c.cmpgt(Vec4::ZERO) & (b + c).cmplt(all);
        let foot = ab * (b / (all + TINY)) + ac * (c / (all + TINY));
        let from_foot = (ap - foot).squared();
        Vec4::select(is_over, from_foot.min(edges), edges)
    }
}

impl Wide3 {
    #[inline(always)]
    fn of([a, b, c, d]: [Vec3; WIDTH]) -> Self {
        Self {
            x: Vec4::new(a.x, b.x, c.x, d.x),
            y: Vec4::new(a.y, b.y, c.y, d.y),
            z: Vec4::new(a.z, b.z, c.z, d.z),
        }
    }

    fn set(&mut self, lane: usize, v: Vec3) {
        (self.x[lane], self.y[lane], self.z[lane]) = (v.x, v.y, v.z);
    }

    #[inline(always)]
    fn dot(self, other: Self) -> Vec4 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self { x: self.x.min(other.x), y: self.y.min(other.y), z: self.z.min(other.z) }
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self { x: self.x.max(other.x), y: self.y.max(other.y), z: self.z.max(other.z) }
    }

    #[inline(always)]
    fn squared(self) -> Vec4 {
        self.dot(self)
    }
}

impl Add for Wide3 {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl Sub for Wide3 {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

impl Mul<Vec4> for Wide3 {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: Vec4) -> Self {
        Self { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }
}
