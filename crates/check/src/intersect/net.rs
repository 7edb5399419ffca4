//! Faces that share nothing: by a hierarchy of boxes against itself, or by an octree of cubes.

use std::ops::ControlFlow;

use glam::Vec4;
use meshlod_mesh::{FaceId, VertexId};
use meshlod_spatial::{BoxBlocks, LANES, Octree, lanes};
use rustc_hash::FxHashMap;

use super::{Net, Search, Step};

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
        let mut shares = [0; LANES];
        for corners in &self.0 {
            for (share, &v) in shares.iter_mut().zip(corners) {
                *share |= ones_if(v == a) | ones_if(v == b) | ones_if(v == c);
            }
        }
        // The sign bits of four numbers are one instruction away.
        let half = |from: usize| {
            let signs = std::array::from_fn(|lane| f32::from_bits(shares[from + lane]));
            Vec4::from_array(signs).is_negative_bitmask()
        };
        (half(0) | half(4) << 4) as u8
    }
}

/// What a comparison of lanes gives.
#[inline]
fn ones_if(condition: bool) -> u32 {
    if condition { u32::MAX } else { 0 }
}

/// Cubes with more faces are searched by a tree of their own.
const CROWD: usize = 64;

/// A place with this many faces is a hub: their boxes all overlap there, and none of these pairs is
/// for the net.
const HUB: u32 = 256;

impl Search<'_> {
    /// Tests all pairs of faces that share no place and may meet.
    pub(super) fn apart(&mut self, net: Net, counts: impl Fn(FaceId) -> bool) -> Step {
        let faces: Vec<FaceId> =
            (0..self.soup.corners.len()).map(FaceId::new).filter(|&f| counts(f)).collect();
        match net {
            Net::Tree => self.by_tree(&faces, &self.hubs()),
            Net::Cubes => self.by_cubes(&faces),
        }
    }

    /// The places with very many faces, in their order.
    fn hubs(&self) -> Vec<VertexId> {
        let ground = self.ground;
        let star = |v: VertexId| ground.connectivity.star(v).len() as u32;
        let mut sizes = FxHashMap::default();
        for v in ground.places.doubles() {
            *sizes.entry(ground.places.first(v)).or_insert(0) += star(v);
        }
        let all = (0..ground.positions.len()).map(VertexId::new);
        all.filter(|v| star(*v) + sizes.get(v).copied().unwrap_or(0) >= HUB).collect()
    }

    /// Tests the pairs whose boxes overlap.
    fn by_tree(&mut self, faces: &[FaceId], hubs: &[VertexId]) -> Step {
        let soup = self.soup;
        let box_of = |i: u32| {
            let [a, b, c] = soup.triangle(faces[i as usize]);
            [a.min(b).min(c), a.max(b).max(c)]
        };
        let hub_of = |i: u32| {
            let corners = soup.corners[faces[i as usize].index()];
            corners.into_iter().find(|v| hubs.binary_search(v).is_ok()).map(|v| v.0)
        };
        let blocks = match hubs {
            [] => BoxBlocks::new(faces.len(), box_of),
            _ => BoxBlocks::grouped(faces.len(), box_of, hub_of),
        };
        let in_order = |&place: &u32| faces.get(place as usize).copied();
        let corners: Vec<CornerBlock> = blocks
            .items()
            .chunks(LANES)
            .map(|chunk| {
                CornerBlock::of(chunk.iter().map_while(in_order).map(|f| soup.corners[f.index()]))
            })
            .collect();
        let face = |place: usize| faces[blocks.items()[place] as usize];
        blocks.pairs(&mut |row| {
            self.look()?;
            let (one, block) = (row.one as usize, row.block as usize);
            let corners_one = corners[one / LANES].lane(one % LANES);
            let near = row.lanes & !corners[block].sharing(corners_one);
            lanes(near).try_for_each(|lane| {
                if self.meet_apart([corners_one, corners[block].lane(lane)]) {
                    self.keep([face(one), face(block * LANES + lane)])?;
                }
                ControlFlow::Continue(())
            })
        })
    }

    /// Tests the pairs that pass through one cube.
    fn by_cubes(&mut self, faces: &[FaceId]) -> Step {
        let soup = self.soup;
        let octree = Octree::new(faces.len(), |i| soup.triangle(faces[i as usize]));
        let hubs = self.hubs();
        octree.cubes().iter().try_for_each(|cube| {
            let inside: Vec<FaceId> = cube.triangles.iter().map(|&i| faces[i as usize]).collect();
            if inside.len() > CROWD {
                return self.by_tree(&inside, &hubs);
            }
            for (i, &f) in inside.iter().enumerate() {
                for &g in &inside[i + 1..] {
                    self.look()?;
                    let corners = [f, g].map(|face| soup.corners[face.index()]);
                    let share = corners[0].iter().any(|v| corners[1].contains(v));
                    if !share && self.meet_apart(corners) {
                        self.keep([f, g])?;
                    }
                }
            }
            ControlFlow::Continue(())
        })
    }
}
