//! Bottom bar: size of the picture's subjects, running jobs, messages.

use egui::{Align, Layout, RichText, Ui};

use super::widgets::{bytes, grouped};
use crate::viewer::action::Action;
use crate::viewer::state::ViewerState;
use crate::viewer::theme;

pub(super) fn show(state: &ViewerState, ui: &mut Ui, out: &mut Vec<Action>) {
    ui.horizontal(|ui| {
        let small = |text: String, color| RichText::new(text).size(12.0).color(color);
        let shown: Vec<_> = state.stage.shown().filter_map(|id| state.stage.subject(id)).collect();
        if !shown.is_empty() {
            let faces = shown.iter().map(|subject| subject.faces()).sum();
            let vertices = shown.iter().map(|subject| subject.vertices()).sum();
            let size = shown.iter().map(|subject| subject.bytes()).sum();
            ui.label(small(format!("{} faces", grouped(faces)), theme::STRONG));
            ui.label(small(format!("{} vertices", grouped(vertices)), theme::WEAK));
            ui.label(small(format!("{} on the GPU", bytes(size)), theme::WEAK));
            if let Some(ms) = state.times.recent_ms() {
                ui.label(small(format!("{ms:.1} ms a frame"), theme::WEAK));
            }
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if let Some(job) = state.jobs.running().next() {
                if ui.small_button("Cancel").clicked() {
                    out.push(Action::Cancel(job.kind));
                }
                let share = job.watch.share().map(|share| format!(" {:.0} %", 100.0 * share));
                let text = format!("{}{}", job.label, share.unwrap_or_default());
                ui.label(small(text, theme::STRONG));
            } else if let Some(notice) = state.notices.last() {
                let color = if notice.is_problem { theme::ERROR } else { theme::STRONG };
                ui.add(egui::Label::new(small(notice.text.clone(), color)).truncate());
            } else {
                ui.label(small(state.renderers.full.gpu().name().to_owned(), theme::WEAK));
            }
        });
    });
}
