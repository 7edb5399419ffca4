//! Settings of the display: shading, colours, ground, axes.

use egui::Ui;
use meshlod::picture::UpAxis;

use super::widgets::{choices, section};
use crate::stage::{Coloring, Shading};
use crate::viewer::action::Action;
use crate::viewer::state::ViewerState;

pub(super) fn show(state: &mut ViewerState, ui: &mut Ui, out: &mut Vec<Action>) {
    section(ui, "Display", true, |ui| {
        let display = &mut state.stage.display;
        let shadings = [(Shading::Smooth, "Smooth"), (Shading::Flat, "Flat")];
        ui.horizontal(|ui| {
            if let Some(shading) = choices(ui, display.shading, &shadings) {
                display.shading = shading;
            }
            ui.add_space(6.0);
            ui.checkbox(&mut display.wireframe, "Wireframe").on_hover_text("Shift Z");
        });
        ui.horizontal(|ui| {
            ui.label("Colours");
            egui::ComboBox::from_id_salt("coloring")
                .selected_text(display.coloring.name())
                .show_ui(ui, |ui| {
                    for coloring in Coloring::ALL {
                        ui.selectable_value(&mut display.coloring, coloring, coloring.name());
                    }
                });
        });
        ui.checkbox(&mut display.back_faces, "Mark back faces")
            .on_hover_text("Faces seen from behind are red");
        ui.checkbox(&mut display.ground, "Shadow on the ground");
        ui.checkbox(&mut display.is_dark, "Dark background");
        ui.horizontal(|ui| {
            ui.label("Up");
            let axes = [(UpAxis::Y, "Y"), (UpAxis::Z, "Z")];
            if let Some(up) = choices(ui, state.stage.rig.up(), &axes) {
                out.push(Action::SetUp(up));
            }
            ui.add_space(6.0);
            let slider = egui::Slider::new(&mut state.settings.fov_deg, 10.0..=100.0);
            ui.spacing_mut().slider_width = 74.0;
            if ui.add(slider.suffix("°").fixed_decimals(0)).on_hover_text("Field of view").changed()
            {
                state.stage.rig.set_fov_rad(state.settings.fov_deg.to_radians());
            }
        });
    });
}
