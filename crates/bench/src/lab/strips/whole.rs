//! Measures triangle strips of whole meshes, built by meshlod and meshoptimizer.

use anyhow::Result;
use meshlod::mesh::VertexId;
use meshlod::strip::{
    CacheAware, Difference, StripOptions, StripQuality, StripStatistics, Strips, difference,
    stripify,
};

use crate::lab::plot::{Line, Plot, page};
use crate::lab::table::Table;
use crate::least_seconds;
use crate::peer::meshopt_strips;

const MESHES: [&str; 5] =
    ["bunny.ply", "horse-97k.ply", "fandisk.off", "fandisk-32k.ply", "igea.ply"];
/// Largest strip lengths for a vertex cache, in faces.
const LONGEST: [usize; 8] = [13, 16, 20, 26, 34, 48, 80, 160];
/// Moves per face of the command line's quick and thorough settings.
const MOVES: [f64; 2] = [60.0, 1500.0];
const FOR_CACHE: f64 = 200.0;

/// Returns a table of vertices and indices per triangle, cache misses and seconds, by setting.
pub fn table() -> Result<String> {
    let mut table = Table::new([
        "whole meshes",
        "vertices per triangle",
        "indices with restarts",
        "strips",
        "swaps",
        "ACMR-16",
        "ACMR-32",
        "CPU s",
    ]);
    for file in MESHES {
        let Some(mesh) = crate::read(file)? else { continue };
        let faces = &mesh.faces;
        let mut row = |setting: String, work: &dyn Fn() -> Strips| {
            let mut strips = Strips::default();
            let seconds = least_seconds(1, || strips = work());
            table.row(figures(format!("{file}, {setting}"), faces, &strips, seconds));
        };
        row("meshoptimizer".into(), &|| meshopt_strips(faces));
        row("`fast`".into(), &|| of(faces, StripQuality::Fast, None));
        for moves in MOVES {
            let quality = StripQuality::Best { moves_per_face: moves };
            row(format!("`best`, {moves} moves"), &|| of(faces, quality, None));
        }
        let quality = StripQuality::Best { moves_per_face: FOR_CACHE };
        row("for a cache".into(), &|| of(faces, quality, Some(CacheAware::default())));
    }
    Ok(table.markdown())
}

/// Plots the number of indices against cache misses, for several strip lengths on the bunny.
pub fn trade_off() -> Result<Option<String>> {
    let Some(mesh) = crate::read("bunny.ply")? else { return Ok(None) };
    let faces = &mesh.faces;
    let point = |strips: &Strips| {
        let StripStatistics { triangles, indices_with_restart, acmr16, .. } =
            StripStatistics::new(strips);
        [acmr16, indices_with_restart as f64 / triangles as f64]
    };
    let quality = StripQuality::Best { moves_per_face: FOR_CACHE };
    let curve = LONGEST.map(|longest| {
        point(&of(faces, quality, Some(CacheAware { longest, ..CacheAware::default() })))
    });
    let lines = vec![
        Line::new("for a cache of 16, strips of 13 to 160 triangles", "#1e8449", curve.into()),
        Line::new("best", "#333333", vec![point(&of(faces, quality, None))]),
        Line::new("fast", "#2471a3", vec![point(&of(faces, StripQuality::Fast, None))]),
        Line::new("meshoptimizer", "#c0392b", vec![point(&meshopt_strips(faces))]),
    ];
    let caption = "bunny: indices with restarts per triangle, by ACMR-16".into();
    let plot =
        Plot { across: [0.6, 1.1], unit: "", up_from: Some(1.0), low_key: false, caption, lines };
    Ok(Some(page(&[plot])))
}

fn of(faces: &[[VertexId; 3]], quality: StripQuality, cache: Option<CacheAware>) -> Strips {
    stripify(faces, &StripOptions { quality, cache, ..StripOptions::default() })
}

fn figures(name: String, faces: &[[VertexId; 3]], strips: &Strips, seconds: f64) -> Vec<String> {
    assert_eq!(difference(strips, faces), Difference::default());
    let of = StripStatistics::new(strips);
    let each = |count: usize| format!("{:.3}", count as f64 / of.triangles as f64);
    vec![
        name,
        each(of.vertices_sent),
        each(of.indices_with_restart),
        of.strips.to_string(),
        of.swaps.to_string(),
        format!("{:.3}", of.acmr16),
        format!("{:.3}", of.acmr32),
        format!("{seconds:.3}"),
    ]
}
