//! Simplification: method, target, and the resulting level.

use egui::{ComboBox, Slider, Ui};
use meshlod::Method;

use super::widgets::{choices, grouped, length, progress, row, section, wide_button};
use crate::viewer::action::Action;
use crate::viewer::document::{DocumentLevel, LevelGoal, LevelOrder};
use crate::viewer::jobs::JobKind;
use crate::viewer::state::ViewerState;
use crate::viewer::theme;

pub(super) fn show(state: &mut ViewerState, ui: &mut Ui, out: &mut Vec<Action>) {
    if state.document().is_none() {
        return;
    }
    section(ui, "Simplify", true, |ui| {
        if let Some(document) = state.documents.get_mut(state.active) {
            let faces = document.loaded.mesh.faces.len();
            if order(&mut document.order, faces, ui) {
                out.push(Action::Simplify);
            }
        }
        if !progress(state, ui, JobKind::Simplify, out) && wide_button(ui, "Simplify", true) {
            out.push(Action::Simplify);
        }
        let Some(document) = state.document() else { return };
        if let Some(level) = &document.level {
            ui.add_space(4.0);
            result(level, document.loaded.bounds.diagonal(), ui);
            let is_measured = level.distance.is_some();
            if !progress(state, ui, JobKind::Compare, out)
                && !is_measured
                && wide_button(ui, "Measure the distance", false)
            {
                out.push(Action::Compare);
            }
        }
    });
}

/// Shows the settings; returns true when a slider was let go, so that the level follows.
fn order(order: &mut LevelOrder, faces: usize, ui: &mut Ui) -> bool {
    ui.horizontal(|ui| {
        ui.label("Method");
        ComboBox::from_id_salt("method").selected_text(order.method.name()).show_ui(ui, |ui| {
            for method in Method::ALL {
                ui.selectable_value(&mut order.method, method, method.name());
            }
        });
    });
    let goals =
        [(LevelGoal::Faces, "Faces"), (LevelGoal::Error, "Error"), (LevelGoal::Pixels, "Pixels")];
    if let Some(goal) = choices(ui, order.goal, &goals) {
        order.goal = goal;
    }
    let slider = match order.goal {
        LevelGoal::Faces => Slider::new(&mut order.faces, 4..=faces.max(5)).logarithmic(true),
        LevelGoal::Error => Slider::new(&mut order.error_percent, 0.001..=5.0)
            .logarithmic(true)
            .suffix(" %")
            .custom_formatter(|percent, _| format!("{percent:.3}")),
        LevelGoal::Pixels => Slider::new(&mut order.pixels, 0.1..=20.0)
            .logarithmic(true)
            .suffix(" px")
            .custom_formatter(|pixels, _| format!("{pixels:.1}")),
    };
    let slider = ui.add(slider).on_hover_text(match order.goal {
        LevelGoal::Faces => "Number of faces",
        LevelGoal::Error => "Largest error, in percent of the diagonal",
        LevelGoal::Pixels => "Largest error on the screen, at the distance of this view",
    });
    slider.drag_stopped()
}

fn result(level: &DocumentLevel, diagonal: f64, ui: &mut Ui) {
    row(ui, "Level", format!("{} faces", grouped(level.loaded.mesh.faces.len())));
    row(ui, "Made in", format!("{:.2} s by {}", level.seconds, level.method.name()));
    row(ui, "Estimated error", with_percent(level.error_estimate, diagonal));
    if let Some(distance) = level.distance {
        row(ui, "Greatest distance", with_percent(distance.greatest, diagonal));
        row(ui, "RMS distance", with_percent(distance.rms, diagonal));
    }
    if !level.reached {
        let text = "The target is out of reach: this is as far as the method goes.";
        ui.colored_label(theme::WARNING, text);
    }
}

fn with_percent(value: f64, diagonal: f64) -> String {
    if diagonal <= 0.0 {
        return length(value);
    }
    format!("{} ({:.3} %)", length(value), 100.0 * value / diagonal)
}
