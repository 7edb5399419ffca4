//! Report of `compress`, as JSON and text.

use std::path::Path;

use meshlod::jobs::{CompressReport, ErrorPoses, PieceCount, StripCounts};
use serde::Serialize;

use crate::options::fuse;
use crate::session::files;
use crate::text::model_scene;
use crate::text::numbers::{count, faces, percent, plural, value};

/// Figures of a compressed file for programs.
#[derive(Serialize)]
pub(super) struct CompressFigures<'f> {
    file: String,
    #[serde(flatten)]
    report: &'f CompressReport,
}

pub(super) fn figures<'f>(output: &Path, report: &'f CompressReport) -> CompressFigures<'f> {
    CompressFigures { file: files::name(output), report }
}

pub(super) fn text(output: &Path, report: &CompressReport) -> String {
    let mut text = fuse::to_text(report.fused.as_ref()) + &sizes(output, report);
    text += &coinciding_text(report.vertices_coinciding.unwrap_or(0));
    if let Some(strips) = report.strips {
        text += &strips_text(strips, report);
    }
    for layer in &report.layers {
        let (bytes, error) = (count(layer.bytes), value(layer.max_error));
        text += &format!("{}: {bytes} bytes, largest error {error}\n", layer.name);
    }
    if report.bytes_scene > 0 {
        text += &format!("nodes, materials and images: {} bytes\n", count(report.bytes_scene));
    }
    text += &format!("encode_seconds: {}\n", value(report.encode_seconds));
    match &report.scene {
        Some(counts) => text + &model_scene::counts_text(counts, ErrorPoses::Unknown),
        None => text,
    }
}

fn sizes(output: &Path, report: &CompressReport) -> String {
    let parts = [report.bytes_positions, report.bytes_connectivity, report.bytes_attributes];
    let [positions, connectivity, attributes] = parts.map(count);
    format!(
        "{}: {} in {} bytes, {:.2} per triangle; {}\n\
         bytes: positions {positions} ({} than f32), faces {connectivity}, attributes {attributes}\n",
        files::name(output),
        faces(report.faces),
        count(report.bytes_total),
        report.bytes_per_triangle,
        pieces(report.pieces),
        match 100.0 * report.reduction {
            saved if saved < 0.0 => format!("{} more", percent(-saved)),
            saved => format!("{} less", percent(saved)),
        },
    )
}

fn coinciding_text(vertices: usize) -> String {
    match vertices {
        0 => String::new(),
        1 => "1 vertex is rounded to the place of another; more bits keep it apart\n".into(),
        many => format!(
            "{} vertices are rounded to the places of others; more bits keep them apart\n",
            count(many)
        ),
    }
}

fn pieces(pieces: PieceCount) -> String {
    match pieces {
        PieceCount::Blocks(blocks) => format!("{} block{}", count(blocks), plural(blocks)),
        PieceCount::Parts(parts) => format!("{} part{}", count(parts), plural(parts)),
        PieceCount::Meshes(1) => "1 mesh".into(),
        PieceCount::Meshes(meshes) => format!("{} meshes", count(meshes)),
    }
}

fn strips_text(strips: StripCounts, report: &CompressReport) -> String {
    let StripCounts { strips, indices, parts_with_byte_indices } = strips;
    let PieceCount::Parts(parts) = report.pieces else { return String::new() };
    format!(
        "strips: {}, {:.3} indices per triangle with restarts, one byte each in {} of {} parts\n",
        count(strips),
        indices as f64 / report.faces as f64,
        count(parts_with_byte_indices),
        count(parts),
    )
}
