//! Top bar: the open files, and which side of the active one is shown.

use egui::{Align, Layout, RichText, Ui};

use super::widgets::choices;
use crate::viewer::action::Action;
use crate::viewer::document::ShownSide;
use crate::viewer::input::Command;
use crate::viewer::state::ViewerState;
use crate::viewer::theme;

pub(super) fn show(state: &ViewerState, ui: &mut Ui, out: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        if state.documents.is_empty() {
            ui.label(RichText::new("meshlod").color(theme::WEAK));
        }
        for (index, document) in state.documents.iter().enumerate() {
            let name = RichText::new(document.loaded.name());
            let tab = ui.selectable_label(state.active == index, name);
            let tab = tab.on_hover_text(document.loaded.path.display().to_string());
            if tab.clicked() {
                out.push(Action::Activate(index));
            }
            if tab.middle_clicked() {
                out.push(Action::Close(index));
            }
            tab.context_menu(|ui| {
                if ui.button("Close").clicked() {
                    out.push(Action::Close(index));
                }
            });
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let commands = [
                ("?", Command::ToggleHelp, "Keys and mouse"),
                ("Panel", Command::TogglePanel, "Show or hide the side panel (N)"),
            ];
            for (text, command, hint) in commands {
                if ui.button(text).on_hover_text(hint).clicked() {
                    out.push(Action::Do(command));
                }
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| sides(state, ui, out));
        });
    });
}

fn sides(state: &ViewerState, ui: &mut Ui, out: &mut Vec<Action>) {
    let Some(document) = state.document().filter(|document| document.has_sides()) else { return };
    ui.separator();
    let all = [
        (ShownSide::Original, "Original"),
        (ShownSide::Level, "Level"),
        (ShownSide::Both, "Side by side"),
    ];
    if let Some(side) = choices(ui, document.mode, &all) {
        out.push(Action::Show(side));
    }
}
