//! Top-down construction of a bounding volume hierarchy with the binned surface area heuristic.

use glam::{Vec3, Vec4};
use meshlod_mesh::FaceId;
use rayon::prelude::*;

use crate::box3::Box3;
use crate::bvh::{INNER, Node};
use crate::triangle::Triangle;

/// Maximum number of triangles in a leaf. On the dragon (871,000 faces), compared with 2: a limit
/// of 1 makes queries 7 % faster and building 15 % slower, a limit of 4 queries 15 % slower and
/// building 20 % faster.
const LEAF: usize = 2;
/// Bins along the longest axis. With 16, queries are as fast and building is 5 % slower.
const BINS: usize = 8;
/// Ranges at least this long build their children in parallel, each into its own vector.
const GRAIN: usize = 1 << 13;
/// Depth from which ranges are halved by count, so that adversarial meshes cannot make the tree
/// deep.
const MAX_COSTED_DEPTH: usize = 40;
/// Bound on the depth: beyond `MAX_COSTED_DEPTH` each level halves at most 2^32 faces.
pub(crate) const MAX_DEPTH: usize = MAX_COSTED_DEPTH + 32;

/// A face, or what else has a box, and its box, rounded outwards.
#[derive(Clone, Copy)]
struct Item {
    bounds: Box3,
    face: FaceId,
}

/// Consecutive items that become one child of a node.
struct Run<'a> {
    items: &'a mut [Item],
    /// Index of its first item among all items.
    first: usize,
    bounds: Box3,
}

/// Builds the nodes over triangles, root first, and returns them with the faces in leaf order.
pub(crate) fn build(
    count: usize,
    triangle: impl Fn(FaceId) -> Triangle + Sync,
) -> (Vec<Node>, Vec<FaceId>) {
    build_over::<LEAF>(count, |face| Box3::around(&triangle(face)))
}

/// Builds the nodes over boxes, root first, with at most `LEAF` of them in a leaf, and returns them
/// with the numbers of the boxes in leaf order.
pub(crate) fn build_over<const LEAF: usize>(
    count: usize,
    bounds: impl Fn(FaceId) -> Box3 + Sync,
) -> (Vec<Node>, Vec<FaceId>) {
    let item = |i: usize| Item { bounds: bounds(FaceId::new(i)), face: FaceId::new(i) };
    let mut items: Vec<Item> = (0..count).into_par_iter().map(item).collect();
    let bounds = union(&items);
    let nodes = build_nodes::<LEAF>(Run { items: &mut items, first: 0, bounds }, 0);
    (nodes, items.iter().map(|item| item.face).collect())
}

/// Builds the nodes of a run, its root first; indices of inner children are relative to it.
fn build_nodes<const LEAF: usize>(run: Run<'_>, depth: usize) -> Vec<Node> {
    let parallel = run.items.len() >= GRAIN;
    let runs = split_in_four::<LEAF>(run, depth);
    let mut nodes = vec![Node::of::<LEAF>(&runs)];
    let inner: Vec<(usize, Run<'_>)> =
        runs.into_iter().enumerate().filter(|(_, run)| run.items.len() > LEAF).collect();
    if parallel {
        let built: Vec<(usize, Vec<Node>)> = inner
            .into_par_iter()
            .map(|(child, run)| (child, build_nodes::<LEAF>(run, depth + 1)))
            .collect();
        for (child, subtree) in built {
            let base = nodes.len() as u32;
            nodes[0].first[child] = base;
            nodes.extend(subtree.into_iter().map(|node| node.moved(base)));
        }
    } else {
        for (child, run) in inner {
            nodes[0].first[child] = nodes.len() as u32;
            append_nodes::<LEAF>(&mut nodes, run, depth + 1);
        }
    }
    nodes
}

/// Appends the nodes of a run, its root first; indices of inner children are absolute.
fn append_nodes<const LEAF: usize>(nodes: &mut Vec<Node>, run: Run<'_>, depth: usize) {
    let top = nodes.len();
    let runs = split_in_four::<LEAF>(run, depth);
    nodes.push(Node::of::<LEAF>(&runs));
    for (child, run) in runs.into_iter().enumerate() {
        if run.items.len() > LEAF {
            nodes[top].first[child] = nodes.len() as u32;
            append_nodes::<LEAF>(nodes, run, depth + 1);
        }
    }
}

/// Splits a run, then the part of largest area, until there are four parts or only leaves.
fn split_in_four<const LEAF: usize>(run: Run<'_>, depth: usize) -> Vec<Run<'_>> {
    let mut runs = Vec::with_capacity(4);
    runs.push(run);
    while runs.len() < 4 {
        let largest = (0..runs.len())
            .filter(|&i| runs[i].items.len() > LEAF)
            .max_by(|&i, &j| runs[i].bounds.area().total_cmp(&runs[j].bounds.area()));
        let Some(largest) = largest else { break };
        let (left, right) = split(runs.remove(largest), depth);
        runs.insert(largest, left);
        runs.insert(largest + 1, right);
    }
    runs
}

/// Splits a run into two nonempty parts where count × area is least, or by count if no bin boundary
/// separates the items.
fn split(run: Run<'_>, depth: usize) -> (Run<'_>, Run<'_>) {
    let Run { items, first, bounds } = run;
    let cheapest = if depth < MAX_COSTED_DEPTH { Binning::of(&bounds).split(items) } else { None };
    let cut = cheapest.unwrap_or_else(|| halve(items));
    let (left, right) = items.split_at_mut(cut.middle);
    (
        Run { items: left, first, bounds: cut.left },
        Run { items: right, first: first + cut.middle, bounds: cut.right },
    )
}

/// Split position of a run and the boxes of both parts.
struct Cut {
    middle: usize,
    left: Box3,
    right: Box3,
}

/// Splits the items in half by their centres along the axis on which these are spread widest.
fn halve(items: &mut [Item]) -> Cut {
    let centers = items.iter().map(|item| item.bounds.center());
    let (lo, hi) = centers.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), center| {
        (lo.min(center), hi.max(center))
    });
    let axis = (hi - lo).max_position();
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |x, y| {
        let [x_at, y_at] = [x, y].map(|item| item.bounds.center()[axis]);
        x_at.total_cmp(&y_at).then(x.face.cmp(&y.face))
    });
    let (left, right) = items.split_at(middle);
    Cut { middle, left: union(left), right: union(right) }
}

/// Equal bins along the longest axis of a box, into which items fall by their centres.
struct Binning {
    axis: usize,
    start: f32,
    per_unit: f32,
}

#[derive(Clone, Copy)]
struct Bin {
    bounds: Box3,
    count: usize,
}

impl Binning {
    fn of(bounds: &Box3) -> Self {
        let extent = bounds.hi - bounds.lo;
        let axis = extent.max_position();
        // Centres are doubled, and so is their range. Without extent all fall into one bin.
        let per_unit = BINS as f32 / (2.0 * extent[axis]).max(f32::MIN_POSITIVE * BINS as f32);
        Self { axis, start: 2.0 * bounds.lo[axis], per_unit }
    }

    fn bin(&self, item: &Item) -> usize {
        let at = (item.bounds.center()[self.axis] - self.start) * self.per_unit;
        (at as usize).min(BINS - 1)
    }

    /// Partitions the items at the cheapest bin boundary; `None` if all are in one bin.
    fn split(&self, items: &mut [Item]) -> Option<Cut> {
        let empty = Bin { bounds: Box3::EMPTY, count: 0 };
        let mut bins = [empty; BINS];
        for item in items.iter() {
            bins[self.bin(item)].add(&Bin { bounds: item.bounds, count: 1 });
        }
        // `after[i]` covers all bins from i on.
        let mut after = bins;
        for i in (0..BINS - 1).rev() {
            let next = after[i + 1];
            after[i].add(&next);
        }
        let mut before = empty;
        let mut least = f32::INFINITY;
        let mut cheapest = None;
        for i in 1..BINS {
            before.add(&bins[i - 1]);
            let cost = before.cost() + after[i].cost();
            if before.count > 0 && after[i].count > 0 && cost < least {
                least = cost;
                cheapest = Some((i, before, after[i].bounds));
            }
        }
        let (bound, left, right) = cheapest?;
        partition(items, |item| self.bin(item) < bound);
        Some(Cut { middle: left.count, left: left.bounds, right })
    }
}

impl Bin {
    fn add(&mut self, other: &Self) {
        self.bounds = self.bounds.merged(&other.bounds);
        self.count += other.count;
    }

    fn cost(&self) -> f32 {
        self.bounds.area() * self.count as f32
    }
}

/// Moves the items for which `left` holds to the front.
fn partition(items: &mut [Item], left: impl Fn(&Item) -> bool) {
    let (mut i, mut j) = (0, items.len());
    loop {
        while i < j && left(&items[i]) {
            i += 1;
        }
        while i < j && !left(&items[j - 1]) {
            j -= 1;
        }
        if i >= j {
            return;
        }
        items.swap(i, j - 1);
    }
}

/// Returns the box around all items.
fn union(items: &[Item]) -> Box3 {
    items.iter().fold(Box3::EMPTY, |all, item| all.merged(&item.bounds))
}

impl Node {
    /// Returns the node over up to four runs, the small ones being leaves.
    fn of<const LEAF: usize>(runs: &[Run<'_>]) -> Self {
        // A missing child is an empty leaf, infinitely far away.
        let mut lo = [Vec4::INFINITY; 3];
        let mut hi = [Vec4::NEG_INFINITY; 3];
        let (mut first, mut count) = ([0; 4], [0; 4]);
        for (child, run) in runs.iter().enumerate() {
            for axis in 0..3 {
                lo[axis][child] = run.bounds.lo[axis];
                hi[axis][child] = run.bounds.hi[axis];
            }
            first[child] = run.first as u32;
            count[child] = if run.items.len() > LEAF { INNER } else { run.items.len() as u8 };
        }
        Self { lo, hi, first, count }
    }

    /// Shifts the indices of inner children by `base`, the number of nodes before its subtree.
    fn moved(mut self, base: u32) -> Self {
        for child in 0..4 {
            if self.count[child] == INNER {
                self.first[child] += base;
            }
        }
        self
    }
}
