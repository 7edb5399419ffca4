//! Coding of the corners of a block that share a wedge.

use super::adjacency::{BlockFaces, NONE, next, previous};
use super::coder::Coder;

/// Wedges of a block: a number for each corner, in the order of faces.
#[derive(Clone, Debug, Default)]
pub(in super::super) struct BlockWedges {
    /// Wedge of each corner, numbered 3 · face + corner.
    pub(in super::super) of_corner: Vec<u16>,
    /// Vertex of each wedge.
    pub(in super::super) vertex: Vec<u16>,
    /// Wedge of the mesh that each wedge is; empty while decoding.
    pub(in super::super) sources: Vec<u32>,
}

/// Contexts of the bits.
pub(super) const WEDGE_BITS: usize = 3 * 9 + 3 + OTHERS;
/// Number of a vertex's wedges that are tried after those of the faces next to the corner. A wedge
/// that is not found is stored again.
const OTHERS: usize = 3;

/// Codes the wedge of each corner: that of the face across one of its two sides, an earlier one of
/// its vertex, or a new one.
pub(super) fn code_wedges(
    faces: &BlockFaces,
    coder: &mut impl Coder,
    source: Option<&[[u32; 3]]>,
) -> BlockWedges {
    let corners = 3 * faces.faces.len();
    let mut out = BlockWedges { of_corner: vec![NONE; corners], ..BlockWedges::default() };
    let most = faces.faces.as_flattened().iter().max().map_or(0, |&v| usize::from(v) + 1);
    // The latest wedge of each vertex, and the one before each wedge.
    let mut latest = vec![NONE; most];
    let mut before: Vec<u16> = Vec::new();
    for corner in 0..corners {
        let vertex = faces.faces.as_flattened()[corner];
        let wanted = source.map(|source| source.as_flattened()[corner]);
        let candidates = WedgeCandidates::at(corner, faces, &out.of_corner);
        let is =
            |wedge: u16, out: &BlockWedges| wanted.map(|w| out.sources[usize::from(wedge)] == w);
        let mut found = None;
        let all = candidates.all(latest[usize::from(vertex)], &before);
        for (wedge, context) in all {
            if coder.bit(context, is(wedge, &out)) {
                found = Some(wedge);
                break;
            }
        }
        let wedge = found.unwrap_or_else(|| {
            let wedge = out.vertex.len() as u16;
            out.vertex.push(vertex);
            out.sources.extend(wanted);
            before.push(std::mem::replace(&mut latest[usize::from(vertex)], wedge));
            wedge
        });
        out.of_corner[corner] = wedge;
    }
    out
}

/// Wedges of the faces across the two sides at a corner.
struct WedgeCandidates {
    known: [Option<u16>; 2],
    /// For each side: 0 if nothing is known of its other end, 1 if both faces use the same wedge
    /// there, 2 if there is a seam.
    ends: [usize; 2],
}

impl WedgeCandidates {
    fn at(corner: usize, faces: &BlockFaces, of_corner: &[u16]) -> Self {
        // Before this corner everything is known, and nothing from it on.
        let known = |at: usize| Some(of_corner[at]).filter(|&wedge| wedge != NONE);
        let mut this = Self { known: [None; 2], ends: [0; 2] };
        let sides = [(corner, next(corner)), (previous(corner), previous(corner))];
        for (k, (side, other_end)) in sides.into_iter().enumerate() {
            let Some(twin) = faces.twin(side) else { continue };
            let (here, there) = if k == 0 { (next(twin), twin) } else { (twin, next(twin)) };
            this.known[k] = known(here);
            if let (Some(a), Some(b), Some(_)) = (known(other_end), known(there), this.known[k]) {
                this.ends[k] = if a == b { 1 } else { 2 };
            }
        }
        this
    }

    /// Lists the wedges to try with the contexts of their bits: those of the faces, then the latest
    /// others of the vertex.
    fn all<'a>(
        &self,
        latest: u16,
        before: &'a [u16],
    ) -> impl Iterator<Item = (u16, usize)> + use<'a> {
        let (first, second, context) = match self.known {
            [Some(a), Some(b)] if a == b => (Some(a), None, 9 + 3 * self.ends[0] + self.ends[1]),
            [Some(a), Some(b)] => (Some(a), Some(b), 18 + 3 * self.ends[0] + self.ends[1]),
            [Some(a), None] => (Some(a), None, 3 * self.ends[0]),
            [None, Some(b)] => (Some(b), None, 3 * self.ends[1] + 1),
            [None, None] => (None, None, 0),
        };
        let ends = self.ends[1];
        let others =
            std::iter::successors(Some(latest), |&wedge| before.get(usize::from(wedge)).copied())
                .take_while(|&wedge| wedge != NONE)
                .filter(move |&wedge| Some(wedge) != first && Some(wedge) != second)
                .take(OTHERS)
                .enumerate()
                .map(|(k, wedge)| (wedge, 30 + k));
        first
            .map(|wedge| (wedge, context))
            .into_iter()
            .chain(second.map(|wedge| (wedge, 27 + ends)))
            .chain(others)
    }
}
