//! Figures of the frames of a film.

use meshlod::flock::levels::LevelTable;
use meshlod::flock::select::InstanceLevel;
use serde::Serialize;
use serde_json::json;

/// Figures of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FrameFigures {
    pub frame: usize,
    /// Time since the first frame.
    pub seconds: f64,
    /// Number of members whose bounding ball meets the view.
    pub members_in_view: usize,
    /// Number of triangles drawn.
    pub triangles: usize,
    /// Number of members drawn as impostors.
    pub impostors: usize,
    /// Number of triangles of all members in view at full detail.
    pub full_triangles: usize,
    /// Number of members that look different from the frame before because their level changed.
    pub switches: usize,
    pub simulation_ms: f64,
    pub selection_ms: f64,
    /// `None` if no picture was drawn.
    pub draw_ms: Option<f64>,
}

/// Figures of all frames.
#[derive(Clone, Debug, Default)]
pub struct Figures {
    pub frames: Vec<FrameFigures>,
}

impl Figures {
    /// Returns one JSON object a line, one line a frame.
    pub fn lines(&self) -> String {
        self.frames.iter().map(|frame| format!("{}\n", json!(frame))).collect()
    }

    /// Returns the mean of a figure over the frames.
    pub fn mean(&self, figure: impl Fn(&FrameFigures) -> f64) -> f64 {
        self.frames.iter().map(figure).sum::<f64>() / self.frames.len().max(1) as f64
    }

    /// Returns the sum of a figure over the frames.
    pub fn total(&self, figure: impl Fn(&FrameFigures) -> usize) -> usize {
        self.frames.iter().map(figure).sum()
    }

    /// Returns the share of full detail that is drawn; `None` if no member is ever in view.
    pub fn share(&self) -> Option<f64> {
        let full = self.total(|frame| frame.full_triangles);
        (full > 0).then(|| self.total(|frame| frame.triangles) as f64 / full as f64)
    }

    /// Returns how often a member in view changes its level in a second.
    pub fn switches_per_member_second(&self, fps: f64) -> f64 {
        let later = self.frames.iter().skip(1);
        let members: usize = later.map(|frame| frame.members_in_view).sum();
        self.total(|frame| frame.switches) as f64 * fps / members.max(1) as f64
    }
}

/// Counts the members that are drawn in both frames, and differently.
pub fn switches(table: &LevelTable, before: &[InstanceLevel], now: &[InstanceLevel]) -> usize {
    let shown = |level: &InstanceLevel| level.appearance(table);
    let differ = |(a, b)| matches!((shown(a), shown(b)), (Some(a), Some(b)) if a != b);
    before.iter().zip(now).filter(|&pair| differ(pair)).count()
}
