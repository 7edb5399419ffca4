//! Levels of detail of a multiresolution file: the query that the cut follows.

use egui::{ComboBox, Slider, Ui};

use super::widgets::{choices, grouped, row, section};
use crate::stage::Subject;
use crate::viewer::action::Action;
use crate::viewer::document::{CutControl, FocusKind, LevelGoal};
use crate::viewer::state::ViewerState;

pub(super) fn show(state: &mut ViewerState, ui: &mut Ui, out: &mut Vec<Action>) {
    let Some(document) = state.documents.get_mut(state.active) else { return };
    let subject = state.stage.subject(document.original);
    let Some(Subject::Levels(levels)) = subject else { return };
    let (bounds, full) = (document.loaded.bounds, document.loaded.mesh.faces.len());
    let Some(cut) = &mut document.cut else { return };
    section(ui, "Level of detail", true, |ui| {
        tolerance(cut, full, ui);
        focus(cut, &bounds, ui);
        let mut is_frozen = cut.frozen.is_some();
        if ui
            .checkbox(&mut is_frozen, "Freeze the camera")
            .on_hover_text(
                "The cut keeps following this view while you look at it from outside (C)",
            )
            .clicked()
        {
            out.push(Action::ToggleFrozen);
        }
        ui.checkbox(&mut cut.moves, "Geomorph")
            .on_hover_text("Vertices move to where the cut takes them, in a quarter of a second");
        ui.add_enabled_ui(!cut.moves, |ui| {
            ui.checkbox(&mut cut.dissolves, "Dissolve")
                .on_hover_text("Old triangles dissolve into new ones, pixel by pixel");
        });
        let step = levels.last_step();
        ui.add_space(4.0);
        let part = 100.0 * step.faces as f64 / full.max(1) as f64;
        row(ui, "Cut", format!("{} faces ({part:.1} %)", grouped(step.faces)));
        row(ui, "Last change", format!("{:.1} ms", step.milliseconds));
    });
}

fn tolerance(cut: &mut CutControl, full: usize, ui: &mut Ui) {
    let goals =
        [(LevelGoal::Pixels, "Pixels"), (LevelGoal::Error, "Error"), (LevelGoal::Faces, "Faces")];
    if let Some(goal) = choices(ui, cut.goal, &goals) {
        cut.goal = goal;
    }
    let slider = match cut.goal {
        LevelGoal::Pixels => Slider::new(&mut cut.pixels, 0.1..=50.0)
            .suffix(" px")
            .custom_formatter(|pixels, _| format!("{pixels:.1}")),
        LevelGoal::Faces => Slider::new(&mut cut.faces, 4..=full.max(5)),
        LevelGoal::Error => Slider::new(&mut cut.error_percent, 0.0005..=5.0)
            .suffix(" %")
            .custom_formatter(|percent, _| format!("{percent:.4}")),
    };
    ui.add(slider.logarithmic(true));
}

fn focus(cut: &mut CutControl, bounds: &meshlod::mesh::Bounds, ui: &mut Ui) {
    ui.horizontal(|ui| {
        ui.label("Focus");
        ComboBox::from_id_salt("focus").selected_text(cut.focus.name()).show_ui(ui, |ui| {
            for kind in FocusKind::ALL {
                ui.selectable_value(&mut cut.focus, kind, kind.name());
            }
        });
    });
    if matches!(cut.focus, FocusKind::Everything | FocusKind::View) {
        return;
    }
    let mut follows = !cut.is_held;
    ui.checkbox(&mut follows, "Follow the point in view");
    cut.is_held = !follows;
    if cut.is_held {
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let range = bounds.min[axis]..=bounds.max[axis];
            ui.add(Slider::new(&mut cut.center[axis], range).text(name));
        }
    }
    if cut.focus != FocusKind::Point {
        let slider = Slider::new(&mut cut.radius, 0.01..=0.5).text("radius");
        ui.add(slider.custom_formatter(|radius, _| format!("{radius:.2}")));
    }
}
