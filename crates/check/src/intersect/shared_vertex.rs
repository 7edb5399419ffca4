//! Pairs of faces around one vertex: all of them if they are few, else by a broad phase over their
//! directions.

use std::ops::ControlFlow;

use glam::DVec3;
use meshlod_mesh::{FaceId, VertexId};

use super::{Flow, Search};
use crate::box_blocks::BoxBlocks;

/// Number of faces from which on pairs come from a broad phase over directions.
const BROAD_PHASE_FROM: usize = 64;

impl Search<'_> {
    /// Tests the pairs of faces around a vertex, except those that share another vertex which is
    /// certified or was tested before.
    ///
    /// Two faces that share a vertex have more in common only if their sets of directions from it
    /// overlap: then both contain a segment of a ray from the vertex.
    pub(super) fn test_ring(&mut self, star: &[FaceId], center: VertexId) -> Flow {
        if star.len() < BROAD_PHASE_FROM {
            for (i, &f) in star.iter().enumerate() {
                for &g in &star[i + 1..] {
                    self.test_at(center, f, g)?;
                }
            }
            return ControlFlow::Continue(());
        }
        let blocks = BoxBlocks::new(star.len(), |i| self.directions(star[i as usize], center));
        let face = |slot: usize| star[blocks.items()[slot] as usize];
        blocks.pairs(&mut |row| {
            row.others().try_for_each(|other| self.test_at(center, face(row.slot), face(other)))
        })
    }

    fn test_at(&mut self, center: VertexId, f: FaceId, g: FaceId) -> Flow {
        self.count_test()?;
        let [at_f, at_g] = [f, g].map(|face| self.soup.corners[face.index()]);
        let elsewhere = |&v: &VertexId| {
            v != center && at_g.contains(&v) && (v < center || self.certified.contains(v))
        };
        if at_f.iter().any(elsewhere) {
            return ControlFlow::Continue(());
        }
        self.test_sharing(f, g)
    }

    /// Returns a box around the directions in which a face lies from one of its corners, as points
    /// of the unit sphere.
    fn directions(&self, face: FaceId, center: VertexId) -> [DVec3; 2] {
        let from = self.soup.positions.at(center);
        let ends = self.soup.corners[face.index()].into_iter().filter(|&v| v != center);
        let mut box_around = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let mut sum = DVec3::ZERO;
        let mut add = |p: DVec3| box_around = [box_around[0].min(p), box_around[1].max(p)];
        for v in ends {
            let direction = unit(self.soup.positions.at(v) - from);
            add(direction);
            sum += direction;
        }
        // The arc between two directions lies in the triangle of both and the intersection of their
        // tangents.
        let square = sum.length_squared();
        if square > WIDE {
            add(sum * (2.0 / square));
        } else {
            [DVec3::NEG_ONE, DVec3::ONE].into_iter().for_each(&mut add);
        }
        [box_around[0] - SLACK, box_around[1] + SLACK]
    }
}

/// Squared length of the sum of two unit vectors 177 degrees apart, from where on the box is the
/// whole sphere's.
const WIDE: f64 = 0.002;
/// Bound on the rounding error of a direction.
const SLACK: f64 = 1e-9;

/// Returns the direction of a vector, without overflow or underflow.
fn unit(v: DVec3) -> DVec3 {
    let scaled = v / v.abs().max_element();
    scaled / scaled.length()
}
