//! The vertices of outlines that stay, and the sides between them.

use glam::DVec3;
use meshlod_mesh::{Connectivity, FaceId, Mesh, Side, Twin, VertexId, WedgeId};
use robust::{Coord, orient2d};
use rustc_hash::FxHashSet;

use crate::flat::FlatOptions;
use crate::flat::linear::Linear;
use crate::flat::regions::{Region, Regions};

/// Part of the tolerance by which an outline may move in its plane.
const ASIDE: f64 = 0.7;

/// Number of times that chains are divided where they are farthest off. Those that are cut at an end
/// each time would take the square of their vertices, so they are divided in the middle from there on.
const DIVISIONS: usize = 32;

/// Side of a region's new outline; the region is on its left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OutlineSide {
    pub(super) from: VertexId,
    pub(super) to: VertexId,
    /// Wedge of the region at `from`.
    pub(super) wedge: WedgeId,
}

/// The outlines of all regions that are filled anew.
#[derive(Debug)]
pub(super) struct Outlines {
    /// Sides of each region's outline.
    pub(super) sides: Vec<Vec<OutlineSide>>,
    /// Upper bound of the distance that an outline has moved.
    pub(super) moved: f64,
}

/// Edge of the outline of one region or several.
#[derive(Clone, Copy, Debug)]
struct Edge {
    ends: [u32; 2],
    /// Its regions, as a range of those of all edges.
    regions: [usize; 2],
}

/// Outlines as a graph: edges between vertices, each with its regions.
struct Graph<'m> {
    mesh: &'m Mesh,
    edges: Vec<Edge>,
    regions: Vec<u32>,
    /// The first two edges at each vertex.
    at: Vec<[u32; 2]>,
    /// Number of edges at each vertex; 255 stands for more.
    count: Vec<u8>,
}

impl Outlines {
    pub(super) fn new(
        mesh: &Mesh,
        connectivity: &Connectivity,
        linear: &Linear<'_>,
        regions: &Regions,
        held: &[bool],
        options: &FlatOptions<'_>,
    ) -> Self {
        let outer = outer_sides(mesh, connectivity, linear, regions);
        let graph = Graph::new(mesh, &outer);
        let mut stays = held.to_vec();
        hold_kept(mesh, regions, &mut stays);
        if options.lock_boundary {
            let is_open = |side: &&(u32, Side)| connectivity.twin(side.1) == Twin::Boundary;
            let open = outer.iter().filter(is_open).flat_map(|(_, side)| side.ends(&mesh.faces));
            open.for_each(|v| stays[v.index()] = true);
        }
        let most = ASIDE * options.tolerance;
        let gone = (0..stays.len() as u32).map(|v| !stays[v as usize] && graph.is_spare(v, most));
        let mut gone: Vec<bool> = gone.collect();
        let moved = if most > 0.0 { graph.straighten(&mut gone, most) } else { 0.0 };
        keep_apart(&graph, &outer, regions, &mut gone);
        let mut sides = vec![Vec::new(); regions.list.len()];
        for &(region, side) in &outer {
            let [from, next] = side.ends(&mesh.faces);
            if !gone[from.index()] {
                let [to, _] = graph.follow(from.0, next.0, &gone);
                let wedge = mesh.corner_wedges(side.face().index())[side.corner()];
                sides[region as usize].push(OutlineSide { from, to: VertexId(to), wedge });
            }
        }
        Self { sides, moved }
    }
}

/// Returns the sides of faces that are outlines of regions to be filled.
fn outer_sides(
    mesh: &Mesh,
    connectivity: &Connectivity,
    linear: &Linear<'_>,
    regions: &Regions,
) -> Vec<(u32, Side)> {
    let mut outer = Vec::new();
    for (face, &region) in regions.of_face.iter().enumerate() {
        if regions.list[region as usize].is_kept {
            continue;
        }
        let sides = (0..3).map(|k| Side::new(FaceId::new(face), k));
        let is_outer = |&side: &Side| is_outer(mesh, connectivity, linear, regions, side);
        outer.extend(sides.filter(is_outer).map(|side| (region, side)));
    }
    outer
}

/// Returns true if a side is not inside its region.
fn is_outer(
    mesh: &Mesh,
    connectivity: &Connectivity,
    linear: &Linear<'_>,
    regions: &Regions,
    side: Side,
) -> bool {
    let Twin::Side(twin) = connectivity.twin(side) else { return true };
    let [[a, b], [c, d]] = [side, twin].map(|side| side.ends(&mesh.faces));
    let [here, there] = [side, twin].map(|side| regions.of_face[side.face().index()]);
    here != there || [a, b] != [d, c] || linear.is_seam(side, twin)
}

/// Vertices of a region.
struct OutlineCorners {
    /// The vertex at each corner of its faces, in order.
    all: Vec<VertexId>,
    /// The vertices on its outline, in order.
    outer: Vec<VertexId>,
    /// Number of sides of its outline.
    sides: usize,
}

impl OutlineCorners {
    fn of(
        mesh: &Mesh,
        connectivity: &Connectivity,
        linear: &Linear<'_>,
        (regions, region): (&Regions, &Region),
    ) -> Self {
        let mut this = Self { all: Vec::new(), outer: Vec::new(), sides: 0 };
        for &face in &region.faces {
            this.all.extend(mesh.faces[face as usize]);
            for side in (0..3).map(|k| Side::new(FaceId(face), k)) {
                if is_outer(mesh, connectivity, linear, regions, side) {
                    this.outer.extend(side.ends(&mesh.faces));
                    this.sides += 1;
                }
            }
        }
        this.all.sort_unstable();
        this.outer.sort_unstable();
        this.outer.dedup();
        this
    }

    /// Returns the vertices inside, each with its number of corners.
    fn inner(&self) -> impl Iterator<Item = (VertexId, usize)> {
        let each = self.all.chunk_by(|a, b| a == b).map(|same| (same[0], same.len()));
        each.filter(|(v, _)| self.outer.binary_search(v).is_err())
    }
}

/// Returns how many faces a region has once what is spare is gone, given how many sides its outline
/// has then: a vertex that goes from an outline takes one face, and one inside takes two.
pub(super) fn least_faces(
    mesh: &Mesh,
    connectivity: &Connectivity,
    linear: &Linear<'_>,
    (regions, region): (&Regions, &Region),
    sides: usize,
) -> usize {
    let corners = OutlineCorners::of(mesh, connectivity, linear, (regions, region));
    let gone = corners.sides - sides.min(corners.sides) + 2 * corners.inner().count();
    region.faces.len().saturating_sub(gone)
}

/// Returns the regions to be filled that have a vertex inside which other faces have, too: these
/// would come apart.
pub(super) fn pinched(
    mesh: &Mesh,
    connectivity: &Connectivity,
    linear: &Linear<'_>,
    regions: &Regions,
) -> Vec<usize> {
    let mut count = vec![0; mesh.positions.len()];
    mesh.faces.iter().flatten().for_each(|v| count[v.index()] += 1);
    let filled = regions.list.iter().enumerate().filter(|(_, region)| !region.is_kept);
    let is_pinched = |region| {
        let corners = OutlineCorners::of(mesh, connectivity, linear, (regions, region));
        corners.inner().any(|(v, own)| own < count[v.index()])
    };
    filled.filter(|(_, region)| is_pinched(region)).map(|(r, _)| r).collect()
}

/// Holds all vertices of regions that stay as they are.
fn hold_kept(mesh: &Mesh, regions: &Regions, stays: &mut [bool]) {
    for region in regions.list.iter().filter(|region| region.is_kept) {
        for v in region.faces.iter().flat_map(|&face| mesh.faces[face as usize]) {
            stays[v.index()] = true;
        }
    }
}

/// Brings back a vertex of each straight part whose new side would be where another edge is, too: that
/// would close a slit, or make an edge of more faces.
fn keep_apart(graph: &Graph<'_>, outer: &[(u32, Side)], regions: &Regions, gone: &mut [bool]) {
    let faces = &graph.mesh.faces;
    // Ends in order, and the first vertex after the lower one, which is the other end of an edge.
    let part = |&(_, side): &(u32, Side)| {
        let [from, next] = side.ends(faces).map(|v| v.0);
        let [to, last] =
            if gone[from as usize] { return None } else { graph.follow(from, next, gone) };
        Some(if from < to { ([from, to], next) } else { ([to, from], last) })
    };
    let mut parts: Vec<([u32; 2], u32)> = outer.iter().filter_map(part).collect();
    let long = parts.iter().filter(|(ends, first)| *first != ends[1]);
    let long: FxHashSet<[u32; 2]> = long.map(|&(ends, _)| ends).collect();
    if long.is_empty() {
        return;
    }
    let kept = regions.list.iter().filter(|region| region.is_kept);
    for &[a, b, c] in kept.flat_map(|region| &region.faces).map(|&face| &faces[face as usize]) {
        let edges = [[a, b], [b, c], [c, a]].map(|[a, b]| [a.0.min(b.0), a.0.max(b.0)]);
        parts.extend(edges.into_iter().filter(|ends| long.contains(ends)).map(|e| (e, e[1])));
    }
    parts.sort_unstable();
    parts.dedup();
    // Both sides of a slit need a vertex, or one would lie across that of the other.
    for &(_, first) in parts.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() > 1).flatten() {
        gone[first as usize] = false;
    }
}

impl<'m> Graph<'m> {
    fn new(mesh: &'m Mesh, outer: &[(u32, Side)]) -> Self {
        let key = |&(region, side): &(u32, Side)| {
            let [a, b] = side.ends(&mesh.faces).map(|v| v.0);
            ([a.min(b), a.max(b)], region)
        };
        let mut sorted: Vec<([u32; 2], u32)> = outer.iter().map(key).collect();
        sorted.sort_unstable();
        let mut edges = Vec::new();
        let mut start = 0;
        for of_edge in sorted.chunk_by(|a, b| a.0 == b.0) {
            let end = start + of_edge.len();
            edges.push(Edge { ends: of_edge[0].0, regions: [start, end] });
            start = end;
        }
        let regions = sorted.into_iter().map(|(_, region)| region).collect();
        let count = vec![0u8; mesh.positions.len()];
        let at = vec![[u32::MAX; 2]; mesh.positions.len()];
        let mut this = Self { mesh, edges, regions, at, count };
        for (i, edge) in this.edges.iter().enumerate() {
            for v in edge.ends.map(|v| v as usize) {
                if let Some(slot) = this.at[v].get_mut(usize::from(this.count[v])) {
                    *slot = i as u32;
                }
                this.count[v] = this.count[v].saturating_add(1);
            }
        }
        this
    }

    /// Returns the vertices before and after one that has two edges.
    fn beside(&self, v: u32) -> [u32; 2] {
        self.at[v as usize].map(|edge| {
            let [a, b] = self.edges[edge as usize].ends;
            if a == v { b } else { a }
        })
    }

    /// Returns true if a vertex is on a straight line between the same regions: no more than `most`
    /// beside it, or exactly on it if that is 0. Between two regions the line may go back and forth,
    /// since one of them has no area there; a border that does so is the end of a slit.
    fn is_spare(&self, v: u32, most: f64) -> bool {
        if self.count[v as usize] != 2 {
            return false;
        }
        let regions = self.at[v as usize].map(|edge| {
            let [start, end] = self.edges[edge as usize].regions;
            &self.regions[start..end]
        });
        let [a, b] = self.beside(v).map(|v| self.place(v));
        let at = self.place(v);
        let is_between = regions[0].first() != regions[0].last();
        regions[0] == regions[1]
            && (is_between || (at - a).dot(b - at) > 0.0)
            && if most > 0.0 { beside([a, b], at) <= most } else { is_on_line([a, at, b]) }
    }

    /// Returns the first vertex that stays on the way from one to the next, and the one before it.
    fn follow(&self, from: u32, next: u32, gone: &[bool]) -> [u32; 2] {
        let (mut last, mut at) = (from, next);
        while gone[at as usize] && at != from {
            let [a, b] = self.beside(at);
            (last, at) = (at, if a == last { b } else { a });
        }
        [at, last]
    }

    /// Brings vertices back until none that is gone is more than `most` from the line that replaces
    /// it. Returns the largest distance.
    fn straighten(&self, gone: &mut [bool], most: f64) -> f64 {
        let mut farthest = 0.0f64;
        let mut is_done = vec![false; gone.len()];
        for stays in [true, false] {
            // Rings of vertices that are all gone come last, and keep the first one.
            for v in 0..gone.len() as u32 {
                let is_start = gone[v as usize] && !is_done[v as usize];
                let begins = is_start && self.beside(v).iter().any(|&u| !gone[u as usize]);
                if is_start && (begins || !stays) {
                    gone[v as usize] &= stays;
                    let chain = self.chain(v, gone);
                    chain.iter().for_each(|&v| is_done[v as usize] = true);
                    farthest = farthest.max(self.divide(&chain, gone, most));
                }
            }
        }
        farthest
    }

    /// Returns the vertices from one that stays to the next, through one that is gone, or all of a
    /// ring from one that stays on.
    fn chain(&self, v: u32, gone: &[bool]) -> Vec<u32> {
        let [a, b] = self.beside(v);
        let mut chain = match gone[v as usize] {
            true if !gone[a as usize] => vec![a, v],
            true => vec![b, v],
            false => vec![v, a],
        };
        while let [.., last, at] = chain[..]
            && gone[at as usize]
        {
            let [a, b] = self.beside(at);
            chain.push(if a == last { b } else { a });
        }
        chain
    }

    /// Brings back the vertex of a chain that is farthest from the line between its ends, and so in
    /// both parts, while one is too far [DP73].
    fn divide(&self, chain: &[u32], gone: &mut [bool], most: f64) -> f64 {
        let mut farthest = 0.0f64;
        let mut parts = vec![([0, chain.len() - 1], 0)];
        while let Some(([first, last], divisions)) = parts.pop() {
            let ends = [first, last].map(|i| self.place(chain[i]));
            let inner = (first + 1..last).map(|i| (beside(ends, self.place(chain[i])), i));
            let Some((distance, i)) = inner.max_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
            if distance > most {
                let i = if divisions < DIVISIONS { i } else { first.midpoint(last) };
                gone[chain[i] as usize] = false;
                parts.extend([([first, i], divisions + 1), ([i, last], divisions + 1)]);
            } else {
                farthest = farthest.max(distance);
            }
        }
        farthest
    }

    fn place(&self, v: u32) -> DVec3 {
        self.mesh.positions[v as usize].into()
    }
}

/// Returns the distance of a point from a segment.
fn beside([a, b]: [DVec3; 2], point: DVec3) -> f64 {
    let along = b - a;
    let part = (point - a).dot(along) / along.length_squared();
    let part = if part.is_finite() { part.clamp(0.0, 1.0) } else { 0.0 };
    point.distance(a + part * along)
}

/// Returns true if three points are exactly on one line.
fn is_on_line(points: [DVec3; 3]) -> bool {
    [[0, 1], [1, 2], [2, 0]].iter().all(|&[x, y]| {
        let [a, b, c] = points.map(|point| Coord { x: point[x], y: point[y] });
        orient2d(a, b, c) == 0.0
    })
}
