//! Marks over the picture: findings, the focus, the frozen camera.

use egui::{Color32, Painter, Pos2, Rect, Stroke, pos2};
use meshlod::picture::Camera;

use super::document::{CutControl, Document, FocusKind};
use super::theme;
use crate::stage::Stage;

/// Slot of the picture on the screen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SlotView<'s> {
    pub stage: &'s Stage,
    pub rect: Rect,
    pub pixels_per_point: f32,
}

impl SlotView<'_> {
    /// Returns where a point of the world is on the screen.
    pub fn at(&self, point: [f64; 3]) -> Option<Pos2> {
        let scale = self.pixels_per_point;
        let size = [self.rect.width(), self.rect.height()].map(|x| (x * scale).round() as u32);
        let [x, y] = self.stage.project(point, size)?;
        let at = pos2(self.rect.left() + x / scale, self.rect.top() + y / scale);
        self.rect.expand(2000.0).contains(at).then_some(at)
    }

    fn line(&self, painter: &Painter, points: &[[f64; 3]], stroke: Stroke) {
        for pair in points.windows(2) {
            if let [Some(a), Some(b)] = [self.at(pair[0]), self.at(pair[1])] {
                painter.line_segment([a, b], stroke);
            }
        }
    }
}

/// Draws the marks of a document over a slot.
pub(crate) fn draw(painter: &Painter, view: SlotView<'_>, document: &Document) {
    let painter = painter.with_clip_rect(view.rect);
    findings(&painter, view, document);
    if let Some(cut) = &document.cut {
        focus(&painter, view, cut, document.loaded.bounds.diagonal());
        if let Some(camera) = &cut.frozen {
            frustum(&painter, view, camera, document.loaded.bounds.diagonal() * 0.15);
        }
    }
}

fn findings(painter: &Painter, view: SlotView<'_>, document: &Document) {
    let found = &document.findings;
    let Some(report) = &found.report else { return };
    for (i, (finding, place)) in report.findings.iter().zip(&found.places).enumerate() {
        let is_selected = found.selected == Some(i);
        let is_listed = found.unfolded == Some(finding.kind());
        if !is_selected && !is_listed {
            continue;
        }
        let Some(at) = place.and_then(|place| view.at(place)) else { continue };
        let color = severity_color(finding.kind().severity());
        painter.circle(at, 3.0, color, Stroke::new(1.0, Color32::from_black_alpha(140)));
        if is_selected {
            painter.circle_stroke(at, 11.0, Stroke::new(2.0, Color32::WHITE));
            painter.circle_stroke(at, 13.0, Stroke::new(1.5, color));
        }
    }
}

/// Returns the colour of a severity.
pub(crate) fn severity_color(severity: meshlod::check::Severity) -> Color32 {
    match severity {
        meshlod::check::Severity::Error => theme::ERROR,
        meshlod::check::Severity::Warning => theme::WARNING,
    }
}

fn focus(painter: &Painter, view: SlotView<'_>, cut: &CutControl, diagonal: f64) {
    let stroke = Stroke::new(1.5, theme::ACCENT);
    let (center, radius) = (cut.center, cut.radius * diagonal);
    match cut.focus {
        FocusKind::Everything | FocusKind::View => {}
        FocusKind::Point => {
            if let Some(at) = view.at(center) {
                painter.circle(at, 4.0, theme::ACCENT, Stroke::new(1.5, Color32::WHITE));
            }
        }
        FocusKind::Sphere => {
            for axis in 0..3 {
                view.line(painter, &circle(center, radius, axis), stroke);
            }
        }
        FocusKind::Box => {
            let corner = |i: usize| {
                [0, 1, 2].map(|k| center[k] + if i >> k & 1 == 0 { -radius } else { radius })
            };
            for (a, axis) in (0..8).flat_map(|a| (0..3).map(move |axis| (a, axis))) {
                if a >> axis & 1 == 0 {
                    view.line(painter, &[corner(a), corner(a | 1 << axis)], stroke);
                }
            }
        }
    }
}

/// Returns a circle around a point, in the plane across an axis.
fn circle(center: [f64; 3], radius: f64, axis: usize) -> Vec<[f64; 3]> {
    const PARTS: u32 = 64;
    let point = |i: u32| {
        let (sin, cos) = (f64::from(i) / f64::from(PARTS) * std::f64::consts::TAU).sin_cos();
        let mut at = center;
        at[(axis + 1) % 3] += radius * cos;
        at[(axis + 2) % 3] += radius * sin;
        at
    };
    (0..=PARTS).map(point).collect()
}

/// Draws the pyramid of a camera up to a depth in model units.
fn frustum(painter: &Painter, view: SlotView<'_>, camera: &Camera, depth: f64) {
    let stroke = Stroke::new(1.5, theme::WARNING);
    let ([right, up, forward], eye) = (camera.axes(), camera.eye());
    let reach = camera.tan_half_fov() * depth;
    let aspect = f64::from(view.rect.aspect_ratio().max(0.01));
    let (wide, high) = (reach * aspect.max(1.0), reach * (1.0 / aspect).max(1.0));
    let corner = |x: f64, y: f64| {
        [0, 1, 2].map(|k| eye[k] + forward[k] * depth + right[k] * x * wide + up[k] * y * high)
    };
    let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    for i in 0..4 {
        view.line(painter, &[eye, corners[i], corners[(i + 1) % 4]], stroke);
    }
}
