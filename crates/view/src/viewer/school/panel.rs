//! Bars and panels around the picture of a school.

use egui::{Align, Frame, Layout, Margin, Panel, RichText, ScrollArea, Slider, Ui};
use meshlod::flock::select::{Bias, PolicyName};
use meshlod_school::scene::ScenarioName;

use super::app::SchoolApp;
use super::{graphs, keys};
use crate::viewer::panels::{grouped, row, section};
use crate::viewer::theme;

/// Width of the side panel, in points.
const WIDTH: f32 = 276.0;

/// Shows everything around the picture.
pub(crate) fn show(app: &mut SchoolApp, ui: &mut Ui) {
    let bar = Frame::new().fill(theme::PANEL).inner_margin(Margin::symmetric(12, 6));
    Panel::top("scenes").frame(bar).show(ui, |ui| scenes(app, ui));
    if app.controls.has_graphs {
        Panel::bottom("graphs").frame(bar).show(ui, |ui| graphs::show(app, ui));
    }
    if app.controls.has_panel {
        let frame = Frame::new().fill(theme::PANEL).inner_margin(Margin::symmetric(14, 10));
        let panel = Panel::right("controls").frame(frame).exact_size(WIDTH).resizable(false);
        panel.show(ui, |ui| {
            ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
                ui.set_max_width(WIDTH - 40.0);
                section(ui, "Level of detail", true, |ui| policies(app, ui));
                section(ui, "View", true, |ui| view(app, ui));
                section(ui, "Frame", true, |ui| figures(app, ui));
            });
        });
    }
}

/// Shows the names of the scenes, and on the right the GPU or what is wrong.
fn scenes(app: &mut SchoolApp, ui: &mut Ui) {
    ui.horizontal(|ui| {
        ui.label(RichText::new("Scene").color(theme::WEAK));
        for name in ScenarioName::ALL {
            let title = capital(name.name());
            if ui.selectable_label(app.scene() == name, title).clicked() {
                app.switch_to(name, ui.ctx());
            }
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if ui.selectable_label(app.controls.has_help, "?").on_hover_text("Keys").clicked() {
                app.controls.has_help = !app.controls.has_help;
            }
            let line = match (app.notice(), &app.coming) {
                (Some(problem), _) => RichText::new(problem).color(theme::ERROR),
                (None, Some(_)) => RichText::new("Setting the scene…").color(theme::STRONG),
                (None, None) => RichText::new(app.renderer.gpu().name()).color(theme::WEAK),
            };
            ui.add(egui::Label::new(line.size(12.0)).truncate());
        });
    });
}

fn policies(app: &mut SchoolApp, ui: &mut Ui) {
    let controls = &mut app.controls;
    ui.spacing_mut().item_spacing.y = 2.0;
    let each = PolicyName::ALL.len().div_ceil(2);
    ui.columns(2, |columns| {
        for (ui, policies) in columns.iter_mut().zip(PolicyName::ALL.chunks(each)) {
            for &policy in policies {
                let label = ui.selectable_label(controls.policy == policy, policy.title());
                let hint = format!("Key {}", policy.key());
                if label.on_hover_text(hint).clicked() {
                    controls.policy = policy;
                }
            }
        }
    });
    ui.add_space(6.0);
    let text = |text: &str| RichText::new(text).color(theme::WEAK);
    ui.spacing_mut().slider_width = 118.0;
    match controls.policy.bias() {
        Bias::Nothing => {}
        Bias::Detail => {
            ui.label(text("Fineness"));
            ui.add(Slider::new(&mut controls.detail, 0.02..=50.0).logarithmic(true))
                .on_hover_text("2 keeps detail to twice the distance");
        }
        Bias::Triangles => {
            ui.label(text("Faces a frame, at most"));
            let most = app.full_faces.max(1_000);
            ui.add(Slider::new(&mut controls.triangles, 100..=most).logarithmic(true));
        }
    }
    ui.add_space(4.0);
    ui.checkbox(&mut controls.has_impostors, "Impostors if smaller than").on_hover_text("I");
    ui.add_enabled(
        controls.has_impostors,
        Slider::new(&mut controls.impostors_px, 2.0..=200.0)
            .logarithmic(true)
            .fixed_decimals(0)
            .suffix(" px"),
    );
}

fn view(app: &mut SchoolApp, ui: &mut Ui) {
    ui.horizontal(|ui| {
        ui.label("Camera");
        let is_orbit = app.orbit.is_some();
        let path = ui.selectable_label(!is_orbit, "Path").on_hover_text("C");
        let orbit = ui.selectable_label(is_orbit, "Orbit").on_hover_text("C, or drag the picture");
        if (path.clicked() && is_orbit) || (orbit.clicked() && !is_orbit) {
            app.toggle_orbit();
        }
    });
    let controls = &mut app.controls;
    ui.checkbox(&mut controls.is_paused, "Pause").on_hover_text("Space");
    ui.checkbox(&mut controls.is_split, "Split: full detail on the right").on_hover_text("S");
    ui.spacing_mut().slider_width = 118.0;
    let percent = |share: f64, _| format!("{:.0} %", 100.0 * share);
    let slider = Slider::new(&mut controls.split, 0.0..=1.0).custom_formatter(percent);
    ui.add_enabled(controls.is_split, slider);
    ui.checkbox(&mut controls.has_graphs, "Graphs").on_hover_text("G");
}

fn figures(app: &SchoolApp, ui: &mut Ui) {
    let Some(show) = &app.show else { return };
    let Some(frame) = show.history().last() else { return };
    let total = show.frame().map_or(0, |(flock, _)| flock.members.len());
    row(ui, "Members", grouped(total));
    row(ui, "In view", grouped(frame.members));
    row(ui, "Schools", grouped(show.scenario().simulation.schools.len()));
    row(ui, "Faces drawn", grouped(frame.triangles as usize));
    row(ui, "In full detail", grouped(frame.full_triangles as usize));
    let share = 100.0 * frame.triangles as f64 / frame.full_triangles.max(1) as f64;
    row(ui, "Share", format!("{share:.1} %"));
    if let Some(ms) = app.times.recent_ms() {
        row(ui, "Frame", format!("{ms:.1} ms"));
    }
    row(ui, "Selection", format!("{:.2} ms", frame.select_ms));
}

/// Shows keys and mouse over the picture.
pub(crate) fn help(app: &mut SchoolApp, ctx: &egui::Context) {
    egui::Window::new("Keys and mouse")
        .open(&mut app.controls.has_help)
        .anchor(egui::Align2::CENTER_CENTER, [0.0, 0.0])
        .collapsible(false)
        .resizable(false)
        .show(ctx, |ui| {
            egui::Grid::new("help").num_columns(2).spacing([28.0, 7.0]).show(ui, |ui| {
                for [keys, help] in keys::help() {
                    ui.label(RichText::new(keys).strong().color(theme::STRONG));
                    ui.label(help);
                    ui.end_row();
                }
            });
        });
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}
