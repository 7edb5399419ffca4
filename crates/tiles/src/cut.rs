//! Triangles cut along the planes of an octree, so that neighbours agree to the bit.
//!
//! A cell is cut at its middle on x, then y, then z, then so are its children. A new point is on an
//! edge, and follows from the two ends of that edge alone, which both faces beside it and both cells
//! beside the plane have alike. Coordinates round to odd numbers, so a point stays on its side of
//! all other planes, and each plane crosses a piece at most once: coordinates along its border keep
//! rising and falling once. A leaf beside deeper ones divides the edges on their side as they do.

use crate::cell::Cell;
use crate::lattice::{Point, nearest_odd};
use crate::octree::TileTree;

/// Corner of a piece of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Place on the lattice.
    pub at: Point,
    /// Weights of the three corners of the triangle, which sum to 1.
    pub weights: [f32; 3],
}

/// Piece of a triangle inside one leaf, itself a triangle of the orientation of the whole.
pub type Piece = [Corner; 3];

/// Cuts triangles along an octree.
#[derive(Debug)]
pub struct Cutter<'t> {
    tree: &'t TileTree,
}

impl<'t> Cutter<'t> {
    /// Creates the cutter for an octree.
    pub fn new(tree: &'t TileTree) -> Self {
        Self { tree }
    }

    /// Passes all pieces of a triangle on, each with the index of its leaf in the octree. A triangle
    /// with two corners at one point has none.
    pub fn cut(&self, triangle: [Point; 3], pieces: &mut impl FnMut(usize, Piece)) {
        let [a, b, c] = triangle;
        if a == b || b == c || c == a {
            return;
        }
        let weights = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let corner = |i: usize| Corner { at: triangle[i], weights: weights[i] };
        let mut node = 0;
        let piece = [corner(0), corner(1), corner(2)];
        // Most triangles are inside one leaf.
        while let Some(children) = self.tree.nodes()[node].children {
            let middle = self.tree.nodes()[node].cell.middle();
            let [octant, other, third] = triangle.map(|at| octant(at, middle));
            if octant != other || octant != third {
                return self.divide(node, piece.to_vec(), pieces);
            }
            node = children as usize + octant;
        }
        pieces(node, piece);
    }

    /// Cuts a convex polygon inside a cell.
    fn divide(&self, node: usize, polygon: Vec<Corner>, pieces: &mut impl FnMut(usize, Piece)) {
        let found = self.tree.nodes()[node];
        let Some(children) = found.children else {
            return self.triangulate(node, &polygon, pieces);
        };
        let middle = found.cell.middle();
        for (x, part) in split(polygon, 0, middle[0]).into_iter().enumerate() {
            for (y, part) in split(part, 1, middle[1]).into_iter().enumerate() {
                for (z, part) in split(part, 2, middle[2]).into_iter().enumerate() {
                    if part.len() > 2 {
                        self.divide(children as usize + x + 2 * y + 4 * z, part, pieces);
                    }
                }
            }
        }
    }

    /// Divides a polygon inside a leaf into triangles. No diagonal is in a side of the leaf, since
    /// at most two corners are, which follow each other.
    fn triangulate(&self, leaf: usize, polygon: &[Corner], pieces: &mut impl FnMut(usize, Piece)) {
        let cell = self.tree.nodes()[leaf].cell;
        for i in 1..polygon.len() - 1 {
            let piece = [polygon[0], polygon[i], polygon[i + 1]];
            let [a, b, c] = piece.map(|corner| corner.at);
            if a != b && b != c && c != a {
                self.divide_edges((leaf, cell), piece, pieces);
            }
        }
    }

    /// Divides the edges of a triangle on the sides of a leaf where deeper leaves beside it do.
    fn divide_edges(
        &self,
        (leaf, cell): (usize, Cell),
        piece: Piece,
        pieces: &mut impl FnMut(usize, Piece),
    ) {
        for turn in 0..3 {
            let [a, b, c] = [0, 1, 2].map(|i| piece[(turn + i) % 3]);
            let Some((axis, plane)) = self.next_cut(cell, a.at, b.at) else { continue };
            let between = crossing(a, b, axis, plane);
            for part in [[a, between, c], [between, b, c]] {
                self.divide_edges((leaf, cell), part, pieces);
            }
            return;
        }
        pieces(leaf, piece);
    }

    /// Returns the axis and place of the plane at which deeper leaves beside a leaf cut an edge
    /// first.
    fn next_cut(&self, cell: Cell, a: Point, b: Point) -> Option<(usize, i32)> {
        let sides = cell.sides_of(a) & cell.sides_of(b);
        if sides == 0 {
            return None;
        }
        let side = sides.trailing_zeros() as usize;
        let (normal, way) = (side / 2, if side.is_multiple_of(2) { -1 } else { 1 });
        let mut toward = [0; 3];
        toward[normal] = way;
        let mut depth = cell.depth;
        loop {
            let node = self.tree.nodes()[self.tree.beside(a, self.inward(a, b, toward), depth)?];
            if node.cell.depth < depth || node.children.is_none() {
                return None;
            }
            let middle = node.cell.middle();
            let side = |point: Point, axis: usize| (point[axis] - middle[axis]).signum();
            let is_between = |&axis: &usize| axis != normal && side(a, axis) * side(b, axis) < 0;
            if let Some(axis) = (0..3).find(is_between) {
                return Some((axis, middle[axis]));
            }
            depth += 1;
        }
    }

    /// Adds to the direction across a side where an edge goes from its first end, which may be on a
    /// plane between cells beside it.
    fn inward(&self, a: Point, b: Point, toward: [i32; 3]) -> [i32; 3] {
        [0, 1, 2].map(|axis| match toward[axis] {
            0 => (b[axis] - a[axis]).signum(),
            way => way,
        })
    }
}

fn octant(at: Point, middle: Point) -> usize {
    (0..3).fold(0, |octant, axis| octant | usize::from(at[axis] >= middle[axis]) << axis)
}

/// Splits a convex polygon at a plane that none of its corners is on.
fn split(polygon: Vec<Corner>, axis: usize, plane: i32) -> [Vec<Corner>; 2] {
    let is_far = |corner: &Corner| corner.at[axis] > plane;
    let far = polygon.iter().filter(|corner| is_far(corner)).count();
    if far == 0 {
        return [polygon, Vec::new()];
    }
    if far == polygon.len() {
        return [Vec::new(), polygon];
    }
    let mut parts = [Vec::new(), Vec::new()];
    for (i, corner) in polygon.iter().enumerate() {
        let next = &polygon[(i + 1) % polygon.len()];
        add(&mut parts[usize::from(is_far(corner))], *corner);
        if is_far(corner) != is_far(next) {
            let between = crossing(*corner, *next, axis, plane);
            parts.iter_mut().for_each(|part| add(part, between));
        }
    }
    parts.map(|mut part| {
        while part.len() > 1 && part[0].at == part[part.len() - 1].at {
            part.pop();
        }
        part
    })
}

/// Adds a corner to a polygon unless it is at the point of the last one.
fn add(polygon: &mut Vec<Corner>, corner: Corner) {
    if polygon.last().is_none_or(|last| last.at != corner.at) {
        polygon.push(corner);
    }
}

/// Returns the point where an edge crosses a plane. It does not depend on the direction of the edge.
fn crossing(a: Corner, b: Corner, axis: usize, plane: i32) -> Corner {
    let (a, b) = if a.at <= b.at { (a, b) } else { (b, a) };
    let wide = |x: i32| i64::from(x);
    let (n, d) = (wide(plane - a.at[axis]), wide(b.at[axis] - a.at[axis]));
    let (n, d) = if d < 0 { (-n, -d) } else { (n, d) };
    let at = [0, 1, 2].map(|other| match other == axis {
        true => plane,
        false if a.at[other] == b.at[other] => a.at[other],
        false => nearest_odd(wide(a.at[other]) * d + wide(b.at[other] - a.at[other]) * n, d),
    });
    let part = (n as f64 / d as f64) as f32;
    let weights = [0, 1, 2].map(|i| a.weights[i] + part * (b.weights[i] - a.weights[i]));
    Corner { at, weights }
}
