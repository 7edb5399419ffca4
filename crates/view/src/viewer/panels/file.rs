//! Contents of the file.

use egui::Ui;
use meshlod::multires::Hierarchy;

use super::widgets::{bytes, grouped, length, row, section};
use crate::stage::{Loaded, LoadedContent};
use crate::viewer::state::ViewerState;

pub(super) fn show(state: &ViewerState, ui: &mut Ui) {
    let Some(document) = state.document() else { return };
    section(ui, "File", true, |ui| facts(&document.loaded, ui));
}

fn facts(loaded: &Loaded, ui: &mut Ui) {
    row(ui, "Kind", loaded.content.name());
    row(ui, "Faces", grouped(loaded.mesh.faces.len()));
    row(ui, "Vertices", grouped(loaded.mesh.positions.len()));
    let [x, y, z] = [0, 1, 2].map(|axis| length(loaded.bounds.max[axis] - loaded.bounds.min[axis]));
    row(ui, "Size", format!("{x} × {y} × {z}"));
    if let Some(labels) = loaded.mesh.objects.as_ref().filter(|labels| labels.names.len() > 1) {
        row(ui, "Objects", grouped(labels.names.len()));
    }
    if loaded.paint.textures() > 0 {
        row(ui, "Textures", grouped(loaded.paint.textures()));
    }
    match &loaded.content {
        LoadedContent::Compressed(compressed) => {
            let bits = 8.0 * loaded.file_bytes as f64 / loaded.mesh.positions.len().max(1) as f64;
            row(ui, "Blocks", grouped(compressed.blocks()));
            row(ui, "Patches", grouped(compressed.patches()));
            row(ui, "Bits per vertex", format!("{bits:.1}"));
        }
        LoadedContent::Levels(levels) => match levels.levels() {
            Hierarchy::Contractions(model) => {
                row(ui, "Coarsest level", format!("{} faces", grouped(model.base_faces())));
                row(ui, "Updates", grouped(model.update_count()));
            }
            Hierarchy::RightTriangles(model) => {
                let [columns, rows] = model.size().map(|count| grouped(count as usize));
                row(ui, "Grid", format!("{columns} × {rows}"));
            }
        },
        _ => {}
    }
    if loaded.file_bytes > 0 {
        row(ui, "On disk", bytes(loaded.file_bytes));
    }
    row(ui, "Read in", format!("{:.0} ms", loaded.time.as_secs_f64() * 1e3));
}
