//! The picture in the middle of the window, and the pointer over it.

use egui::{Align2, Color32, FontId, PointerButton, Rect, Response, Sense, Ui, Vec2, pos2};

use super::document::ShownSide;
use super::input::{DragAction, drag_action, flight};
use super::overlay::{self, SlotView};
use super::state::ViewerState;
use super::theme;

/// Radians of turn per point of a drag: once across a window turns around.
pub(crate) const TURN_PER_POINT: f64 = 0.007;
/// Factor of the distance per point of scrolling.
pub(crate) const ZOOM_PER_POINT: f64 = 0.0022;
/// Factor of the distance per point of a zooming drag.
pub(crate) const DRAG_ZOOM_PER_POINT: f64 = 0.008;
/// Radians per point that the pointer moves in a flight.
const LOOK_PER_POINT: f64 = 0.003;

impl ViewerState {
    /// Shows the picture in the space between the panels.
    pub fn show_center(&mut self, ui: &mut Ui) {
        egui::CentralPanel::no_frame().show(ui, |ui| {
            let rect = ui.available_rect_before_wrap();
            let response = ui.allocate_rect(rect, Sense::click_and_drag());
            let scale = ui.ctx().pixels_per_point();
            self.size = [rect.width(), rect.height()].map(|x| (x * scale).round().max(0.0) as u32);
            self.take_pointer(ui, &response);
            self.show_picture(ui, rect);
            if self.documents.is_empty() {
                self.show_welcome(ui, rect);
            } else {
                self.show_marks(ui, rect, scale);
            }
        });
    }

    fn show_picture(&mut self, ui: &Ui, rect: Rect) {
        let limit = self.renderers.full.gpu().device.limits().max_texture_dimension_2d;
        let size = self.size.map(|side| side.min(limit));
        let drawn = self.pane.draw(
            &mut self.stage,
            &self.renderers,
            &self.render_state,
            size,
            self.changes,
        );
        if self.pane.is_draft() {
            ui.ctx().request_repaint();
        }
        match drawn {
            Ok(Some(texture)) => {
                let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
                ui.painter().image(texture, rect, whole, Color32::WHITE);
                if self.stage.shown().next().is_some() {
                    self.note_first_picture(ui.ctx());
                }
            }
            Ok(None) => {}
            Err(error) => {
                let text = error.to_string();
                if self.problems.last() != Some(&text) {
                    self.complain(text);
                }
            }
        }
    }

    /// The frame that follows the one with the first picture notes its time.
    fn note_first_picture(&mut self, ctx: &egui::Context) {
        if self.times.first_picture_ms.is_none() {
            if std::mem::replace(&mut self.has_drawn, true) {
                self.times.picture_shown();
            } else {
                ctx.request_repaint();
            }
        }
    }

    fn show_welcome(&self, ui: &Ui, rect: Rect) {
        let is_opening = self.jobs.running().next().is_some();
        let (title, hint) = match is_opening {
            true => ("Opening…", ""),
            false => ("Drop a file here", "meshes, .mlod, .mlq, .mlz — press ? for the keys"),
        };
        let painter = ui.painter();
        let at = rect.center();
        let font = FontId::proportional(20.0);
        painter.text(at, Align2::CENTER_BOTTOM, title, font, theme::STRONG);
        let below = at + Vec2::new(0.0, 10.0);
        painter.text(below, Align2::CENTER_TOP, hint, FontId::proportional(13.0), theme::WEAK);
    }

    fn show_marks(&self, ui: &Ui, rect: Rect, pixels_per_point: f32) {
        let Some(document) = self.document() else { return };
        let slots = self.stage.shown().count().max(1);
        let width = rect.width() / slots as f32;
        for slot in 0..slots {
            let left = rect.left() + width * slot as f32;
            let min = pos2(left, rect.top());
            let slot_rect = Rect::from_min_size(min, Vec2::new(width, rect.height()));
            let view = SlotView { stage: &self.stage, rect: slot_rect, pixels_per_point };
            overlay::draw(ui.painter(), view, document);
            if slot > 0 {
                let line = egui::Stroke::new(1.0, Color32::from_black_alpha(110));
                ui.painter().vline(left, rect.y_range(), line);
            }
            if slots > 1 {
                self.show_caption(ui, slot_rect, slot);
            }
        }
        self.show_flight(ui, rect);
    }

    fn show_caption(&self, ui: &Ui, rect: Rect, slot: usize) {
        let Some(document) = self.document() else { return };
        let Some(subject) = self.stage.shown().nth(slot).and_then(|id| self.stage.subject(id))
        else {
            return;
        };
        let name = match (document.mode, slot) {
            (ShownSide::Both, 0) => "Original",
            _ => "Level",
        };
        let text = format!("{name}   {} faces", super::panels::grouped(subject.faces()));
        tag(ui, rect.left_top() + Vec2::new(12.0, 12.0), &text);
    }

    fn show_flight(&self, ui: &Ui, rect: Rect) {
        if self.flight.is_some() {
            let at = rect.left_top() + Vec2::new(12.0, 12.0);
            tag(ui, at, "Flying: W A S D, Q E, mouse to look, wheel for speed, Esc to stop");
        }
    }

    fn take_pointer(&mut self, ui: &Ui, response: &Response) {
        let modifiers = ui.input(|input| input.modifiers);
        let shorter = f64::from(response.rect.size().min_elem().max(1.0));
        for button in [PointerButton::Primary, PointerButton::Middle, PointerButton::Secondary] {
            if !response.dragged_by(button) {
                continue;
            }
            let [x, y] = <[f32; 2]>::from(response.drag_delta()).map(f64::from);
            if [x, y] == [0.0; 2] {
                continue;
            }
            match drag_action(button, modifiers) {
                Some(DragAction::Orbit) => {
                    self.stage.rig.orbit(x * TURN_PER_POINT, y * TURN_PER_POINT);
                }
                Some(DragAction::Pan) => self.stage.rig.pan([x, y], shorter),
                Some(DragAction::Zoom) => {
                    self.stage.rig.zoom((y * DRAG_ZOOM_PER_POINT).exp(), [0.0; 2]);
                }
                None => {}
            }
        }
        if response.double_clicked() {
            self.frame_all();
        }
        if response.contains_pointer() && self.flight.is_none() {
            self.take_wheel(ui, response, shorter);
        }
    }

    fn take_wheel(&mut self, ui: &Ui, response: &Response, shorter: f64) {
        let (scroll, pinch) = ui.input(|input| {
            (f64::from(input.smooth_scroll_delta().y), f64::from(input.zoom_delta()))
        });
        if scroll == 0.0 && pinch == 1.0 {
            return;
        }
        let factor = (-scroll * ZOOM_PER_POINT).exp() / pinch;
        let slots = self.stage.shown().count().max(1) as f32;
        let at = response.hover_pos().map_or([0.0; 2], |at| {
            let width = response.rect.width() / slots;
            let x = (at.x - response.rect.left()) % width - width / 2.0;
            let shorter = shorter.min(f64::from(width));
            [x, at.y - response.rect.center().y].map(|offset| 2.0 * f64::from(offset) / shorter)
        });
        self.stage.rig.zoom(factor, at);
    }

    /// Moves the camera of a flight. Returns true while there is one.
    pub fn fly(&mut self, ctx: &egui::Context, seconds: f64) -> bool {
        let Some(speed) = self.flight else { return false };
        let (motion, way, scroll, is_fast) = ctx.input(|input| {
            let motion = input.pointer.motion().unwrap_or(input.pointer.delta());
            let scroll = f64::from(input.smooth_scroll_delta().y);
            (motion, flight(input), scroll, input.modifiers.shift)
        });
        self.flight = Some((speed * (scroll * ZOOM_PER_POINT).exp()).clamp(1e-3, 10.0));
        let [x, y] = [motion.x, motion.y].map(f64::from);
        if motion != Vec2::ZERO {
            self.stage.rig.look(x * LOOK_PER_POINT, -y * LOOK_PER_POINT);
        }
        let step =
            speed * seconds * self.stage.bounds().diagonal() * if is_fast { 4.0 } else { 1.0 };
        if way != [0.0; 3] {
            self.stage.rig.travel(way.map(|part| part * step));
        }
        true
    }
}

/// Draws a line of text on a dark rounded ground.
pub(crate) fn tag(ui: &Ui, at: egui::Pos2, text: &str) {
    let font = FontId::proportional(12.5);
    let text = ui.painter().layout_no_wrap(text.to_owned(), font, theme::STRONG);
    let margin = Vec2::new(9.0, 5.0);
    let ground = Rect::from_min_size(at, text.size() + 2.0 * margin);
    ui.painter().rect_filled(ground, 6.0, Color32::from_black_alpha(130));
    ui.painter().galley(at + margin, text, theme::STRONG);
}
