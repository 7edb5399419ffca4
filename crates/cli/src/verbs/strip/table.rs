//! Table of the strip measurements of all levels.

use crate::text::numbers::count;
use crate::text::simplify_report;
use crate::text::table::aligned;

use super::{Strip, StripSource, StrippedLevel};

impl Strip {
    pub(super) fn text(&self, source: &StripSource, levels: &[StrippedLevel]) -> String {
        let headings = [
            "level",
            "triangles",
            "vertices",
            "per triangle",
            "indices",
            "strips",
            "swaps",
            "ACMR16",
            "ACMR32",
            "ms",
        ];
        let mut rows = vec![headings.map(String::from)];
        rows.extend(levels.iter().map(row));
        let mut text = aligned(&rows);
        text += "vertices: sent when each strip is drawn by itself; indices: sent with restarts between strips;\n";
        text += "ACMR: vertices fetched per triangle with a FIFO cache of 16 or 32\n";
        if self.verify {
            let wrong: Vec<_> = levels.iter().filter(|level| level.is_wrong()).collect();
            for StrippedLevel { size, difference, .. } in &wrong {
                let (missing, extra) = difference.map_or((0, 0), |d| (d.missing, d.extra));
                text += &format!("{size}: {missing} missing and {extra} extra triangles\n");
            }
            if wrong.is_empty() {
                text += "verified: the strips draw exactly the faces of each level\n";
            }
        }
        let left_out = source.input.mesh.faces.len() - source.tree.faces().len();
        if left_out > 0 {
            text += &format!(
                "left out: {}, degenerate or duplicate\n",
                crate::text::numbers::faces(left_out)
            );
        }
        if !source.simplify_time.is_zero() {
            text += &simplify_report::seconds_line(source.simplify_time);
        }
        text
    }
}

fn row(level: &StrippedLevel) -> [String; 10] {
    let StrippedLevel { sent, triangles, .. } = level;
    let each = sent.vertices_sent as f64 / (*triangles).max(1) as f64;
    [
        level.size.to_string(),
        count(*triangles),
        count(sent.vertices_sent),
        format!("{each:.3}"),
        count(sent.indices_with_restart),
        count(sent.strips),
        count(sent.swaps),
        format!("{:.3}", sent.acmr16),
        format!("{:.3}", sent.acmr32),
        format!("{:.1}", level.time.as_secs_f64() * 1e3),
    ]
}
