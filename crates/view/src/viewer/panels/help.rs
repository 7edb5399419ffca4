//! Keys and mouse, listed over the picture.

use egui::{Align2, Grid, RichText, Window};

use crate::viewer::input::{BINDINGS, MOUSE_HELP};
use crate::viewer::state::ViewerState;
use crate::viewer::theme;

pub(crate) fn show(state: &mut ViewerState, ctx: &egui::Context) {
    let mut is_open = state.has_help;
    Window::new("Keys and mouse")
        .open(&mut is_open)
        .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
        .collapsible(false)
        .resizable(false)
        .show(ctx, |ui| {
            let mouse = MOUSE_HELP.iter().map(|[keys, help]| (*keys, *help));
            let keys = BINDINGS.iter().map(|binding| (binding.keys, binding.help));
            Grid::new("help").num_columns(2).spacing([28.0, 7.0]).show(ui, |ui| {
                for (keys, help) in mouse.chain(keys.filter(|(keys, _)| !keys.is_empty())) {
                    ui.label(RichText::new(keys).strong().color(theme::STRONG));
                    ui.label(help);
                    ui.end_row();
                }
            });
        });
    state.has_help = is_open;
}
