//! Settings that the panel changes and every frame obeys.

use meshlod::flock::select::{Budget, PolicyName};

use crate::SchoolShow;

/// Settings of the window, which outlive its scenes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Controls {
    pub policy: PolicyName,
    /// Most triangles a frame, for policies with a budget.
    pub triangles: usize,
    /// Fineness of the other policies; 2 keeps detail to twice the distance.
    pub detail: f32,
    pub has_impostors: bool,
    /// Size below which members are impostors, in pixels of a body length.
    pub impostors_px: f32,
    pub is_split: bool,
    /// Part of the width that shows levels while the picture is split.
    pub split: f32,
    pub is_paused: bool,
    pub has_panel: bool,
    pub has_graphs: bool,
    pub has_help: bool,
}

impl Controls {
    pub fn new(policy: PolicyName, triangles: usize) -> Self {
        Self {
            policy,
            triangles,
            detail: 1.0,
            has_impostors: false,
            impostors_px: 24.0,
            is_split: false,
            split: 0.5,
            is_paused: false,
            has_panel: true,
            has_graphs: true,
            has_help: false,
        }
    }

    /// Sets a show to these settings.
    pub fn apply(&self, show: &mut SchoolShow) {
        show.set_policy(self.policy);
        show.budget = Budget {
            triangles: self.triangles,
            detail: self.detail,
            impostors_below_px: self.has_impostors.then_some(self.impostors_px),
        };
        show.split = self.is_split.then_some(self.split);
        show.is_paused = self.is_paused;
        show.is_live = true;
    }
}
