//! Distinct values of one layer in a block: wedges of a vertex often share them, as normals are
//! shared across a seam of the texture.

use super::adjacency::{BlockFaces, NONE};
use super::coder::Coder;
use super::wedges::BlockWedges;

/// Distinct values of a layer, called entries, in the order in which they are coded.
#[derive(Clone, Debug)]
pub(super) struct LayerEntries {
    /// Entry of each wedge.
    pub(super) of_wedge: Vec<u16>,
    /// Entry of each corner.
    pub(super) of_corner: Vec<u16>,
    /// First wedge of each entry.
    pub(super) wedge: Vec<u16>,
    /// Corners of all entries, entry by entry, and where those of each entry start.
    around: Vec<u16>,
    starts: Vec<u16>,
}

/// Contexts of the bits.
pub(super) const ENTRY_BITS: usize = 3;

impl LayerEntries {
    /// Codes which wedges share their values; `same` compares two of them.
    pub(super) fn code(
        faces: &BlockFaces,
        wedges: &BlockWedges,
        coder: &mut impl Coder,
        context: usize,
        same: Option<impl Fn(u16, u16) -> bool>,
    ) -> Self {
        let count = wedges.vertex.len();
        let most = wedges.vertex.iter().max().map_or(0, |&v| usize::from(v) + 1);
        let mut latest = vec![NONE; most];
        let mut before: Vec<u16> = Vec::new();
        let mut this = Self {
            of_wedge: Vec::with_capacity(count),
            of_corner: Vec::new(),
            wedge: Vec::new(),
            around: Vec::new(),
            starts: Vec::new(),
        };
        for (wedge, &vertex) in (0..).zip(&wedges.vertex) {
            let mut entry = latest[usize::from(vertex)];
            for tried in 0..ENTRY_BITS {
                if entry == NONE {
                    break;
                }
                let is = same.as_ref().map(|same| same(this.wedge[usize::from(entry)], wedge));
                if coder.bit(context + tried, is) {
                    break;
                }
                entry = if tried + 1 < ENTRY_BITS { before[usize::from(entry)] } else { NONE };
            }
            if entry == NONE {
                entry = this.wedge.len() as u16;
                this.wedge.push(wedge);
                before.push(std::mem::replace(&mut latest[usize::from(vertex)], entry));
            }
            this.of_wedge.push(entry);
        }
        this.gather(faces, wedges);
        this
    }

    /// Lists the corners of each entry.
    fn gather(&mut self, faces: &BlockFaces, wedges: &BlockWedges) {
        let entry = |&wedge: &u16| self.of_wedge[usize::from(wedge)];
        self.of_corner = wedges.of_corner.iter().map(entry).collect();
        self.starts = vec![0; self.wedge.len() + 1];
        for &entry in &self.of_corner {
            self.starts[usize::from(entry) + 1] += 1;
        }
        for entry in 0..self.wedge.len() {
            self.starts[entry + 1] += self.starts[entry];
        }
        let mut ends = self.starts.clone();
        self.around = vec![0; 3 * faces.faces.len()];
        for (corner, &entry) in (0..).zip(&self.of_corner) {
            let end = &mut ends[usize::from(entry)];
            self.around[usize::from(*end)] = corner;
            *end += 1;
        }
    }

    pub(super) fn len(&self) -> usize {
        self.wedge.len()
    }

    /// Returns the corners of an entry.
    pub(super) fn around(&self, entry: usize) -> impl Iterator<Item = usize> + Clone {
        let corners = &self.around[self.starts[entry].into()..self.starts[entry + 1].into()];
        corners.iter().map(|&corner| corner.into())
    }

    /// Returns the entry of a corner if it precedes another one.
    #[inline]
    pub(super) fn before(&self, corner: usize, entry: usize) -> Option<usize> {
        Some(usize::from(self.of_corner[corner])).filter(|&other| other < entry)
    }
}
