//! Octree of the tiles: which cells are divided, and what is beside a cell.

use serde::{Deserialize, Serialize};

use crate::cell::{Cell, MOST_DEPTH};
use crate::lattice::Point;

/// Octree whose leaves hold about as many faces as a tile may have.
///
/// Its text has a hexadecimal digit for four nodes, of a bit each that says whether it is divided.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct TileTree {
    /// All cells; the root is the first, and cells come before those that they are divided into.
    nodes: Vec<TreeNode>,
}

/// Cell of the octree, and those that it is divided into.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TreeNode {
    /// The cell.
    pub cell: Cell,
    /// Index of the first of its eight children, which follow each other; `None` for a leaf.
    pub children: Option<u32>,
}

impl TileTree {
    /// Divides cells from the root on for as long as `is_crowded`, but not beyond
    /// [`MOST_DEPTH`].
    pub fn divide(mut is_crowded: impl FnMut(Cell) -> bool) -> Self {
        let mut nodes = vec![TreeNode { cell: Cell::ROOT, children: None }];
        let mut next = 0;
        while next < nodes.len() {
            let cell = nodes[next].cell;
            if cell.depth < MOST_DEPTH && is_crowded(cell) {
                nodes[next].children = Some(nodes.len() as u32);
                let child = |octant| TreeNode { cell: cell.child(octant), children: None };
                nodes.extend((0..8).map(child));
            }
            next += 1;
        }
        Self { nodes }
    }

    /// Returns all cells: the root first, and cells before those that they are divided into.
    pub fn nodes(&self) -> &[TreeNode] {
        &self.nodes
    }

    /// Returns the depth of the deepest leaf.
    pub fn depth(&self) -> u8 {
        self.nodes.last().map_or(0, |node| node.cell.depth)
    }

    /// Returns the depth of the deepest leaf in a cell of the tree.
    pub fn deepest_in(&self, cell: Cell) -> u8 {
        let children = |node: &TreeNode| {
            node.children.map_or(&[][..], |first| &self.nodes[first as usize..][..8])
        };
        let mut top = &self.nodes[0];
        while let Some(next) = children(top).iter().find(|next| next.cell.contains(cell.middle()))
            && top.cell != cell
        {
            top = next;
        }
        let mut open = vec![top];
        let mut deepest = cell.depth;
        while let Some(node) = open.pop() {
            deepest = deepest.max(node.cell.depth);
            open.extend(children(node));
        }
        deepest
    }

    /// Returns the index of the cell of at most a depth that is beyond one or two sides of another,
    /// at a point of these sides: `toward` has 1 on an axis for the far side, -1 for the near one,
    /// and 0 where the point decides. `None` outside the whole.
    pub fn beside(&self, point: Point, toward: [i32; 3], depth: u8) -> Option<usize> {
        let mut node = 0;
        let root = self.nodes[0].cell;
        let is_out = |axis: usize| {
            let (at, way) = (point[axis], toward[axis]);
            (at == root.low()[axis] && way < 0) || (at == root.high()[axis] && way > 0)
        };
        if (0..3).any(is_out) {
            return None;
        }
        while let Some(children) =
            self.nodes[node].children.filter(|_| self.nodes[node].cell.depth < depth)
        {
            let middle = self.nodes[node].cell.middle();
            let octant = (0..3).fold(0, |octant, axis| {
                let beyond = 2 * (point[axis] - middle[axis]) + toward[axis];
                octant | usize::from(beyond > 0) << axis
            });
            node = children as usize + octant;
        }
        Some(node)
    }

    /// Returns the least depth of the cells around a point on sides of a cell, none of them deeper
    /// than that: where tiles of this depth are shown, and leaves that are less deep.
    pub fn least_depth_around(&self, point: Point, cell: Cell) -> u8 {
        let sides = cell.sides_of(point);
        let way = |axis: usize| match sides >> (2 * axis) & 3 {
            0 => &[0][..],
            1 => &[1, -1],
            _ => &[-1, 1],
        };
        let mut least = cell.depth;
        for &x in way(0) {
            for &y in way(1) {
                for &z in way(2) {
                    let found = self.beside(point, [x, y, z], cell.depth);
                    let depth = found.map_or(cell.depth, |node| self.nodes[node].cell.depth);
                    least = least.min(depth);
                }
            }
        }
        least
    }
}

impl From<TileTree> for String {
    fn from(tree: TileTree) -> Self {
        let digit = |nodes: &[TreeNode]| {
            let bits = nodes.iter().enumerate();
            let bits = bits.map(|(i, node)| u32::from(node.children.is_some()) << i);
            char::from_digit(bits.sum(), 16).expect("four bits")
        };
        tree.nodes.chunks(4).map(digit).collect()
    }
}

impl TryFrom<String> for TileTree {
    type Error = &'static str;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        let wrong = "not the text of an octree";
        let digits: Option<Vec<u32>> = text.chars().map(|digit| digit.to_digit(16)).collect();
        let digits = digits.ok_or(wrong)?;
        let mut at = 0;
        // Cells of the greatest depth are not asked about; they are at the end.
        let tree = Self::divide(|_| {
            let digit = digits.get(at / 4).copied().unwrap_or(0);
            at += 1;
            digit >> ((at - 1) % 4) & 1 == 1
        });
        if String::from(tree.clone()) == text { Ok(tree) } else { Err(wrong) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Divided along the diagonal from the origin, down to a depth.
    fn corner(depth: u8) -> TileTree {
        TileTree::divide(|cell| cell.depth < depth && cell.at == [0; 3])
    }

    #[test]
    fn what_is_beside_a_cell_is_no_deeper_than_asked() {
        let tree = corner(3);
        assert_eq!((tree.nodes().len(), tree.depth()), (25, 3));
        let quarter = Cell::ROOT.child(0).child(1);
        let [x, y, z] = quarter.low();
        let beside =
            |depth| tree.nodes()[tree.beside([x, y + 1, z + 1], [-1, 0, 0], depth).unwrap()].cell;
        assert_eq!(beside(2), Cell::ROOT.child(0).child(0));
        assert_eq!(beside(3), Cell::ROOT.child(0).child(0).child(1));
        assert_eq!(beside(0), Cell::ROOT);
        assert!(tree.beside([0, 5, 5], [-1, 0, 0], 3).is_none());
    }

    #[test]
    fn the_deepest_leaf_in_a_cell_is_found() {
        let (tree, near) = (corner(3), Cell::ROOT.child(0));
        let cells = [Cell::ROOT, near, near.child(0), near.child(1), Cell::ROOT.child(7)];
        assert_eq!(cells.map(|cell| tree.deepest_in(cell)), [3, 3, 3, 2, 1]);
    }

    #[test]
    fn around_a_point_the_shallowest_cell_counts() {
        let tree = corner(3);
        let deep = Cell::ROOT.child(0).child(0).child(7);
        let [x, y, z] = deep.high();
        assert_eq!(tree.least_depth_around([x, y - 1, z - 1], deep), 2);
        let half = Cell::ROOT.child(0);
        let [x, y, z] = half.high();
        assert_eq!(tree.least_depth_around([x, y, z - 1], half), 1);
        assert_eq!(tree.least_depth_around([0, y - 1, z - 1], half), 1);
    }

    #[test]
    fn a_tree_is_known_by_its_text() {
        for tree in [corner(0), corner(1), corner(5), corner(MOST_DEPTH)] {
            let text = String::from(tree.clone());
            assert_eq!(text.len(), tree.nodes().len().div_ceil(4));
            assert_eq!(TileTree::try_from(text), Ok(tree));
        }
        for text in ["", "1", "10", "0000", "2", "x", "10g", "1000"] {
            assert!(TileTree::try_from(text.to_owned()).is_err(), "{text}");
        }
    }
}
