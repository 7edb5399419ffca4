//! Welding the copies of a vertex that several parts have.

use meshlod_mesh::VertexId;

use crate::bytes::{Malformed, Reader};

/// Nodes that the welding rule assigns to the wrong vertex, each with the first node of its vertex.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct WeldExceptions(Vec<[u32; 2]>);

impl WeldExceptions {
    /// Collects the nodes for which the rule disagrees with `vertex_of`.
    pub(super) fn new(faces: &[[u32; 3]], cells: &[[i32; 3]], vertex_of: &[VertexId]) -> Self {
        let mut first = vec![None; vertex_of.iter().max().map_or(0, |v| v.index() + 1)];
        let actual = (0..).zip(vertex_of).map(|(node, v)| *first[v.index()].get_or_insert(node));
        let both = weld_by_cells(faces, cells).into_iter().zip(actual).zip(0..);
        let wrong = both.filter(|((rule, actual), _)| rule != actual);
        Self(wrong.map(|((_, actual), node)| [node, actual]).collect())
    }

    /// Returns for each node the first node of the same vertex.
    pub(super) fn first_nodes(
        &self,
        faces: &[[u32; 3]],
        cells: &[[i32; 3]],
    ) -> Result<Vec<u32>, Malformed> {
        let wrong = |reason: &str| Malformed { at: 0, reason: reason.into() };
        let mut first = weld_by_cells(faces, cells);
        for &[node, is] in &self.0 {
            let node = first.get_mut(node as usize);
            *node.ok_or_else(|| wrong("a weld exception names a node that does not exist"))? = is;
        }
        // A first node is never after the others, and is its own first node.
        let is_valid = |(node, &is): (u32, &u32)| is <= node && first[is as usize] == is;
        match (0..).zip(&first).all(is_valid) {
            true => Ok(first),
            false => Err(wrong("a weld exception does not lead to the first node of a vertex")),
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
            return Err(reader.wrong(format!("too few bytes for {count} weld exceptions")));
        }
        let pairs = (0..count).map(|_| Ok([reader.u32()?, reader.u32()?]));
        pairs.collect::<Result<_, _>>().map(Self)
    }
}

/// Welds nodes in one cell that lie on boundary edges of their parts, and returns for each node the
/// first one that it is welded to. This rule is right for nearly all nodes.
fn weld_by_cells(faces: &[[u32; 3]], cells: &[[i32; 3]]) -> Vec<u32> {
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
