//! Reading a patch face by face, as it grew.

use std::ops::Range;

use super::Rows;
use super::codes::{Code, Context, NodeAddress, PatchRows};
use super::front::{Front, PatchGate};
use crate::bits::{Cursor, width};
use crate::bytes::Malformed;

/// Reader that grows a patch as its bits say.
pub(super) struct PatchReader<'a> {
    rows: &'a Rows,
    book: PatchRows,
    bits: Cursor<'a>,
    front: Front,
    /// Nodes met so far.
    met: Vec<NodeAddress>,
    /// Number of nodes met in each of the patch's own rows.
    taken: Vec<u32>,
}

impl<'a> PatchReader<'a> {
    pub(super) fn new(
        rows: &'a Rows,
        own: Range<u32>,
        mut bits: Cursor<'a>,
    ) -> Result<Self, Malformed> {
        let taken = vec![0; own.len()];
        let book = PatchRows::next(own, rows, &mut bits)?;
        Ok(Self { rows, book, bits, front: Front::default(), met: Vec::new(), taken })
    }

    /// Reads `count` faces.
    pub(super) fn faces(mut self, count: usize) -> Result<Vec<[u32; 3]>, Malformed> {
        let mut faces = Vec::with_capacity(count);
        while faces.len() < count {
            if let Some(gate) = self.front.pass() {
                let Some(third) = self.third(gate)? else {
                    continue;
                };
                self.front.grow(gate, third);
                faces.push([gate.from, gate.to, third]);
            } else {
                let face = [self.corner()?, self.corner()?, self.corner()?];
                self.front.start(face);
                faces.push(face);
            }
        }
        for number in faces.iter_mut().flatten() {
            let NodeAddress { row, number: at } = self.met[*number as usize];
            *number = self.rows.first(row) + at;
        }
        Ok(faces)
    }

    /// Reads the node across a gate; `None` if there is no face.
    fn third(&mut self, gate: PatchGate) -> Result<Option<u32>, Malformed> {
        let rows = [gate.from, gate.to].map(|number| self.met[number as usize].row);
        let context = self.book.context(Some(rows));
        let neighbour = match context.next_code(&mut self.bits)? {
            Code::Nothing => return Ok(None),
            Code::Next => self.front.next(gate),
            Code::Previous => self.front.previous(gate),
            code => Some(self.node(code, context)?),
        };
        let neighbour =
            neighbour.ok_or_else(|| self.bits.wrong("the border does not continue at a gate"))?;
        Ok(Some(neighbour))
    }

    /// Reads a corner of a face that starts anew.
    fn corner(&mut self) -> Result<u32, Malformed> {
        let context = self.book.context(None);
        let code = context.next_code(&mut self.bits)?;
        self.node(code, context)
    }

    fn node(&mut self, code: Code, context: Context) -> Result<u32, Malformed> {
        let node = match code {
            Code::Own => self.own(context)?,
            Code::Foreign => self.foreign()?,
            Code::Known => return self.known(),
            Code::Next | Code::Previous | Code::Nothing => unreachable!("a node is asked for"),
        };
        self.met.push(node);
        Ok(self.front.meet())
    }

    fn own(&mut self, context: Context) -> Result<NodeAddress, Malformed> {
        let row = self.book.next_own(context, &mut self.bits)?;
        let taken = &mut self.taken[(row - self.book.own.start) as usize];
        if *taken == self.rows.size(row) {
            return Err(self.bits.wrong(format!("row {row} has no more nodes")));
        }
        *taken += 1;
        Ok(NodeAddress { row, number: *taken - 1 })
    }

    fn foreign(&mut self) -> Result<NodeAddress, Malformed> {
        let at = self.bits.next(width(self.book.foreign.len()))? as usize;
        let row = self.book.foreign.get(at).copied();
        let row =
            row.ok_or_else(|| self.bits.wrong(format!("the patch has no foreign row {at}")))?;
        let number = self.bits.next(width(self.rows.size(row) as usize))? as u32;
        if number >= self.rows.size(row) {
            return Err(self.bits.wrong(format!("row {row} has no node {number}")));
        }
        Ok(NodeAddress { row, number })
    }

    fn known(&mut self) -> Result<u32, Malformed> {
        let number = self.bits.next(width(self.met.len()))? as u32;
        if number as usize >= self.met.len() {
            return Err(self.bits.wrong(format!("the patch has met no node {number} yet")));
        }
        Ok(number)
    }
}
