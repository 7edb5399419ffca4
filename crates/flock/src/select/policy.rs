//! Contract between a selector and its policy.

use crate::select::{InstanceLevel, View};

/// Rule by which the members of a flock get their levels.
pub trait Policy: Send {
    /// Chooses a level for every member of the view.
    ///
    /// `levels` has an entry for every member, with its level of the frame before, or
    /// [`InstanceLevel::HIDDEN`] for a new member; one that was an impostor counts as new.
    fn select(&mut self, view: &View<'_>, levels: &mut [InstanceLevel]);
}
