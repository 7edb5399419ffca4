//! Look of the panels: dark, quiet, with one accent colour.

use egui::{Color32, CornerRadius, FontId, Margin, Stroke, TextStyle, Vec2};

/// Background of panels.
pub(crate) const PANEL: Color32 = Color32::from_rgb(30, 32, 36);
/// Background of fields and buttons.
const FIELD: Color32 = Color32::from_rgb(44, 47, 53);
const FIELD_HOVERED: Color32 = Color32::from_rgb(56, 60, 68);
const LINE: Color32 = Color32::from_rgb(48, 51, 57);
/// Colour of selected and active items.
pub(crate) const ACCENT: Color32 = Color32::from_rgb(88, 146, 232);
const TEXT: Color32 = Color32::from_rgb(206, 210, 217);
/// Colour of headings and values.
pub(crate) const STRONG: Color32 = Color32::from_rgb(238, 240, 244);
/// Colour of labels and units.
pub(crate) const WEAK: Color32 = Color32::from_rgb(140, 146, 156);
pub(crate) const WARNING: Color32 = Color32::from_rgb(232, 178, 92);
pub(crate) const ERROR: Color32 = Color32::from_rgb(232, 104, 96);

/// Gives a context the look of the viewer.
pub(crate) fn apply(ctx: &egui::Context) {
    ctx.set_theme(egui::Theme::Dark);
    ctx.style_mut_of(egui::Theme::Dark, |style| {
        style.visuals = visuals();
        style.spacing.item_spacing = Vec2::new(8.0, 6.0);
        style.spacing.button_padding = Vec2::new(9.0, 4.0);
        style.spacing.interact_size = Vec2::new(36.0, 22.0);
        style.spacing.slider_width = 150.0;
        style.spacing.slider_rail_height = 4.0;
        style.spacing.combo_width = 150.0;
        style.spacing.window_margin = Margin::same(14);
        style.spacing.menu_margin = Margin::same(8);
        let sizes = [
            (TextStyle::Small, 11.0),
            (TextStyle::Body, 13.0),
            (TextStyle::Button, 13.0),
            (TextStyle::Heading, 15.0),
        ];
        for (name, size) in sizes {
            style.text_styles.insert(name, FontId::proportional(size));
        }
        style.text_styles.insert(TextStyle::Monospace, FontId::monospace(12.5));
    });
}

fn visuals() -> egui::Visuals {
    let mut visuals = egui::Visuals::dark();
    visuals.panel_fill = PANEL;
    visuals.window_fill = Color32::from_rgb(36, 38, 43);
    visuals.window_stroke = Stroke::new(1.0, LINE);
    visuals.window_corner_radius = CornerRadius::same(10);
    visuals.menu_corner_radius = CornerRadius::same(8);
    visuals.extreme_bg_color = Color32::from_rgb(22, 24, 27);
    visuals.faint_bg_color = Color32::from_rgb(35, 37, 42);
    visuals.override_text_color = None;
    visuals.weak_text_color = Some(WEAK);
    visuals.warn_fg_color = WARNING;
    visuals.error_fg_color = ERROR;
    visuals.hyperlink_color = ACCENT;
    visuals.selection.bg_fill = Color32::from_rgb(48, 82, 132);
    visuals.selection.stroke = Stroke::new(1.0, STRONG);
    visuals.slider_trailing_fill = true;
    let widgets = &mut visuals.widgets;
    let states = [
        (&mut widgets.noninteractive, PANEL, TEXT),
        (&mut widgets.inactive, FIELD, TEXT),
        (&mut widgets.hovered, FIELD_HOVERED, STRONG),
        (&mut widgets.active, Color32::from_rgb(62, 68, 78), STRONG),
        (&mut widgets.open, FIELD_HOVERED, STRONG),
    ];
    for (state, fill, text) in states {
        state.bg_fill = fill;
        state.weak_bg_fill = fill;
        state.bg_stroke = Stroke::NONE;
        state.fg_stroke = Stroke::new(1.0, text);
        state.corner_radius = CornerRadius::same(6);
        state.expansion = 0.0;
    }
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, LINE);
    visuals
}
