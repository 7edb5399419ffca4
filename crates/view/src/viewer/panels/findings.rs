//! Findings of the check: counted by kind, listed, clicked.

use egui::{RichText, ScrollArea, Ui};
use meshlod::check::{Finding, Kind, Objects};

use super::widgets::{grouped, progress, section, wide_button};
use crate::viewer::action::Action;
use crate::viewer::document::Findings;
use crate::viewer::jobs::JobKind;
use crate::viewer::overlay::severity_color;
use crate::viewer::state::ViewerState;
use crate::viewer::theme;

/// Height of the list of one kind, in points.
const LIST_HEIGHT: f32 = 180.0;

pub(super) fn show(state: &mut ViewerState, ui: &mut Ui, out: &mut Vec<Action>) {
    if state.document().is_none() {
        return;
    }
    section(ui, "Findings", true, |ui| {
        let is_checked =
            state.document().is_some_and(|document| document.findings.report.is_some());
        let is_running = progress(state, ui, JobKind::Check, out);
        if !is_checked {
            if !is_running && wide_button(ui, "Check the mesh", false) {
                out.push(Action::Check);
            }
            return;
        }
        if let Some(document) = state.documents.get_mut(state.active) {
            list(&mut document.findings, ui, out);
        }
    });
}

fn list(findings: &mut Findings, ui: &mut Ui, out: &mut Vec<Action>) {
    let Some(report) = &findings.report else { return };
    if report.is_clean() {
        ui.label(RichText::new("Nothing found.").color(theme::STRONG));
        return;
    }
    for (kind, count) in report.summary.found() {
        let is_unfolded = findings.unfolded == Some(kind);
        let response = ui.horizontal(|ui| {
            let (dot, _) = ui.allocate_exact_size([10.0, 10.0].into(), egui::Sense::hover());
            ui.painter().circle_filled(dot.center(), 4.0, severity_color(kind.severity()));
            let name = kind.name().replace('-', " ");
            let clicked = ui.selectable_label(is_unfolded, name).clicked();
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.label(RichText::new(grouped(count)).color(theme::STRONG));
            });
            clicked
        });
        if response.inner {
            findings.unfolded = if is_unfolded { None } else { Some(kind) };
        }
        if findings.unfolded == Some(kind) {
            of_kind(kind, findings.selected, report, count, ui, out);
        }
    }
}

fn of_kind(
    kind: Kind,
    selected: Option<usize>,
    report: &meshlod::jobs::CheckReport,
    count: usize,
    ui: &mut Ui,
    out: &mut Vec<Action>,
) {
    let listed = report.findings.iter().enumerate().filter(|(_, found)| found.kind() == kind);
    let listed: Vec<(usize, &Finding)> = listed.collect();
    let area = ScrollArea::vertical().id_salt(kind.name()).max_height(LIST_HEIGHT);
    area.auto_shrink([false, true]).show_rows(ui, 22.0, listed.len(), |ui, rows| {
        for &(index, finding) in &listed[rows] {
            let text = RichText::new(title(finding, &report.owners.objects)).size(12.0);
            let label = ui.add(egui::Button::selectable(selected == Some(index), text).truncate());
            if label.clicked() {
                out.push(Action::SelectFinding(index));
            }
        }
    });
    if count > listed.len() {
        let text = format!("the first {} of {}", grouped(listed.len()), grouped(count));
        ui.label(RichText::new(text).size(11.5).color(theme::WEAK));
    }
}

/// Returns the line of a finding in the list.
fn title(finding: &Finding, objects: &Objects) -> String {
    let name = |object: &meshlod::check::ObjectId| {
        objects.names.get(object.0 as usize).map_or("?", String::as_str)
    };
    match finding {
        Finding::NonFiniteVertex { vertex }
        | Finding::UnusedVertex { vertex }
        | Finding::NonManifoldVertex { vertex, .. } => format!("{vertex}"),
        Finding::BadIndex { face, vertex } => format!("{face} names {vertex}"),
        Finding::BadAttributes { error } => error.to_string(),
        Finding::CoincidentVertices { vertices } => format!("{} vertices", vertices.len()),
        Finding::DegenerateFace { face, .. } | Finding::InsideOut { face, .. } => format!("{face}"),
        Finding::DuplicateFace { face, of } => format!("{face} repeats {of}"),
        Finding::InconsistentEdge { edge: [a, b], .. } => format!("{a} – {b}"),
        Finding::BoundaryLoop { vertices, .. } => format!("loop of {} vertices", vertices.len()),
        Finding::NonManifoldEdge { edge: [a, b], faces } => {
            format!("{a} – {b}, {} faces", faces.len())
        }
        Finding::SelfIntersection { faces: [a, b], .. } => format!("{a} and {b}"),
        Finding::Contact { objects: [a, b], .. } => format!("{} and {}", name(a), name(b)),
        Finding::Crowded { found } => format!("more than {found} intersections"),
    }
}
