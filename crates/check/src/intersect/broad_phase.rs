//! Broad phase for faces that share no vertex: a box hierarchy against itself, or an octree.

use std::ops::ControlFlow;

use glam::Vec4;
use meshlod_mesh::{FaceId, VertexId};
use meshlod_spatial::Octree;
use rustc_hash::FxHashMap;

use super::{BroadPhase, Flow, Search};
use crate::box_blocks::{BoxBlocks, LANES, OverlapRow};

/// Corners of eight faces, one SIMD lane a face, so that all eight are tested together for a shared
/// corner with another face. Nearly all faces whose boxes overlap share one.
struct CornerBlock([[u32; LANES]; 3]);

impl CornerBlock {
    fn of(faces: impl Iterator<Item = [VertexId; 3]>) -> Self {
        // No vertex has the id `u32::MAX`.
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

    /// Returns a mask with one bit for each face that has one of the given corners.
    #[inline]
    fn sharing(&self, [VertexId(a), VertexId(b), VertexId(c)]: [VertexId; 3]) -> u8 {
        let mut shares = [0; LANES];
        for corners in &self.0 {
            for (share, &v) in shares.iter_mut().zip(corners) {
                *share |= ones_if(v == a) | ones_if(v == b) | ones_if(v == c);
            }
        }
        // One instruction collects the sign bits of four numbers.
        let half = |from: usize| {
            let signs = std::array::from_fn(|lane| f32::from_bits(shares[from + lane]));
            Vec4::from_array(signs).is_negative_bitmask()
        };
        (half(0) | half(4) << 4) as u8
    }
}

/// Returns the mask that a SIMD comparison gives.
#[inline]
fn ones_if(condition: bool) -> u32 {
    if condition { u32::MAX } else { 0 }
}

/// Octree leaves with more faces are searched by a box hierarchy of their own.
const CROWD: usize = 64;

/// Number of faces from which a vertex is high-valence: the boxes of its faces all overlap, and
/// none of their pairs is of interest here.
const HIGH_VALENCE: u32 = 256;

impl Search<'_> {
    /// Tests all pairs of faces that share no vertex and may intersect.
    pub(super) fn test_disjoint(
        &mut self,
        broad_phase: BroadPhase,
        counts: impl Fn(FaceId) -> bool,
    ) -> Flow {
        let faces: Vec<FaceId> =
            (0..self.soup.corners.len()).map(FaceId::new).filter(|&f| counts(f)).collect();
        match broad_phase {
            BroadPhase::Tree => self.test_by_hierarchy(&faces, &self.high_valence_vertices()),
            BroadPhase::Octree => self.test_by_octree(&faces),
        }
    }

    /// Returns the high-valence vertices in ascending order.
    fn high_valence_vertices(&self) -> Vec<VertexId> {
        let input = self.input;
        let star = |v: VertexId| input.connectivity.star(v).len() as u32;
        let mut sizes = FxHashMap::default();
        for v in input.unique.duplicates() {
            *sizes.entry(input.unique.representative(v)).or_insert(0) += star(v);
        }
        let all = (0..input.positions.len()).map(VertexId::new);
        all.filter(|v| star(*v) + sizes.get(v).copied().unwrap_or(0) >= HIGH_VALENCE).collect()
    }

    /// Tests the pairs whose boxes overlap.
    fn test_by_hierarchy(&mut self, faces: &[FaceId], high_valence: &[VertexId]) -> Flow {
        let soup = self.soup;
        let box_of = |i: u32| {
            let [a, b, c] = soup.triangle(faces[i as usize]);
            [a.min(b).min(c), a.max(b).max(c)]
        };
        let group = |i: u32| {
            let corners = soup.corners[faces[i as usize].index()];
            corners.into_iter().find(|v| high_valence.binary_search(v).is_ok()).map(|v| v.0)
        };
        let blocks = match high_valence {
            [] => BoxBlocks::new(faces.len(), box_of),
            _ => BoxBlocks::grouped(faces.len(), box_of, group),
        };
        let in_order = |&item: &u32| faces.get(item as usize).copied();
        let corners: Vec<CornerBlock> = blocks
            .items()
            .chunks(LANES)
            .map(|chunk| {
                CornerBlock::of(chunk.iter().map_while(in_order).map(|f| soup.corners[f.index()]))
            })
            .collect();
        let face = |slot: usize| faces[blocks.items()[slot] as usize];
        let corners_in = |slot: usize| corners[slot / LANES].lane(slot % LANES);
        blocks.pairs(&mut |row| {
            self.count_test()?;
            let one = corners_in(row.slot);
            let lanes = row.lanes & !corners[row.block].sharing(one);
            OverlapRow { lanes, ..row }.others().try_for_each(|other| {
                if self.disjoint_intersect([one, corners_in(other)]) {
                    self.keep([face(row.slot), face(other)])?;
                }
                ControlFlow::Continue(())
            })
        })
    }

    /// Tests the pairs that pass through a common octree leaf.
    fn test_by_octree(&mut self, faces: &[FaceId]) -> Flow {
        let soup = self.soup;
        let octree = Octree::new(faces.len(), |i| soup.triangle(faces[i as usize]));
        let high_valence = self.high_valence_vertices();
        octree.leaves().iter().try_for_each(|leaf| {
            let inside: Vec<FaceId> = leaf.triangles.iter().map(|&i| faces[i as usize]).collect();
            if inside.len() > CROWD {
                return self.test_by_hierarchy(&inside, &high_valence);
            }
            for (i, &f) in inside.iter().enumerate() {
                for &g in &inside[i + 1..] {
                    self.count_test()?;
                    let corners = [f, g].map(|face| soup.corners[face.index()]);
                    let share = corners[0].iter().any(|v| corners[1].contains(v));
                    if !share && self.disjoint_intersect(corners) {
                        self.keep([f, g])?;
                    }
                }
            }
            ControlFlow::Continue(())
        })
    }
}
