//! Strips found in one pass, laid side by side, each as far as it goes.

use meshlod_mesh::VertexId;

use crate::cover::{Cover, Port};
use crate::emit::Turn;
use crate::strips::Strips;
use crate::verify::has_three_corners;

/// How many cells are looked at in either direction before a strip is begun. The bunny: 1 leaves 1.180 vertices a
/// face, 4 1.177, 8 1.174, 16 1.172, 40 1.173; a strip looks six times, so 8 cost some nanoseconds a face.
const LOOK: usize = 8;

impl Cover {
    /// Links the cells, none of which may be linked yet, and draws the strips as they come.
    ///
    /// A strip begins in the direction that it can be followed in longest without a swap, goes on both ways until
    /// nothing is free beside it, and swaps only where it would end. The next begins beside the last. Cost: O(cells).
    pub(crate) fn lay(&mut self, faces: &[[VertexId; 3]]) -> Strips {
        let mut layer = Layer { taken: vec![false; faces.len()], near: Vec::new(), cover: self };
        let mut strips = Strips::default();
        let mut strip = Vec::new();
        for first in (0..faces.len()).filter(|&face| has_three_corners(&faces[face])) {
            let mut start = Some(first);
            while let Some(cell) = start {
                if !layer.taken[cell] {
                    let ends = layer.lay_strip(cell);
                    let end = layer.cover.better_end(ends[0], ends[1]);
                    layer.cover.draw(faces, end, &mut strip);
                    strips.push(strip.drain(..));
                }
                start = layer.near.pop().map(|cell| cell as usize);
            }
        }
        strips
    }
}

/// A cover on which strips are laid.
struct Layer<'a> {
    cover: &'a mut Cover,
    /// Which cells are in strips.
    taken: Vec<bool>,
    /// Cells beside strips, the latest last.
    near: Vec<u32>,
}

impl Layer<'_> {
    /// Lays a strip through a free cell; its ends.
    fn lay_strip(&mut self, start: usize) -> [usize; 2] {
        self.taken[start] = true;
        let Some((side, turn)) = self.best_direction(start) else { return [start; 2] };
        let end = self.extend(Port::new(start, side), turn);
        // Back from the start: where no swap is needed first.
        let straight = turn.side(Port::new(start, side));
        let bent = 3 - side - straight;
        if self.is_free(self.cover.across(Port::new(start, straight))) {
            self.remember(Port::new(start, bent));
            [end, self.extend(Port::new(start, straight), turn.other())]
        } else if self.is_free(self.cover.across(Port::new(start, bent))) {
            [end, self.extend(Port::new(start, bent), turn)]
        } else {
            [end, start]
        }
    }

    /// The side to leave a cell by, and the turn in the next, from which the strip is longest both ways.
    fn best_direction(&self, start: usize) -> Option<(usize, Turn)> {
        let mut best = None;
        let mut most = 0;
        for side in 0..3 {
            let here = Port::new(start, side);
            let entry = self.cover.across(here);
            if !self.is_free(entry) {
                continue;
            }
            for turn in [Turn::Next, Turn::Previous] {
                let back = self.cover.across(Port::new(start, turn.side(here)));
                let length = self.straight(entry, turn) + self.straight(back, turn.other());
                if length > most {
                    (most, best) = (length, Some((side, turn)));
                }
            }
        }
        best
    }

    /// How many free cells follow without a swap, up to [`LOOK`].
    fn straight(&self, mut entry: Port, mut turn: Turn) -> usize {
        for length in 0..LOOK {
            if !self.is_free(entry) {
                return length;
            }
            entry = self.cover.across(Port::new(entry.cell(), turn.side(entry)));
            turn = turn.other();
        }
        LOOK
    }

    /// Goes on through `port`, beyond which it is free, and makes `turn` there and every other turn after, as long as
    /// it can. The last cell.
    fn extend(&mut self, mut port: Port, mut turn: Turn) -> usize {
        loop {
            let entry = self.cover.across(port);
            self.taken[entry.cell()] = true;
            for port in [port, entry] {
                let links = &mut self.cover.cells[port.cell()].links;
                *links = links.with(port.side());
            }
            let ahead = |turn: Turn| Port::new(entry.cell(), turn.side(entry));
            if !self.is_free(self.cover.across(ahead(turn))) {
                turn = turn.other();
                if !self.is_free(self.cover.across(ahead(turn))) {
                    return entry.cell();
                }
            }
            port = ahead(turn);
            turn = turn.other();
            self.remember(ahead(turn));
        }
    }

    #[inline]
    fn is_free(&self, port: Port) -> bool {
        !port.is_none() && !self.taken[port.cell()]
    }

    /// Lets a strip begin beyond `port`, if it is still free then.
    #[inline]
    fn remember(&mut self, port: Port) {
        let beside = self.cover.across(port);
        if self.is_free(beside) {
            self.near.push(beside.cell() as u32);
        }
    }
}
