//! Prediction of texture coordinates from positions: a chart keeps angles, more or less, and
//! continues as it did across the last edge.

use glam::DVec2;

use super::adjacency::{NONE, next, previous};
use super::coder::Coder;
use super::energy::{Energy, LEVELS};
use super::entries::LayerEntries;
use super::geometry::BlockGeometry;
use super::job::{LayerJob, nearest};

/// Contexts of the residuals: kinds of surroundings, levels of the residuals around, components.
pub(super) const UV_RESIDUALS: usize = KINDS * LEVELS * 2;
/// Nothing known, one neighbour, one face, several faces.
const KINDS: usize = 4;

/// Known values around an entry, and predictions from them.
#[derive(Clone, Copy, Debug, Default)]
struct UvSurroundings {
    /// Weighted sum of what the faces predict, and of their weights.
    by_faces: DVec2,
    weight: f64,
    faces: usize,
    /// Sum of the neighbours' values.
    by_neighbours: DVec2,
    neighbours: usize,
}

/// Codes the texture coordinates of all entries.
pub(super) fn code_uvs(job: &LayerJob, coder: &mut impl Coder, numbers: &mut [i32]) {
    let &LayerJob { geometry, entries, layer, .. } = job;
    let most = &layer.most;
    let mut energy = Energy::new(entries.len());
    let mut uvs: Vec<DVec2> = Vec::with_capacity(entries.len());
    let trust = f64::from(layer.mode) / 8.0;
    let mut charts = Charts { geometry, entries, sign: 1.0, trust };
    let mut last = DVec2::new(f64::from(most[0]), f64::from(most[1])) * 0.5;
    for entry in 0..entries.len() {
        let around = charts.around(entry, &uvs, &mut energy);
        let (kind, predicted) = around.predict(last);
        let mut magnitude = energy.around();
        let mut value = [0; 2];
        for k in 0..2 {
            let predicted = nearest(predicted[k], most[k]);
            let context = (kind * LEVELS + Energy::level(magnitude)) * 2 + k;
            let at = job.contexts.residuals + context;
            let wanted = job.wanted(entry).map(|wanted| wanted[k] - predicted);
            let residual = coder.residual(at, wanted);
            value[k] = predicted.wrapping_add(residual);
            numbers[2 * entry + k] = value[k];
            let size = f64::from(residual.unsigned_abs());
            energy.add(entry, size);
            magnitude = 0.5 * magnitude + size;
        }
        last = DVec2::new(f64::from(value[0]), f64::from(value[1]));
        uvs.push(last);
        charts.turn(entry, &uvs);
    }
}

impl UvSurroundings {
    /// Returns the kind of the surroundings, and the prediction.
    fn predict(&self, last: DVec2) -> (usize, DVec2) {
        match *self {
            Self { faces: 1, .. } => (2, self.by_faces / self.weight),
            Self { faces: 2.., .. } => (3, self.by_faces / self.weight),
            Self { neighbours: 1.., .. } => (1, self.by_neighbours / self.neighbours as f64),
            _ => (0, last),
        }
    }
}

/// Charts of a block, as far as they are known.
struct Charts<'a> {
    geometry: &'a BlockGeometry<'a>,
    entries: &'a LayerEntries,
    /// −1 if the last chart seen is mirrored.
    sign: f64,
    /// Weight of stretching a chart as beyond the last edge, against keeping its angles.
    trust: f64,
}

impl Charts<'_> {
    /// Gathers the known values around an entry.
    fn around(&self, entry: usize, uvs: &[DVec2], energy: &mut Energy) -> UvSurroundings {
        let mut all = UvSurroundings::default();
        energy.clear();
        for corner in self.entries.around(entry) {
            let ends = [next(corner), previous(corner)];
            let known = ends.map(|at| self.entries.before(at, entry));
            for other in known.into_iter().flatten() {
                all.by_neighbours += uvs[other];
                all.neighbours += 1;
                energy.see(other);
            }
            if let [Some(_), Some(_)] = known
                && let Some((uv, weight)) = self.across(corner, entry, uvs)
            {
                all.by_faces += weight * uv;
                all.weight += weight;
                all.faces += 1;
            }
        }
        all
    }

    /// Predicts a corner from the edge across. Returns how much that counts, too.
    ///
    /// A chart that keeps angles is known from one edge. If the face beyond is known, it says how
    /// the chart is stretched across the edge.
    fn across(&self, corner: usize, entry: usize, uvs: &[DVec2]) -> Option<(DVec2, f64)> {
        let [a, b] = [next(corner), previous(corner)];
        let [uv_a, uv_b] = [a, b].map(|at| uvs[usize::from(self.entries.of_corner[at])]);
        let edge = uv_b - uv_a;
        let frame = self.geometry.frame(a, b, corner)?;
        let mut up = self.sign * edge.perp();
        if let Some(beyond) = self.beyond(a, b)
            && let Some(other) = self.entries.before(beyond, entry)
            && let Some(there) = self.geometry.frame(b, a, beyond)
        {
            let uv = uvs[other];
            // Seen from b, along the reversed edge.
            let across = (uv - uv_b + there.x * edge) / -there.y;
            let cross = edge.perp_dot(uv - uv_a);
            up = edge.perp() * if cross < 0.0 { 1.0 } else { -1.0 };
            up = (1.0 - self.trust) * up + self.trust * across;
        }
        let far = frame.x * frame.x + (1.0 - frame.x) * (1.0 - frame.x) + 2.0 * frame.y * frame.y;
        Some((uv_a + frame.x * edge + frame.y * up, 1.0 / (0.25 + far)))
    }

    /// Returns the corner beyond the edge from `a` to `b`, if its face is in the same chart.
    fn beyond(&self, a: usize, b: usize) -> Option<usize> {
        let twin = self.geometry.faces.twin(a)?;
        let of = |corner: usize| self.entries.of_corner[corner];
        (of(twin) == of(b) && of(next(twin)) == of(a)).then_some(previous(twin))
    }

    /// Notes which way round the chart of the latest entry lies.
    fn turn(&mut self, entry: usize, uvs: &[DVec2]) {
        for corner in self.entries.around(entry) {
            let [a, b] = [next(corner), previous(corner)].map(|at| self.entries.of_corner[at]);
            if a == NONE || usize::from(a) >= entry || usize::from(b) >= entry {
                continue;
            }
            let [a, b] = [a, b].map(|at| uvs[usize::from(at)]);
            let area = (b - a).perp_dot(uvs[entry] - a);
            if area != 0.0 {
                self.sign = area.signum();
            }
        }
    }
}
