//! Requests of panels.

use meshlod::picture::UpAxis;

use super::document::ShownSide;
use super::input::Command;
use super::jobs::JobKind;

/// Request of a panel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Action {
    Do(Command),
    Activate(usize),
    Close(usize),
    Show(ShownSide),
    Simplify,
    Compare,
    Check,
    Cancel(JobKind),
    SelectFinding(usize),
    SetUp(UpAxis),
    ToggleFrozen,
}
