//! Triangle strips for a vertex cache: paths cut into runs, each sent while the vertices it shares
//! are still cached.

mod fifo;

use meshlod_mesh::{Buckets, VertexId};

use self::fifo::FifoCache;
use crate::dual::{ends, previous};
use crate::dual_node::DualEdge;
use crate::emit::Turn;
use crate::path_cover::PathCover;
use crate::strips::Strips;
use crate::verify::has_three_corners;

/// Vertex cache that strips are built for, and the trade between cache misses and strip length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct CacheAware {
    /// Number of vertices that the cache holds; it is first in, first out.
    pub entries: usize,
    /// Largest number of faces per strip; shorter strips hit the cache more often but take more
    /// indices.
    ///
    /// The bunny with 16 entries: 1.34 indices and .73 misses per face with 14, 1.29 and .76 with
    /// 20, 1.23 and .87 with 40.
    pub longest: usize,
}

impl Default for CacheAware {
    fn default() -> Self {
        Self { entries: 16, longest: 20 }
    }
}

/// Cost of an index relative to a cache miss. The bunny, 20 faces per strip: 1.330 indices and .732
/// misses per face with .7, 1.288 and .755 with 1.2, 1.264 and .809 with 2.5.
const INDEX_COST: f64 = 1.2;

/// Cost of the first two vertices of a strip and a restart.
const STRIP_COST: f64 = 3.0 * INDEX_COST;

/// Cost of splitting a path, in strips. The bunny, 16 faces per strip: 1.320 indices and .731
/// misses with .5, 1.316 and .739 with .8, 1.313 and .758 with 1.2.
const SPLIT_FACTOR: f64 = 0.8;

/// Shorter remainders of a path are avoided at the cost of a strip. The bunny, 20 faces per strip:
/// 1.308 indices and .770 misses without this rule, 1.288 and .755 with it.
const MIN_REMAINDER: usize = 6;

/// Number of recent cache entries searched for a start when the cached vertices have no faces left.
const RECENT: usize = 256;

/// Number of faces searched at a vertex, so that fans of thousands are not scanned again and again.
const MAX_STAR: usize = 64;

impl PathCover {
    /// Cuts the paths into runs and orders them for the cache; `faces` are the faces of the cover.
    ///
    /// Repeatedly sends the run with the least cost per face among those that start at a cached
    /// vertex. Cost: O(faces · (entries · longest + log faces)).
    pub(crate) fn strips_for_cache(
        &mut self,
        faces: &[[VertexId; 3]],
        cache: &CacheAware,
    ) -> Strips {
        let (names, faces) = renumbered(faces);
        let mut scheduler = RunScheduler::new(self, &faces, names.len(), cache);
        let mut strips = Strips::default();
        let mut strip = Vec::new();
        for first in (0..faces.len()).filter(|&face| has_three_corners(&faces[face])) {
            while !scheduler.sent[first] {
                let run = scheduler.best_run(first);
                scheduler.send(&run, &mut strip);
                strips.push(strip.drain(..).map(|vertex| names[vertex.index()]));
            }
        }
        strips
    }
}

/// Renumbers the used vertices consecutively, because ids can be arbitrary. Returns the original
/// ids and the renumbered faces.
fn renumbered(faces: &[[VertexId; 3]]) -> (Vec<VertexId>, Vec<[VertexId; 3]>) {
    let mut names: Vec<VertexId> = faces.iter().flatten().copied().collect();
    names.sort_unstable();
    names.dedup();
    let place = |vertex| VertexId::new(names.partition_point(|&name| name < vertex));
    let faces = faces.iter().map(|face| face.map(place)).collect();
    (names, faces)
}

/// A run of a path: it starts at `node` and leaves it by `side`.
#[derive(Clone, Copy, Debug)]
struct CacheRun {
    node: usize,
    /// `None` if the node has no link.
    side: Option<usize>,
    nodes: usize,
    /// Cost per node.
    cost: f64,
}

/// The run scheduler: which nodes have been sent, and the state of the cache.
struct RunScheduler<'a> {
    /// Paths of the nodes, cut at the ends of the runs that have been sent.
    cover: &'a mut PathCover,
    faces: &'a [[VertexId; 3]],
    cache: &'a CacheAware,
    sent: Vec<bool>,
    fifo: FifoCache,
    /// Corners at each vertex, as 3 · face + corner.
    stars: Buckets,
    /// Number of leading corners of each vertex whose faces have been sent.
    done: Vec<u32>,
    /// Scratch buffer of candidate nodes.
    starts: Vec<u32>,
}

impl<'a> RunScheduler<'a> {
    fn new(
        cover: &'a mut PathCover,
        faces: &'a [[VertexId; 3]],
        vertex_count: usize,
        cache: &'a CacheAware,
    ) -> Self {
        let corners = faces.as_flattened().iter().map(|vertex| vertex.index());
        Self {
            cover,
            faces,
            cache,
            // Faces that repeat a vertex count as sent.
            sent: faces.iter().map(|face| !has_three_corners(face)).collect(),
            fifo: FifoCache::new(cache.entries, vertex_count),
            stars: Buckets::new(vertex_count, corners),
            done: vec![0; vertex_count],
            starts: Vec::new(),
        }
    }

    /// Finds the best run that starts at a cached vertex, else at a recently cached one, else at
    /// `other`.
    fn best_run(&mut self, other: usize) -> CacheRun {
        self.find_starts(self.cache.entries);
        if self.starts.is_empty() {
            self.find_starts(RECENT);
        }
        if self.starts.is_empty() {
            self.starts.push(other as u32);
        }
        let mut best = CacheRun { node: other, side: None, nodes: 0, cost: f64::MAX };
        for at in 0..self.starts.len() {
            let node = self.starts[at] as usize;
            let links = self.cover.nodes[node].links;
            let alone = links.first().is_none().then_some(None);
            for side in (0..3).filter(|&side| links.has(side)).map(Some).chain(alone) {
                let run = self.try_run(node, side);
                if run.cost < best.cost {
                    best = run;
                }
            }
        }
        best
    }

    /// Collects into `starts` the unsent nodes at the latest `count` vertices that entered the
    /// cache.
    fn find_starts(&mut self, count: usize) {
        self.starts.clear();
        for vertex in self.fifo.latest(count) {
            let star = self.stars.of(vertex.index());
            let done = &mut self.done[vertex.index()];
            let is_sent = |corner: u32| self.sent[corner as usize / 3];
            while (*done as usize) < star.len() && is_sent(star[*done as usize]) {
                *done += 1;
            }
            let open = star[*done as usize..].iter().take(MAX_STAR);
            self.starts.extend(open.filter(|&&corner| !is_sent(corner)).map(|corner| corner / 3));
        }
        self.starts.sort_unstable();
        self.starts.dedup();
    }

    /// Finds the best length for a run that starts at `node` and leaves it by `side`.
    fn try_run(&mut self, node: usize, side: Option<usize>) -> CacheRun {
        let before = self.fifo.misses();
        let ahead = self.ahead(node, side);
        let splits = self.cover.nodes[node].links.count() == 2;
        let fixed = STRIP_COST * if splits { 1.0 + SPLIT_FACTOR } else { 1.0 };
        let mut best = CacheRun { node, side, nodes: 0, cost: f64::MAX };
        let mut consider = |nodes: usize, again: usize, misses: usize| {
            let short =
                if (1..MIN_REMAINDER).contains(&(ahead - nodes)) { STRIP_COST } else { 0.0 };
            let cost = (misses - before) as f64 + fixed + short + INDEX_COST * again as f64;
            if cost < best.cost * nodes as f64 {
                (best.nodes, best.cost) = (nodes, cost / nodes as f64);
            }
        };
        self.faces[node].iter().for_each(|&vertex| self.fifo.send(vertex));
        consider(1, 0, self.fifo.misses());
        let mut next = side.map(|side| self.cover.nodes[node].across[side]);
        // Repeated vertices, known once the path goes on, and the vertex of the last turn.
        let (mut again, mut older) = (0, None);
        for nodes in 2..=self.cache.longest {
            let Some(entry) = next else { break };
            let face = &self.faces[entry.node()];
            self.fifo.send(face[previous(entry.side())]);
            consider(nodes, again, self.fifo.misses());
            let Some(turn) = self.cover.turn(entry) else { break };
            let pivot = ends(face, entry.side())[usize::from(turn == Turn::Next)];
            again += usize::from(older.map_or(turn == Turn::Next, |older| older == pivot));
            older = Some(pivot);
            next = Some(self.cover.nodes[entry.node()].across[turn.side(entry)]);
        }
        self.fifo.go_back(before);
        best
    }

    /// Counts the nodes ahead on a path; stops at a number that is large enough for the cost.
    fn ahead(&self, node: usize, side: Option<usize>) -> usize {
        let enough = self.cache.longest.saturating_add(MIN_REMAINDER);
        let mut next = side.map(|side| self.cover.nodes[node].across[side]);
        let mut count = 1;
        while let Some(entry) = next.filter(|_| count < enough) {
            count += 1;
            let turn = self.cover.turn(entry);
            next = turn.map(|turn| self.cover.nodes[entry.node()].across[turn.side(entry)]);
        }
        count
    }

    /// Cuts a run out of its path and appends its vertices to `strip`.
    fn send(&mut self, run: &CacheRun, strip: &mut Vec<VertexId>) {
        let links = self.cover.nodes[run.node].links;
        for side in (0..3).filter(|&side| links.has(side) && Some(side) != run.side) {
            self.cover.unlink(DualEdge::new(run.node, side));
        }
        let (mut node, mut side) = (run.node, run.side);
        self.sent[node] = true;
        for _ in 1..run.nodes {
            let Some(leaving) = side else { break };
            let entry = self.cover.nodes[node].across[leaving];
            (node, side) = (entry.node(), self.cover.turn(entry).map(|turn| turn.side(entry)));
            self.sent[node] = true;
        }
        if let Some(leaving) = side {
            self.cover.unlink(DualEdge::new(node, leaving));
        }
        self.cover.draw(self.faces, run.node, strip);
        strip.iter().for_each(|&vertex| self.fifo.send(vertex));
    }
}

#[cfg(test)]
mod tests {
    use meshlod_samples as samples;

    use super::*;
    use crate::measure::acmr;
    use crate::verify::{Difference, difference};

    #[test]
    fn pieces_draw_the_faces_and_miss_less_than_whole_strips() {
        let faces = samples::torus(4000).faces;
        let mut cover = PathCover::new(&faces);
        let whole = cover.cover_greedily(&faces);
        let mut before = acmr(&whole, 16);
        for longest in [40, 20] {
            let cache = CacheAware { entries: 16, longest };
            let strips = cover.clone().strips_for_cache(&faces, &cache);
            assert_eq!(difference(&strips, &faces), Difference::default());
            assert!(acmr(&strips, 16) < before, "{longest}: {} {before}", acmr(&strips, 16));
            before = acmr(&strips, 16);
        }
    }

    #[test]
    fn a_wide_fan_of_strange_vertices_takes_no_time() {
        let blades = 50_000;
        let faces: Vec<_> =
            (0..blades).map(|i| [u32::MAX, 7 * i, 7 * (i + 1)].map(VertexId)).collect();
        let mut cover = PathCover::new(&faces);
        cover.cover_greedily(&faces);
        let strips = cover.strips_for_cache(&faces, &CacheAware::default());
        assert_eq!(difference(&strips, &faces), Difference::default());
    }
}
