//! Strips for the vertex cache: pieces of paths, each sent while what it shares with others is still there.

mod fifo;

use meshlod_mesh::{Buckets, VertexId};

use self::fifo::Fifo;
use crate::cover::{Cover, Port};
use crate::dual::{ends, previous};
use crate::emit::Turn;
use crate::strips::Strips;
use crate::verify::has_three_corners;

/// The vertex cache that strips are sent to, and how much of them is given up for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CacheAware {
    /// How many vertices the cache holds; the one that came first goes first.
    pub entries: usize,
    /// The most faces of a strip. Shorter strips find more in the cache, and take more indices: with 16 entries the
    /// bunny takes 1.34 indices a face and transforms .73 vertices with 14, 1.29 and .76 with 20, 1.23 and .87 with
    /// 40.
    pub longest: usize,
}

impl Default for CacheAware {
    fn default() -> Self {
        Self { entries: 16, longest: 20 }
    }
}

/// What an index costs, where a vertex that comes into the cache costs 1. The bunny, 20 faces a strip: 1.330 indices
/// and .732 misses a face with .7, 1.288 and .755 with this, 1.264 and .809 with 2.5.
const INDEX: f64 = 1.2;

/// What the first two vertices of a strip and a restart cost.
const STRIP: f64 = 3.0 * INDEX;

/// What it costs to leave a part of a path behind, in strips. The bunny, 16 faces a strip: 1.320 indices and .731
/// misses with .5, 1.316 and .739 with this, 1.313 and .758 with 1.2.
const LEFT_BEHIND: f64 = 0.8;

/// Fewer faces than that are not left at the end of a path, as far as possible. The bunny, 20 faces a strip: 1.308
/// indices and .770 misses where they may be, 1.288 and .755 with this.
const SHORT: usize = 6;

/// How many vertices that came into the cache are looked at, where those still in it have no faces left.
const CAME_BEFORE: usize = 256;

/// How many faces of a vertex are looked at: fans of thousands should not be looked through again and again.
const MOST_OF_STAR: usize = 64;

impl Cover {
    /// The strips of pieces of the paths, in an order that suits the cache; `faces` are those the cover is of.
    ///
    /// Again and again the piece is sent that costs least a face, of all that start at a vertex in the cache.
    /// Cost: O(faces · (entries · longest + log faces)).
    pub(crate) fn strips_for_cache(
        &mut self,
        faces: &[[VertexId; 3]],
        cache: &CacheAware,
    ) -> Strips {
        let (names, faces) = renumbered(faces);
        let mut sender = Sender::new(self, &faces, names.len(), cache);
        let mut strips = Strips::default();
        let mut strip = Vec::new();
        for first in (0..faces.len()).filter(|&face| has_three_corners(&faces[face])) {
            while !sender.sent[first] {
                let piece = sender.best_piece(first);
                sender.send(&piece, &mut strip);
                strips.push(strip.drain(..).map(|vertex| names[vertex.index()]));
            }
        }
        strips
    }
}

/// The vertices that are used, in order, and the faces with their places in that for vertices: ids can be any numbers.
fn renumbered(faces: &[[VertexId; 3]]) -> (Vec<VertexId>, Vec<[VertexId; 3]>) {
    let mut names: Vec<VertexId> = faces.iter().flatten().copied().collect();
    names.sort_unstable();
    names.dedup();
    let place = |vertex| VertexId::new(names.partition_point(|&name| name < vertex));
    let faces = faces.iter().map(|face| face.map(place)).collect();
    (names, faces)
}

/// The cells of a path from `cell` on, which it leaves by `side`.
#[derive(Clone, Copy, Debug)]
struct Piece {
    cell: usize,
    /// Nowhere, where the cell is linked to none.
    side: Option<usize>,
    cells: usize,
    /// By cell.
    cost: f64,
}

/// What has been sent, and what has not.
struct Sender<'a> {
    /// The paths of cells that have been sent, and of the others.
    cover: &'a mut Cover,
    faces: &'a [[VertexId; 3]],
    cache: &'a CacheAware,
    sent: Vec<bool>,
    fifo: Fifo,
    /// The corners at each vertex, as 3 · face + corner.
    stars: Buckets,
    /// How many at the beginning of each vertex's belong to faces that have been sent.
    done: Vec<u32>,
    /// Room for cells.
    starts: Vec<u32>,
}

impl<'a> Sender<'a> {
    fn new(
        cover: &'a mut Cover,
        faces: &'a [[VertexId; 3]],
        vertex_count: usize,
        cache: &'a CacheAware,
    ) -> Self {
        let corners = faces.as_flattened().iter().map(|vertex| vertex.index());
        Self {
            cover,
            faces,
            cache,
            // Faces that repeat a vertex are as good as sent.
            sent: faces.iter().map(|face| !has_three_corners(face)).collect(),
            fifo: Fifo::new(cache.entries, vertex_count),
            stars: Buckets::new(vertex_count, corners),
            done: vec![0; vertex_count],
            starts: Vec::new(),
        }
    }

    /// The best piece that starts at a vertex in the cache; else at one that was there, or at the cell `other`.
    fn best_piece(&mut self, other: usize) -> Piece {
        self.find_starts(self.cache.entries);
        if self.starts.is_empty() {
            self.find_starts(CAME_BEFORE);
        }
        if self.starts.is_empty() {
            self.starts.push(other as u32);
        }
        let mut best = Piece { cell: other, side: None, cells: 0, cost: f64::MAX };
        for at in 0..self.starts.len() {
            let cell = self.starts[at] as usize;
            let links = self.cover.cells[cell].links;
            let alone = links.first().is_none().then_some(None);
            for side in (0..3).filter(|&side| links.has(side)).map(Some).chain(alone) {
                let piece = self.try_piece(cell, side);
                if piece.cost < best.cost {
                    best = piece;
                }
            }
        }
        best
    }

    /// Puts the cells to `starts` that have not been sent and have one of the last `count` vertices that came in.
    fn find_starts(&mut self, count: usize) {
        self.starts.clear();
        for vertex in self.fifo.latest(count) {
            let star = self.stars.of(vertex.index());
            let done = &mut self.done[vertex.index()];
            let is_sent = |corner: u32| self.sent[corner as usize / 3];
            while (*done as usize) < star.len() && is_sent(star[*done as usize]) {
                *done += 1;
            }
            let open = star[*done as usize..].iter().take(MOST_OF_STAR);
            self.starts.extend(open.filter(|&&corner| !is_sent(corner)).map(|corner| corner / 3));
        }
        self.starts.sort_unstable();
        self.starts.dedup();
    }

    /// The best of the pieces that start so, of all lengths.
    fn try_piece(&mut self, cell: usize, side: Option<usize>) -> Piece {
        let before = self.fifo.misses();
        let ahead = self.ahead(cell, side);
        let splits = self.cover.cells[cell].links.count() == 2;
        let fixed = STRIP * if splits { 1.0 + LEFT_BEHIND } else { 1.0 };
        let mut best = Piece { cell, side, cells: 0, cost: f64::MAX };
        let mut consider = |cells: usize, again: usize, misses: usize| {
            let short = if (1..SHORT).contains(&(ahead - cells)) { STRIP } else { 0.0 };
            let cost = (misses - before) as f64 + fixed + short + INDEX * again as f64;
            if cost < best.cost * cells as f64 {
                (best.cells, best.cost) = (cells, cost / cells as f64);
            }
        };
        self.faces[cell].iter().for_each(|&vertex| self.fifo.send(vertex));
        consider(1, 0, self.fifo.misses());
        let mut next = side.map(|side| self.cover.cells[cell].across[side]);
        // Vertices said once more, which are known when the path goes on, and the last that was turned about.
        let (mut again, mut older) = (0, None);
        for cells in 2..=self.cache.longest {
            let Some(entry) = next else { break };
            let face = &self.faces[entry.cell()];
            self.fifo.send(face[previous(entry.side())]);
            consider(cells, again, self.fifo.misses());
            let Some(turn) = self.cover.turn(entry) else { break };
            let pivot = ends(face, entry.side())[usize::from(turn == Turn::Next)];
            again += usize::from(older.map_or(turn == Turn::Next, |older| older == pivot));
            older = Some(pivot);
            next = Some(self.cover.cells[entry.cell()].across[turn.side(entry)]);
        }
        self.fifo.go_back(before);
        best
    }

    /// How many cells the path has from a cell on; where that is more than can be of interest, some number like it.
    fn ahead(&self, cell: usize, side: Option<usize>) -> usize {
        let enough = self.cache.longest.saturating_add(SHORT);
        let mut next = side.map(|side| self.cover.cells[cell].across[side]);
        let mut count = 1;
        while let Some(entry) = next.filter(|_| count < enough) {
            count += 1;
            let turn = self.cover.turn(entry);
            next = turn.map(|turn| self.cover.cells[entry.cell()].across[turn.side(entry)]);
        }
        count
    }

    /// Cuts a piece out of its path, and sends it: its vertices go behind those of `strip`.
    fn send(&mut self, piece: &Piece, strip: &mut Vec<VertexId>) {
        let links = self.cover.cells[piece.cell].links;
        for side in (0..3).filter(|&side| links.has(side) && Some(side) != piece.side) {
            self.cover.unlink(Port::new(piece.cell, side));
        }
        let (mut cell, mut side) = (piece.cell, piece.side);
        self.sent[cell] = true;
        for _ in 1..piece.cells {
            let Some(leaving) = side else { break };
            let entry = self.cover.cells[cell].across[leaving];
            (cell, side) = (entry.cell(), self.cover.turn(entry).map(|turn| turn.side(entry)));
            self.sent[cell] = true;
        }
        if let Some(leaving) = side {
            self.cover.unlink(Port::new(cell, leaving));
        }
        self.cover.draw(self.faces, piece.cell, strip);
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
        let mut cover = Cover::new(&faces);
        let whole = cover.lay(&faces);
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
        let mut cover = Cover::new(&faces);
        cover.lay(&faces);
        let strips = cover.strips_for_cache(&faces, &CacheAware::default());
        assert_eq!(difference(&strips, &faces), Difference::default());
    }
}
