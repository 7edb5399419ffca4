//! Faces that share nothing, by a hierarchy of boxes against itself.

use std::ops::ControlFlow;

use meshlod_mesh::{FaceId, VertexId};
use meshlod_spatial::{BoxBlocks, LANES, lanes};

use super::Search;

/// The corners of eight faces, one lane a face: so that all eight are asked at once whether they
/// share a corner with another. Nearly all faces whose boxes overlap do.
struct CornerBlock([[u32; LANES]; 3]);

impl CornerBlock {
    fn of(faces: impl Iterator<Item = [VertexId; 3]>) -> Self {
        // No vertex has this id.
        let mut block = Self([[u32::MAX; LANES]; 3]);
        for (lane, face) in faces.enumerate() {
            for (corners, v) in block.0.iter_mut().zip(face) {
                corners[lane] = v.0;
            }
        }
        block
    }

    #[inline]
    fn lane(&self, lane: usize) -> [VertexId; 3] {
        let [a, b, c] = &self.0;
        [a[lane], b[lane], c[lane]].map(VertexId)
    }

    /// A bit for each face that has one of three corners.
    #[inline]
    fn sharing(&self, [VertexId(a), VertexId(b), VertexId(c)]: [VertexId; 3]) -> u8 {
        let mut shares = [0u32; LANES];
        for corners in &self.0 {
            for (share, &v) in shares.iter_mut().zip(corners) {
                *share |= u32::from(v == a) | u32::from(v == b) | u32::from(v == c);
            }
        }
        (0..LANES).fold(0, |bits, lane| bits | (shares[lane] as u8) << lane)
    }
}

impl Search<'_> {
    /// Tests all pairs of faces that share no place and may meet.
    pub(super) fn apart(&mut self, counts: impl Fn(FaceId) -> bool) {
        let soup = self.soup;
        let faces: Vec<FaceId> =
            (0..soup.corners.len()).map(FaceId::new).filter(|&f| counts(f)).collect();
        let blocks = BoxBlocks::new(faces.len(), |i| {
            let [a, b, c] = soup.triangle(faces[i as usize]);
            [a.min(b).min(c), a.max(b).max(c)]
        });
        let in_order = |&place: &u32| faces.get(place as usize).copied();
        let corners: Vec<CornerBlock> = blocks
            .items()
            .chunks(LANES)
            .map(|chunk| {
                CornerBlock::of(chunk.iter().map_while(in_order).map(|f| soup.corners[f.index()]))
            })
            .collect();
        let face = |place: usize| faces[blocks.items()[place] as usize];
        let _ = blocks.pairs(&mut |row| {
            let (one, block) = (row.one as usize, row.block as usize);
            let corners_one = corners[one / LANES].lane(one % LANES);
            let near = row.lanes & !corners[block].sharing(corners_one);
            for lane in lanes(near) {
                if self.meet_apart([corners_one, corners[block].lane(lane)]) {
                    self.found.push([face(one), face(block * LANES + lane)]);
                }
            }
            ControlFlow::<()>::Continue(())
        });
    }
}
