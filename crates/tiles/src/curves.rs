//! Curves along which tiles meet, simplified by a rule that sees the curve alone.
//!
//! A curve is what a surface leaves in a side of a cell: two neighbours have it alike, edge by edge,
//! in opposite directions. It is divided where it meets another side, branches or ends, and where it
//! crosses a seam. Between these points the algorithm of Douglas and Peucker [DP73] keeps what is
//! farther away than a tolerance. So both neighbours keep the same points, without hearing of each
//! other.

use meshlod_mesh::VertexId;
use rustc_hash::{FxHashMap, FxHashSet};

use crate::cell::Cell;
use crate::lattice::Point;
use crate::octree::TileTree;
use crate::tile::TileMesh;

/// Border of a tile after its curves have been simplified.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SimplerBorder {
    /// Edges that are left or new.
    pub edges: Vec<[VertexId; 2]>,
    /// Triangles between the old edges and the new ones: with them as faces, the new edges are the
    /// border.
    pub flaps: Vec<Flap>,
    /// Greatest distance between an old vertex and the new edges, in steps.
    pub distance: f64,
}

/// Triangle between old edges of a border and a new one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flap {
    /// Its corners.
    pub corners: [VertexId; 3],
    /// Old edge at each corner, whose face has the attributes of the flap there.
    pub edges: [[VertexId; 2]; 3],
}

/// Simplifies the border of a tile of an octree within a tolerance, in steps. Sides on which a leaf
/// shows its own surface stay as they are.
pub fn simplify_border(
    tile: &TileMesh,
    cell: Cell,
    tree: &TileTree,
    tolerance: f64,
) -> SimplerBorder {
    let mut result = SimplerBorder::default();
    let points: Vec<Point> =
        (0..tile.mesh.positions.len()).map(|i| tile.point(VertexId::new(i))).collect();
    for side in 0..6 {
        let is_on = |v: VertexId| cell.sides_of(points[v.index()]) >> side & 1 == 1;
        let edges = tile.border.iter().copied().filter(|edge| edge.iter().all(|&v| is_on(v)));
        let edges: Vec<[VertexId; 2]> = edges.collect();
        if edges.is_empty() || meets_leaf(tree, cell, side) {
            result.edges.extend(edges);
            continue;
        }
        let seams = &tile.seams;
        let mut side = Side { cell, points: &points, seams, tolerance, result: &mut result };
        side.simplify(&edges);
    }
    result
}

/// Returns true if what is beyond a side of a cell is shown by a leaf at this depth.
fn meets_leaf(tree: &TileTree, cell: Cell, side: usize) -> bool {
    let (axis, is_far) = (side / 2, side % 2 == 1);
    let mut point = cell.middle();
    point[axis] = if is_far { cell.high()[axis] } else { cell.low()[axis] };
    let mut toward = [0; 3];
    toward[axis] = if is_far { 1 } else { -1 };
    tree.beside(point, toward, cell.depth).is_none_or(|node| {
        let node = &tree.nodes()[node];
        node.cell.depth < cell.depth || node.children.is_none()
    })
}

/// Curves in a side of a cell.
struct Side<'a> {
    cell: Cell,
    points: &'a [Point],
    seams: &'a [Point],
    tolerance: f64,
    result: &'a mut SimplerBorder,
}

/// Part of a curve between two vertices that stay: its vertices, and those of them that stay.
struct Chain {
    vertices: Vec<VertexId>,
    kept: Vec<usize>,
}

impl Side<'_> {
    fn simplify(&mut self, edges: &[[VertexId; 2]]) {
        let mut chains = self.chains(edges);
        for chain in &mut chains {
            chain.kept = self.kept(&chain.vertices);
        }
        self.open_lenses(&mut chains);
        chains.iter().for_each(|chain| self.put(chain));
    }

    fn at(&self, v: VertexId) -> Point {
        self.points[v.index()]
    }

    /// Divides the curves at all vertices that stay in any case. Small pieces that meet nothing are
    /// left out, and loops among them closed.
    fn chains(&mut self, edges: &[[VertexId; 2]]) -> Vec<Chain> {
        let mut next: FxHashMap<VertexId, Vec<VertexId>> = FxHashMap::default();
        let mut before: FxHashMap<VertexId, usize> = FxHashMap::default();
        for &[a, b] in edges {
            next.entry(a).or_default().push(b);
            *before.entry(b).or_default() += 1;
        }
        let is_anchor = |v: VertexId| {
            let through =
                next.get(&v).is_some_and(|next| next.len() == 1) && before.get(&v) == Some(&1);
            !through || self.cell.sides_of(self.at(v)).count_ones() > 1
        };
        let mut chains = Vec::new();
        let mut done: FxHashSet<VertexId> = FxHashSet::default();
        let follow = |first: VertexId, second: VertexId, done: &mut FxHashSet<VertexId>| {
            let mut vertices = vec![first, second];
            let mut last = second;
            while !is_anchor(last) && last != first {
                done.insert(last);
                last = next[&last][0];
                vertices.push(last);
            }
            vertices
        };
        for &[a, b] in edges.iter().filter(|[a, _]| is_anchor(*a)) {
            let vertices = follow(a, b, &mut done);
            let is_alone = |v: VertexId| {
                self.cell.sides_of(self.at(v)).count_ones() == 1
                    && next.get(&v).map_or(0, Vec::len) + before.get(&v).unwrap_or(&0) == 1
            };
            let last = vertices[vertices.len() - 1];
            let is_piece = is_alone(a) && is_alone(last);
            // Both neighbours start at the end with the lesser point.
            let start = if self.at(a) < self.at(last) { a } else { last };
            if !is_piece || self.farthest_from(start, &vertices).1 > self.tolerance {
                chains.push(vertices);
            }
        }
        let mut loops = Vec::new();
        for &[a, b] in edges {
            if !is_anchor(a) && !done.contains(&a) {
                done.insert(a);
                loops.push(follow(a, b, &mut done));
            }
        }
        for mut vertices in loops {
            vertices.pop();
            let least = (0..vertices.len()).min_by_key(|&i| self.at(vertices[i])).unwrap_or(0);
            vertices.rotate_left(least);
            if self.farthest_from(vertices[0], &vertices).1 <= self.tolerance {
                self.close(&vertices);
                continue;
            }
            vertices.push(vertices[0]);
            chains.push(vertices);
        }
        let chains = chains.into_iter().flat_map(|vertices| self.halves(vertices));
        let chains = chains.flat_map(|vertices| self.between_seams(vertices));
        chains.map(|vertices| Chain { vertices, kept: Vec::new() }).collect()
    }

    /// Divides a chain that ends where it starts at its farthest vertex.
    fn halves(&self, vertices: Vec<VertexId>) -> Vec<Vec<VertexId>> {
        if vertices[0] != vertices[vertices.len() - 1] {
            return vec![vertices];
        }
        let (farthest, _) = self.farthest_from(vertices[0], &vertices[1..vertices.len() - 1]);
        vec![vertices[..=farthest + 1].to_vec(), vertices[farthest + 1..].to_vec()]
    }

    /// Divides a chain where it crosses seams.
    fn between_seams(&self, vertices: Vec<VertexId>) -> Vec<Vec<VertexId>> {
        let last = vertices.len() - 1;
        let is_seam = |&i: &usize| self.seams.binary_search(&self.at(vertices[i])).is_ok();
        let mut ends: Vec<usize> = (1..last).filter(is_seam).collect();
        ends.insert(0, 0);
        ends.push(last);
        ends.windows(2).map(|ends| vertices[ends[0]..=ends[1]].to_vec()).collect()
    }

    /// Returns the place in a list of the vertex that is farthest from another, and its distance.
    fn farthest_from(&self, from: VertexId, vertices: &[VertexId]) -> (usize, f64) {
        let from = self.at(from);
        let all =
            vertices.iter().map(|&v| (distance_to_segment(self.at(v), [from, from]), self.at(v)));
        farthest(all).expect("there are vertices")
    }

    /// Closes a small loop by triangles around its first vertex.
    fn close(&mut self, vertices: &[VertexId]) {
        let around = vertices[1..].windows(2);
        let first = [vertices[0], vertices[1]];
        self.result.flaps.extend(around.map(|pair| {
            let edge = [pair[0], pair[1]];
            Flap { corners: [vertices[0], pair[1], pair[0]], edges: [first, edge, edge] }
        }));
        self.result.distance =
            self.result.distance.max(self.farthest_from(vertices[0], vertices).1);
    }

    /// Returns the places in a chain of the vertices that stay.
    fn kept(&self, vertices: &[VertexId]) -> Vec<usize> {
        let mut kept = vec![0, vertices.len() - 1];
        let mut spans = vec![[0, vertices.len() - 1]];
        while let Some([first, last]) = spans.pop() {
            match self.farthest_between(vertices, [first, last]) {
                Some((middle, distance)) if distance > self.tolerance => {
                    kept.push(middle);
                    spans.extend([[first, middle], [middle, last]]);
                }
                _ => {}
            }
        }
        kept.sort_unstable();
        kept
    }

    /// Returns the place of the vertex that is farthest from the line between two others of a chain,
    /// and its distance.
    fn farthest_between(
        &self,
        vertices: &[VertexId],
        [first, last]: [usize; 2],
    ) -> Option<(usize, f64)> {
        let ends = [first, last].map(|i| self.at(vertices[i]));
        let between = vertices[first + 1..last].iter();
        let all = between.map(|&v| (distance_to_segment(self.at(v), ends), self.at(v)));
        farthest(all).map(|(i, distance)| (first + 1 + i, distance))
    }

    /// Keeps a vertex more of chains that would become one edge with another.
    fn open_lenses(&self, chains: &mut [Chain]) {
        let ends = |chain: &Chain| {
            let [a, b] = [chain.vertices[0], chain.vertices[chain.vertices.len() - 1]];
            if a < b { [a, b] } else { [b, a] }
        };
        let mut straight: FxHashMap<[VertexId; 2], usize> = FxHashMap::default();
        for chain in chains.iter().filter(|chain| chain.kept.len() == 2) {
            *straight.entry(ends(chain)).or_default() += 1;
        }
        for chain in chains.iter_mut().filter(|chain| chain.kept.len() == 2) {
            let last = chain.vertices.len() - 1;
            if straight[&ends(chain)] > 1
                && let Some((middle, _)) = self.farthest_between(&chain.vertices, [0, last])
            {
                chain.kept.insert(1, middle);
            }
        }
    }

    /// Adds what a chain becomes to the result.
    fn put(&mut self, chain: &Chain) {
        for pair in chain.kept.windows(2) {
            self.result.edges.push([chain.vertices[pair[0]], chain.vertices[pair[1]]]);
            let mut spans = vec![[pair[0], pair[1]]];
            let farthest = self.farthest_between(&chain.vertices, spans[0]);
            self.result.distance = farthest.map_or(0.0, |(_, most)| most).max(self.result.distance);
            while let Some([first, last]) = spans.pop() {
                if let Some((middle, _)) = self.farthest_between(&chain.vertices, [first, last]) {
                    let corners = [first, last, middle].map(|i| chain.vertices[i]);
                    let edge = |i: usize| [chain.vertices[i], chain.vertices[i + 1]];
                    let edges = [edge(first), edge(last - 1), edge(middle)];
                    self.result.flaps.push(Flap { corners, edges });
                    spans.extend([[first, middle], [middle, last]]);
                }
            }
        }
    }
}

/// Returns the place of the greatest distance; of equal ones that of the least point.
fn farthest(all: impl Iterator<Item = (f64, Point)>) -> Option<(usize, f64)> {
    let mut best: Option<(usize, f64, Point)> = None;
    for (i, (distance, at)) in all.enumerate() {
        if best.is_none_or(|(_, most, point)| distance > most || (distance == most && at < point)) {
            best = Some((i, distance, at));
        }
    }
    best.map(|(i, distance, _)| (i, distance))
}

/// Returns the distance of a point from a segment, with equal bits for both orders of its ends.
fn distance_to_segment(point: Point, ends: [Point; 2]) -> f64 {
    let [a, b] = if ends[0] <= ends[1] { ends } else { [ends[1], ends[0]] };
    let wide = |x: i32| f64::from(x);
    let along = [0, 1, 2].map(|axis| wide(b[axis]) - wide(a[axis]));
    let to = [0, 1, 2].map(|axis| wide(point[axis]) - wide(a[axis]));
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let squared = dot(along, along);
    let part = if squared > 0.0 { (dot(to, along) / squared).clamp(0.0, 1.0) } else { 0.0 };
    let off = [0, 1, 2].map(|axis| to[axis] - part * along[axis]);
    dot(off, off).sqrt()
}
