//! Widgets of panels, and formats of numbers.

use egui::{RichText, Ui};

use crate::viewer::action::Action;
use crate::viewer::jobs::JobKind;
use crate::viewer::state::ViewerState;
use crate::viewer::theme;

/// Shows a titled part of the side panel, which can be folded.
pub(crate) fn section(ui: &mut Ui, title: &str, is_open: bool, add: impl FnOnce(&mut Ui)) {
    ui.add_space(2.0);
    let title = RichText::new(title).strong().color(theme::STRONG);
    egui::CollapsingHeader::new(title).default_open(is_open).show_unindented(ui, |ui| {
        ui.add_space(2.0);
        add(ui);
        ui.add_space(6.0);
    });
    ui.separator();
}

/// Shows a name and its value in a row.
pub(crate) fn row(ui: &mut Ui, name: &str, value: impl Into<String>) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(name).color(theme::WEAK));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.label(RichText::new(value).color(theme::STRONG));
        });
    });
}

/// Draws a row of exclusive buttons; returns the one clicked.
pub(super) fn choices<T: Copy + PartialEq>(ui: &mut Ui, now: T, all: &[(T, &str)]) -> Option<T> {
    let mut clicked = None;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for &(value, name) in all {
            if ui.selectable_label(now == value, name).clicked() {
                clicked = Some(value);
            }
        }
    });
    clicked
}

/// Formats a number with groups of three digits.
pub(crate) fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// Formats a size in bytes.
pub(super) fn bytes(count: u64) -> String {
    match count {
        0..1_000 => format!("{count} B"),
        1_000..1_000_000 => format!("{:.1} kB", count as f64 / 1e3),
        1_000_000..1_000_000_000 => format!("{:.1} MB", count as f64 / 1e6),
        _ => format!("{:.2} GB", count as f64 / 1e9),
    }
}

/// Formats a length with four digits.
pub(super) fn length(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        1e-3..1e5 => {
            let digits = (3 - value.abs().log10().floor() as i32).clamp(0, 6) as usize;
            format!("{value:.digits$}")
        }
        _ => format!("{value:.3e}"),
    }
}

/// Shows a button across the panel; returns true if it was clicked.
pub(super) fn wide_button(ui: &mut Ui, text: &str, is_main: bool) -> bool {
    let mut button = egui::Button::new(text).min_size([ui.available_width(), 26.0].into());
    if is_main {
        button = button.fill(ui.visuals().selection.bg_fill);
    }
    ui.vertical_centered_justified(|ui| ui.add(button).clicked()).inner
}

/// Shows the progress of a job of a kind with a button that cancels it; returns false if no such
/// job runs.
pub(super) fn progress(
    state: &ViewerState,
    ui: &mut Ui,
    kind: JobKind,
    out: &mut Vec<Action>,
) -> bool {
    let Some(job) = state.jobs.running().find(|job| job.kind == kind) else { return false };
    ui.horizontal(|ui| {
        let width = ui.available_width() - 68.0;
        let bar = egui::ProgressBar::new(job.watch.share().unwrap_or(0.0)).desired_width(width);
        let text = match job.watch.share() {
            Some(share) => format!("{} {:.0} %", job.label, 100.0 * share),
            None => format!("{}…", job.label),
        };
        ui.add(bar.text(RichText::new(text).size(11.5)).desired_height(22.0));
        if ui.button("Cancel").clicked() {
            out.push(Action::Cancel(kind));
        }
    });
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_readable() {
        assert_eq!(grouped(1_234_567), "1\u{202f}234\u{202f}567");
        assert_eq!((grouped(0), grouped(999)), ("0".into(), "999".into()));
        assert_eq!((bytes(12), bytes(3_460_000)), ("12 B".into(), "3.5 MB".into()));
        assert_eq!(
            [length(0.0), length(1.5), length(0.0123), length(1e-9)],
            ["0", "1.500", "0.01230", "1.000e-9"]
        );
    }
}
