//! `compress --sweep`: what numbers of parts cost, and how close they come.

use meshlod::Mesh;
use meshlod::codec::{Partitioner, Parts};
use meshlod::jobs::chain_samples;
use meshlod::measure::{Distance, surface_distance};
use serde_json::{Value, json};

use super::Compress;
use crate::session::Session;
use crate::session::failure::Failure;
use crate::session::files;
use crate::text::distance;
use crate::text::numbers::{count, percent, value};
use crate::text::table::aligned;

/// A mesh in some number of parts.
struct SweepRow {
    parts: Parts,
    /// Distance of the decoded surface.
    distance: Distance,
}

impl Compress {
    /// Partitions a mesh into each of the requested numbers of parts, and measures what comes back
    /// [LCL10, figure 5]. Returns JSON and text.
    pub(super) fn sweep(&self, mesh: &Mesh, session: &Session) -> Result<(Value, String), Failure> {
        let surface = distance::ready(mesh, &self.input)?;
        let options = chain_samples(&surface);
        let partitioner = Partitioner::new(mesh).map_err(|error| self.failed(error))?;
        let mut rows = Vec::new();
        for &parts in &self.sweep {
            session.progress.stage(&format!("{} parts", count(parts)));
            let parts = partitioner.with_count(parts, self.reconstruction());
            let decoded = parts.decode();
            let decoded = distance::ready(&decoded, &self.input)?;
            let distance = surface_distance(&surface, &decoded, &options);
            let distance = distance.map_err(|error| self.failed(error))?;
            rows.push(SweepRow { parts, distance });
        }
        let bounds = mesh.bounds();
        let longest = (0..3).map(|axis| bounds.max[axis] - bounds.min[axis]).fold(0.0, f64::max);
        let json = json!({
            "file": files::name(&self.input),
            "longest_side": longest,
            "sweep": rows.iter().map(|row| row.json(longest)).collect::<Vec<_>>(),
        });
        Ok((json, text(&rows, longest)))
    }
}

impl SweepRow {
    /// Returns the mean distance in the unit of [LCL10], half the longest side of the mesh; 0 for a
    /// mesh of one point.
    fn mean(&self, longest: f64) -> f64 {
        if longest > 0.0 { self.distance.mean() / (longest / 2.0) } else { 0.0 }
    }

    fn json(&self, longest: f64) -> Value {
        let Self { parts, distance } = self;
        json!({
            "parts": parts.parts().len(),
            "cell": parts.cell(),
            "bytes_positions": parts.position_bytes(),
            "reduction": parts.reduction(),
            "repeated_vertices": parts.overhead(),
            "mean": distance.mean(),
            "mean_of_half_side": self.mean(longest),
            "max": distance.max(),
        })
    }

    fn cells(&self, longest: f64) -> Vec<String> {
        let Self { parts, distance } = self;
        vec![
            count(parts.parts().len()),
            count(parts.position_bytes()),
            percent(100.0 * parts.reduction()),
            percent(100.0 * parts.overhead()),
            value(distance.mean()),
            value(distance.max()),
            format!("{:.1}", 1e6 * self.mean(longest)),
        ]
    }
}

fn text(rows: &[SweepRow], longest: f64) -> String {
    let headings =
        ["parts", "bytes", "reduction", "repeated", "mean", "max", "mean, 10^-6 of half side"];
    let mut lines = vec![headings.map(String::from).to_vec()];
    lines.extend(rows.iter().map(|row| row.cells(longest)));
    aligned(&lines)
        + "bytes: positions with headers; reduction: against three f32 per vertex; repeated: vertices \
           stored again;\nmean, max: distance between the surfaces in model units; half side: of the \
           longest side\n"
}
