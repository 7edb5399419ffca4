//! Which nodes of parts are one vertex: a file of parts has it once for each part.

use meshlod_mesh::VertexId;

use crate::bytes::{Malformed, Reader};

/// What the rule gets wrong: a node, and the first that is the same vertex.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Exceptions(Vec<[u32; 2]>);

impl Exceptions {
    /// What must be said beside cells, for each node to be the vertex that it is.
    pub(super) fn new(faces: &[[u32; 3]], cells: &[[i32; 3]], vertex_of: &[VertexId]) -> Self {
        let mut first = vec![None; vertex_of.iter().max().map_or(0, |v| v.index() + 1)];
        let is = (0..).zip(vertex_of).map(|(node, v)| *first[v.index()].get_or_insert(node));
        let told = by_cells(faces, cells).into_iter().zip(is).zip(0..);
        Self(told.filter(|((told, is), _)| told != is).map(|((_, is), node)| [node, is]).collect())
    }

    /// The first node that is the same vertex, of each.
    pub(super) fn first(
        &self,
        faces: &[[u32; 3]],
        cells: &[[i32; 3]],
    ) -> Result<Vec<u32>, Malformed> {
        let wrong = |reason: &str| Malformed { at: 0, reason: reason.into() };
        let mut first = by_cells(faces, cells);
        for &[node, is] in &self.0 {
            let node = first.get_mut(node as usize);
            *node.ok_or_else(|| wrong("an exception of a node that there is not"))? = is;
        }
        // What is first comes before, and is its own first.
        let is_well = |(node, &is): (u32, &u32)| is <= node && first[is as usize] == is;
        match (0..).zip(&first).all(is_well) {
            true => Ok(first),
            false => Err(wrong("a vertex with no first node")),
        }
    }

    pub(super) fn bytes(&self) -> usize {
        4 + 8 * self.0.len()
    }

    pub(super) fn store(&self, out: &mut Vec<u8>) {
        out.extend((self.0.len() as u32).to_le_bytes());
        out.extend(self.0.iter().flatten().flat_map(|node| node.to_le_bytes()));
    }

    pub(super) fn restore(reader: &mut Reader) -> Result<Self, Malformed> {
        let count = reader.u32()?;
        if reader.left() / 8 < count as usize {
            return Err(reader.wrong(format!("{count} exceptions do not follow")));
        }
        let pairs = (0..count).map(|_| Ok([reader.u32()?, reader.u32()?]));
        pairs.collect::<Result<_, _>>().map(Self)
    }
}

/// The rule: nodes on open sides of their parts that are in one cell are one vertex.
fn by_cells(faces: &[[u32; 3]], cells: &[[i32; 3]]) -> Vec<u32> {
    let sides = faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut sides: Vec<_> = sides.collect();
    sides.sort_unstable();
    let is_open = |[a, b]: &&[u32; 2]| sides.binary_search(&[*b, *a]).is_err();
    let open = sides.iter().filter(is_open).flatten();
    let mut open: Vec<_> = open.map(|&node| (cells[node as usize], node)).collect();
    open.sort_unstable();
    let mut first: Vec<u32> = (0..cells.len() as u32).collect();
    for same in open.chunk_by(|a, b| a.0 == b.0) {
        same.iter().for_each(|&(_, node)| first[node as usize] = same[0].1);
    }
    first
}
