//! The picture of the school, and the pointer over it.

use egui::{
    Align2, Color32, CursorIcon, FontId, PointerButton, Rect, Response, Sense, Ui, pos2, vec2,
};

use super::app::SchoolApp;
use super::drag;
use crate::viewer::central::{DRAG_ZOOM_PER_POINT, TURN_PER_POINT, ZOOM_PER_POINT, tag};
use crate::viewer::input::{DragAction, drag_action};
use crate::viewer::theme;

impl SchoolApp {
    /// Shows the picture in what panels have left, and takes the pointer over it.
    pub fn show_center(&mut self, ui: &mut Ui) {
        egui::CentralPanel::no_frame().show(ui, |ui| {
            let rect = ui.available_rect_before_wrap();
            let response = ui.allocate_rect(rect, Sense::click_and_drag());
            let limit = self.renderer.gpu().device.limits().max_texture_dimension_2d;
            let scale = ui.ctx().pixels_per_point();
            let pixels = |side: f32| ((side * scale).round().max(0.0) as u32).min(limit);
            self.size = [rect.width(), rect.height()].map(pixels);
            self.take_pointer(ui, &response);
            self.make_frame();
            match self.pane.texture() {
                Some(texture) if self.show.is_some() => {
                    let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
                    ui.painter().image(texture, rect, whole, Color32::WHITE);
                    self.show_split(ui, rect);
                }
                _ => {
                    let font = FontId::proportional(20.0);
                    let text = "Setting the scene…";
                    let at = rect.center();
                    ui.painter().text(at, Align2::CENTER_CENTER, text, font, theme::STRONG);
                }
            }
        });
    }

    /// Draws the line between both sides and names them.
    fn show_split(&self, ui: &Ui, rect: Rect) {
        let corner = rect.left_top() + vec2(12.0, 12.0);
        tag(ui, corner, self.controls.policy.title());
        if !self.controls.is_split {
            return;
        }
        let x = rect.left() + rect.width() * self.controls.split;
        let line = egui::Stroke::new(1.0, Color32::from_white_alpha(120));
        ui.painter().vline(x, rect.y_range(), line);
        if x + 110.0 < rect.right() {
            tag(ui, pos2(x + 12.0, corner.y), "Full detail");
        }
    }

    fn take_pointer(&mut self, ui: &Ui, response: &Response) {
        self.hold_obstacle(ui, response);
        if self.held.is_none() {
            self.turn_camera(ui, response);
        }
        let scroll = ui.input(|input| f64::from(input.smooth_scroll_delta().y));
        if response.contains_pointer() && scroll != 0.0 {
            self.start_orbit();
            if let Some(rig) = &mut self.orbit {
                rig.zoom((-scroll * ZOOM_PER_POINT).exp(), [0.0; 2]);
            }
        }
    }

    /// Grabs, moves and releases the obstacle under the pointer.
    fn hold_obstacle(&mut self, ui: &Ui, response: &Response) {
        let Some(show) = &mut self.show else { return };
        let Some((_, camera)) = show.frame() else { return };
        let camera = *camera;
        let under = |at: egui::Pos2| {
            let offset = at - response.rect.center();
            let half = response.rect.size() / 2.0;
            drag::pick(&camera, [offset.x / half.x, -offset.y / half.y], &show.scenario().obstacles)
        };
        if response.drag_started_by(PointerButton::Primary) {
            let pressed = ui.input(|input| input.pointer.press_origin());
            self.held = pressed.and_then(under);
        } else if !response.dragged_by(PointerButton::Primary) {
            self.held = None;
        }
        match self.held {
            Some(held) => {
                ui.ctx().set_cursor_icon(CursorIcon::Grabbing);
                let pixels = response.drag_delta() * ui.ctx().pixels_per_point();
                let by = drag::drag(&camera, held.depth, pixels.into());
                if by.length() > 0.0
                    && let Err(error) = show.move_obstacle(held.index, by)
                {
                    self.complain(error.to_string());
                }
            }
            None if response.hover_pos().and_then(under).is_some() => {
                ui.ctx().set_cursor_icon(CursorIcon::Grab);
            }
            None => {}
        }
    }

    fn turn_camera(&mut self, ui: &Ui, response: &Response) {
        let modifiers = ui.input(|input| input.modifiers);
        let shorter = f64::from(response.rect.size().min_elem().max(1.0));
        for button in [PointerButton::Primary, PointerButton::Middle, PointerButton::Secondary] {
            let [x, y] = <[f32; 2]>::from(response.drag_delta()).map(f64::from);
            if !response.dragged_by(button) || [x, y] == [0.0; 2] {
                continue;
            }
            self.start_orbit();
            let Some(rig) = &mut self.orbit else { return };
            match drag_action(button, modifiers) {
                Some(DragAction::Orbit) => rig.orbit(x * TURN_PER_POINT, y * TURN_PER_POINT),
                Some(DragAction::Pan) => rig.pan([x, y], shorter),
                Some(DragAction::Zoom) => rig.zoom((y * DRAG_ZOOM_PER_POINT).exp(), [0.0; 2]),
                None => {}
            }
        }
    }
}
