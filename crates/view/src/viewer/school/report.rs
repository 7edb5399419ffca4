//! Figures of all frames, for the report at the end.

use super::SchoolReport;
use crate::{SchoolFrame, ViewError};

/// Report and error that the window leaves behind when it closes.
#[derive(Debug, Default)]
pub(crate) struct SchoolOutcome {
    pub report: SchoolReport,
    /// Error that closed the window.
    pub error: Option<ViewError>,
}

/// Sums of the figures of all frames.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Totals {
    frames: usize,
    faces: f64,
    full_faces: f64,
    members: f64,
    select_ms: f64,
    simulate_ms: f64,
}

impl Totals {
    pub fn add(&mut self, frame: &SchoolFrame) {
        self.frames += 1;
        self.faces += frame.triangles as f64;
        self.full_faces += frame.full_triangles as f64;
        self.members += frame.members as f64;
        self.select_ms += frame.select_ms;
        self.simulate_ms += frame.simulate_ms;
    }

    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Writes the means into a report; without frames they are 0.
    pub fn write(&self, report: &mut SchoolReport) {
        let mean = |sum: f64| sum / self.frames.max(1) as f64;
        report.frames = self.frames;
        report.mean_faces = mean(self.faces);
        report.mean_full_faces = mean(self.full_faces);
        report.mean_members_in_view = mean(self.members);
        report.mean_select_ms = mean(self.select_ms);
        report.mean_simulate_ms = mean(self.simulate_ms);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_over_all_frames() {
        let mut totals = Totals::default();
        for triangles in [10, 30] {
            totals.add(&SchoolFrame { triangles, select_ms: 2.0, ..SchoolFrame::default() });
        }
        let mut report = SchoolReport::default();
        totals.write(&mut report);
        assert_eq!((report.frames, report.mean_faces, report.mean_select_ms), (2, 20.0, 2.0));
        Totals::default().write(&mut report);
        assert_eq!(report.mean_faces, 0.0);
    }
}
