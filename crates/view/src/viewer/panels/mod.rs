//! Panels around the picture.

mod display;
mod file;
mod findings;
pub(crate) mod help;
mod level;
mod levels;
mod status;
mod tabs;
mod widgets;

use egui::{Frame, Margin, Panel, ScrollArea, Ui};

pub(crate) use self::widgets::{grouped, row, section};
use super::action::Action;
use super::state::ViewerState;
use super::theme;

/// Width of the side panel, in points.
const WIDTH: f32 = 292.0;

/// Shows all panels, and returns the actions that they request.
pub(crate) fn show(state: &mut ViewerState, ui: &mut Ui) -> Vec<Action> {
    let mut actions = Vec::new();
    let bar = Frame::new().fill(theme::PANEL).inner_margin(Margin::symmetric(12, 6));
    Panel::top("tabs").frame(bar).show(ui, |ui| tabs::show(state, ui, &mut actions));
    Panel::bottom("status").frame(bar).show(ui, |ui| status::show(state, ui, &mut actions));
    if state.settings.has_panel && state.flight.is_none() {
        let frame = Frame::new().fill(theme::PANEL).inner_margin(Margin {
            left: 14,
            right: 10,
            top: 10,
            bottom: 10,
        });
        let panel = Panel::right("panel").frame(frame).exact_size(WIDTH).resizable(false);
        panel.show(ui, |ui| {
            ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
                // The scroll bar floats over the edge.
                ui.set_max_width(WIDTH - 40.0);
                file::show(state, ui);
                display::show(state, ui, &mut actions);
                levels::show(state, ui, &mut actions);
                level::show(state, ui, &mut actions);
                findings::show(state, ui, &mut actions);
            });
        });
    }
    actions
}
