//! Tangents expected from positions, texture coordinates and normals.

use glam::{DVec2, DVec3};

use super::adjacency::{next, previous};
use super::coder::Coder;
use super::directions::Guess;
use super::entries::LayerEntries;
use super::geometry::BlockGeometry;
use super::job::LayerJob;

/// Contexts of the bits: handedness by that of the chart.
pub(super) const TANGENT_BITS: usize = 3;

/// Texture coordinates and normals of all corners, from which tangents follow.
pub(super) struct TangentFrame<'a> {
    pub(super) geometry: &'a BlockGeometry<'a>,
    pub(super) uv: Option<Vec<DVec2>>,
    pub(super) normal: Option<Vec<DVec3>>,
}

impl TangentFrame<'_> {
    /// Returns the direction in which u grows around an entry, at right angles to the normal.
    pub(super) fn tangent_of(&self, entry: usize, entries: &LayerEntries) -> Guess {
        let Some(uv) = &self.uv else { return Guess { bend: 1, ..Guess::default() } };
        let mut sum = DVec3::ZERO;
        let mut is_open = false;
        let mut normal = None;
        for corner in entries.around(entry) {
            is_open |= self.geometry.faces.twin(corner).is_none();
            is_open |= self.geometry.faces.twin(previous(corner)).is_none();
            let [a, b] = self.geometry.edges(corner);
            let [uv_a, uv_b] = [next(corner), previous(corner)].map(|at| uv[at] - uv[corner]);
            let area = uv_a.perp_dot(uv_b);
            normal = self.normal.as_ref().map(|normals| normals[corner]);
            let along = (a * uv_b.y - b * uv_a.y) * area.signum();
            if area != 0.0 {
                let along = normal.map_or(along, |normal| along - normal * normal.dot(along));
                sum += along.try_normalize().unwrap_or_default();
            }
        }
        if let Some(normal) = normal {
            sum -= normal * normal.dot(sum);
        }
        let length = sum.length();
        Guess { direction: (length > 0.0).then(|| sum / length), bend: 0, is_open }
    }

    /// Codes the signs of tangents, the third of their numbers.
    pub(super) fn code_signs(&self, job: &LayerJob, coder: &mut impl Coder, numbers: &mut [i32]) {
        for entry in 0..job.entries.len() {
            let side = self.uv.as_ref().map_or(0, |uv| {
                let corners = job.entries.around(entry);
                let area: f64 = corners
                    .map(|at| (uv[next(at)] - uv[at]).perp_dot(uv[previous(at)] - uv[at]))
                    .sum();
                if area > 0.0 { 1 } else { 2 }
            });
            let wanted = job.wanted(entry).map(|wanted| wanted[2] == 1);
            numbers[3 * entry + 2] = coder.bit(job.contexts.bits + side, wanted).into();
        }
    }
}
