//! Faces at one place, pair by pair: all of them where they are few, by their directions where many.

use std::ops::ControlFlow;

use glam::DVec3;
use meshlod_mesh::{FaceId, VertexId};
use meshlod_spatial::{BoxBlocks, LANES, lanes};

use super::{Search, Step};

/// From here on, pairs come from a net over directions.
const MANY: usize = 64;

impl Search<'_> {
    /// Tests the pairs of faces at one place that no other place answers for: a certified one, or an
    /// earlier one that is not.
    ///
    /// Two faces that share a place have more in common only where their directions from there do:
    /// then a whole stretch of a ray is in both.
    pub(super) fn test_ring(&mut self, star: &[FaceId], place: VertexId) -> Step {
        if star.len() < MANY {
            for (i, &f) in star.iter().enumerate() {
                for &g in &star[i + 1..] {
                    self.test_at(place, f, g)?;
                }
            }
            return ControlFlow::Continue(());
        }
        let blocks = BoxBlocks::new(star.len(), |i| self.directions(star[i as usize], place));
        let face = |at: usize| star[blocks.items()[at] as usize];
        blocks.pairs(&mut |row| {
            lanes(row.lanes).try_for_each(|lane| {
                self.test_at(place, face(row.one as usize), face(row.block as usize * LANES + lane))
            })
        })
    }

    fn test_at(&mut self, place: VertexId, f: FaceId, g: FaceId) -> Step {
        self.look()?;
        let [at_f, at_g] = [f, g].map(|face| self.soup.corners[face.index()]);
        let elsewhere = |&v: &VertexId| {
            v != place && at_g.contains(&v) && (v < place || self.certified.holds(v))
        };
        if at_f.iter().any(elsewhere) {
            return ControlFlow::Continue(());
        }
        self.test_sharing(f, g)
    }

    /// A box around the directions in which a face lies from one of its corners, as points of the
    /// unit sphere.
    fn directions(&self, face: FaceId, place: VertexId) -> [DVec3; 2] {
        let from = self.soup.points.at(place);
        let ends = self.soup.corners[face.index()].into_iter().filter(|&v| v != place);
        let mut box_around = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let mut sum = DVec3::ZERO;
        let mut add = |p: DVec3| box_around = [box_around[0].min(p), box_around[1].max(p)];
        for v in ends {
            let direction = unit(self.soup.points.at(v) - from);
            add(direction);
            sum += direction;
        }
        // The arc between two directions is in the triangle of both and where its tangents meet.
        let square = sum.length_squared();
        if square > WIDE {
            add(sum * (2.0 / square));
        } else {
            [DVec3::NEG_ONE, DVec3::ONE].into_iter().for_each(&mut add);
        }
        [box_around[0] - SLACK, box_around[1] + SLACK]
    }
}

/// Directions 177 degrees apart and more have no use for a tighter box.
const WIDE: f64 = 0.002;
/// What rounding may move a direction by.
const SLACK: f64 = 1e-9;

/// The direction of a vector of any length, however long or short.
fn unit(v: DVec3) -> DVec3 {
    let scaled = v / v.abs().max_element();
    scaled / scaled.length()
}
