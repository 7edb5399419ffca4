//! Faces in patches that can be decoded independently, coded by how they grow from one another.
//!
//! *Nodes* are what faces have at their corners; they lie in rows. Several consecutive rows belong
//! to a patch, and a face belongs to the first patch that has one of its corners, so of two patches
//! only one refers to nodes of the other. A patch grows over its open edges as a cut-border machine
//! does [GS98]: across each there is nothing, or a face whose third corner is new, adjacent on the
//! border, or any other. New nodes come in the order of their rows, so most faces need no index at
//! all.

mod codes;
mod front;
mod grow;
mod read;
#[cfg(test)]
mod tests;

use std::ops::Range;

use self::codes::{NodeAddress, PatchRows};
use self::grow::{GrowthStep, PatchGrower};
use self::read::PatchReader;
use crate::bits::{Bits, Cursor, width};
use crate::bytes::{Malformed, Reader};

/// Number of nodes in each row, as prefix sums.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Rows {
    starts: Vec<u32>,
}

/// Faces of a mesh in patches.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Patches {
    rows: Rows,
    rows_per_patch: usize,
    heads: Vec<Head>,
    bits: Bits,
}

/// First byte of a patch's bits, and its number of faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Head {
    start: u32,
    faces: u32,
}

/// Size of the header in a file, the length of all bits, and of a patch's [`Head`].
const HEADER: usize = 4;
const PATCH: usize = 8;

impl Rows {
    /// Creates rows with the given numbers of nodes.
    ///
    /// # Panics
    /// If there are more nodes than a `u32` can number.
    pub(crate) fn new(sizes: impl IntoIterator<Item = usize>) -> Self {
        let mut starts = vec![0];
        let mut end = 0;
        starts.extend(sizes.into_iter().map(|size| {
            end = u32::try_from(end as usize + size).expect("nodes are numbered by 32 bits");
            end
        }));
        Self { starts }
    }

    pub(crate) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Returns the number of nodes in all rows.
    pub(crate) fn nodes(&self) -> usize {
        self.starts[self.len()] as usize
    }

    /// Returns the stored size in bytes: a width, and that many bits for each row.
    pub(crate) fn bytes(&self) -> usize {
        1 + (self.len() * self.width() as usize).div_ceil(8)
    }

    pub(crate) fn store(&self, out: &mut Vec<u8>) {
        let mut bits = Bits::default();
        (0..self.len()).for_each(|row| bits.push(self.range(row).len() as u64, self.width()));
        out.push(self.width() as u8);
        bits.store(out);
    }

    pub(crate) fn restore(count: usize, reader: &mut Reader) -> Result<Self, Malformed> {
        let width = u32::from(reader.u8()?);
        if width > u32::BITS {
            return Err(reader.wrong("a row has more nodes than 32 bits can number"));
        }
        let bits = Bits::restore(count.saturating_mul(width as usize), reader)?;
        let sizes = (0..count).map(|row| bits.get(row * width as usize, width));
        if sizes.clone().sum::<u64>() > u32::MAX.into() {
            return Err(reader.wrong("the rows have more nodes than 32 bits can number"));
        }
        Ok(Self::new(sizes.map(|size| size as usize)))
    }

    fn width(&self) -> u32 {
        let most = (0..self.len()).map(|row| self.range(row).len()).max();
        width(most.unwrap_or(0) + 1)
    }

    /// Returns the nodes of a row.
    pub(crate) fn range(&self, row: usize) -> Range<usize> {
        self.starts[row] as usize..self.starts[row + 1] as usize
    }

    /// Returns the row of a node, and its number there.
    pub(crate) fn place(&self, node: u32) -> (usize, usize) {
        let row = self.starts.partition_point(|&start| start <= node) - 1;
        (row, (node - self.starts[row]) as usize)
    }

    fn first(&self, row: u32) -> u32 {
        self.starts[row as usize]
    }

    fn size(&self, row: u32) -> u32 {
        self.starts[row as usize + 1] - self.starts[row as usize]
    }
}

impl Patches {
    /// Encodes faces in patches, and returns the nodes in row order, and the faces patch by patch.
    /// Within a row nodes are in the order in which its patch meets them.
    ///
    /// `row_of` is the row of each node. A patch has `rows_per_patch` rows.
    pub(crate) fn new(
        faces: &[[u32; 3]],
        row_of: &[u32],
        rows: usize,
        rows_per_patch: usize,
    ) -> (Self, Vec<u32>, Vec<u32>) {
        let members = members(faces, row_of, rows_per_patch, rows.div_ceil(rows_per_patch));
        let mut grower = PatchGrower::new(row_of.len());
        let (mut grown, mut made) = (Vec::new(), Vec::with_capacity(faces.len()));
        for members in &members {
            let own: Vec<_> = members.iter().map(|&face| faces[face as usize]).collect();
            let (steps, order) = grower.grow(&own);
            grown.push(steps);
            made.extend(order.iter().map(|&at| members[at as usize]));
        }
        let order = in_rows(&grown, row_of, rows, rows_per_patch);
        let rows = Rows::new(order.iter().map(Vec::len));
        let mut numbers = vec![0; row_of.len()];
        order.iter().for_each(|row| {
            row.iter().zip(0..).for_each(|(&node, number)| numbers[node as usize] = number);
        });
        let place =
            |node: u32| NodeAddress { row: row_of[node as usize], number: numbers[node as usize] };
        let mut this = Self { rows, rows_per_patch, heads: Vec::new(), bits: Bits::default() };
        for (steps, faces) in grown.iter().zip(&members) {
            this.push(steps, faces.len(), place);
        }
        this.bits.fill_byte();
        (this, order.concat(), made)
    }

    pub(crate) fn rows(&self) -> &Rows {
        &self.rows
    }

    /// Returns the number of patches.
    pub(crate) fn len(&self) -> usize {
        self.heads.len()
    }

    pub(crate) fn face_count(&self) -> usize {
        self.face_counts().sum()
    }

    /// Returns the number of faces of each patch.
    pub(crate) fn face_counts(&self) -> impl Iterator<Item = usize> {
        self.heads.iter().map(|head| head.faces as usize)
    }

    /// Decodes the faces of one patch, as nodes in row order.
    pub(crate) fn faces(&self, patch: usize) -> Result<Vec<[u32; 3]>, Malformed> {
        let head = self.heads[patch];
        let bits = Cursor::new(&self.bits, 8 * head.start as usize);
        PatchReader::new(&self.rows, self.own(patch), bits)?.faces(head.faces as usize)
    }

    /// Returns the size in bytes, with everything needed to decode them.
    pub(crate) fn bytes(&self) -> usize {
        HEADER + PATCH * self.heads.len() + self.bits.len() / 8
    }

    pub(crate) fn store(&self, out: &mut Vec<u8>) {
        out.extend(((self.bits.len() / 8) as u32).to_le_bytes());
        for head in &self.heads {
            out.extend(head.start.to_le_bytes());
            out.extend(head.faces.to_le_bytes());
        }
        self.bits.store(out);
    }

    /// Reads patches of `rows_per_patch` rows each. Their bits are only checked when they are
    /// decoded.
    pub(crate) fn restore(
        rows: Rows,
        rows_per_patch: usize,
        reader: &mut Reader,
    ) -> Result<Self, Malformed> {
        let len = reader.u32()?;
        let mut heads: Vec<Head> = Vec::new();
        for _ in 0..rows.len().div_ceil(rows_per_patch) {
            heads.push(Head { start: reader.u32()?, faces: reader.u32()? });
        }
        for (at, head) in heads.iter().enumerate() {
            // A face takes at least a bit, and patches do not share bits.
            let end = u64::from(heads.get(at + 1).map_or(len, |next| next.start));
            let room = 8 * end.saturating_sub(head.start.into());
            if end > len.into() || u64::from(head.faces) > room {
                return Err(reader.wrong(format!("patch {at} has too few bits for its faces")));
            }
        }
        let bits = Bits::restore(8 * len as usize, reader)?;
        Ok(Self { rows, rows_per_patch, heads, bits })
    }

    fn push(&mut self, steps: &[GrowthStep], faces: usize, place: impl Fn(u32) -> NodeAddress) {
        let own = self.own(self.heads.len());
        self.bits.fill_byte();
        self.heads.push(Head { start: (self.bits.len() / 8) as u32, faces: faces as u32 });
        PatchRows::of(steps, own, &place).push(steps, place, &self.rows, &mut self.bits);
    }

    fn own(&self, patch: usize) -> Range<u32> {
        let first = patch * self.rows_per_patch;
        first as u32..(first + self.rows_per_patch).min(self.rows.len()) as u32
    }
}

/// Assigns each face to the first patch that has one of its corners. By the majority of corners,
/// patches have twice as many foreign nodes, and faces take 1.3 bits more.
fn members(
    faces: &[[u32; 3]],
    row_of: &[u32],
    rows_per_patch: usize,
    patches: usize,
) -> Vec<Vec<u32>> {
    let mut members = vec![Vec::new(); patches];
    for (at, face) in (0..).zip(faces) {
        let of = face.map(|node: u32| row_of[node as usize] as usize / rows_per_patch);
        members[of[0].min(of[1]).min(of[2])].push(at);
    }
    members
}

/// Orders the nodes of each row: first as its patch meets them, then those that only other patches
/// have.
fn in_rows(
    grown: &[Vec<GrowthStep>],
    row_of: &[u32],
    rows: usize,
    rows_per_patch: usize,
) -> Vec<Vec<u32>> {
    let mut order = vec![Vec::new(); rows];
    let mut is_in = vec![false; row_of.len()];
    let mut put = |node: u32| {
        order[row_of[node as usize] as usize].push(node);
        is_in[node as usize] = true;
    };
    for (patch, steps) in grown.iter().enumerate() {
        let is_own = |node: u32| row_of[node as usize] as usize / rows_per_patch == patch;
        steps
            .iter()
            .filter_map(GrowthStep::new_node)
            .filter(|&node| is_own(node))
            .for_each(&mut put);
    }
    for (node, _) in (0..).zip(is_in.clone()).filter(|(_, is_in)| !is_in) {
        order[row_of[node as usize] as usize].push(node);
    }
    order
}
