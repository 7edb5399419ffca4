//! Bytes that 3DTilesRendererJS loads, of our tiles and of a pyramid.

use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, bail};
use serde::Deserialize;

use super::pyramid::Pyramid;
use crate::lab::command::Program;
use crate::lab::folders::root;
use crate::lab::table::Table;

/// Folder of the scripts, with what they need once `npm ci` was run in it.
const JUDGES: &str = "crates/tiles/tests/judges";

/// Says how bytes are compared.
pub const ABOUT: &str = "Bytes that 3DTilesRendererJS 0.5.3 loads, `tileset.json` and all contents, until the view is \
     complete, the same skirtless, compressed tiles for both. The camera is some radii from the middle, \
     errors are in pixels of a picture of 512 by 512. The pyramid has levels of 100, 50, 25 and 12.5 % by \
     our simplification, cut as Obj2Tiles 1.6.1 does with `--octree`, and its errors, \
     diagonal / 2^(4 - k) for level k. *measured*: the same pyramid with the greatest distance of each \
     level instead.\n\n";

/// Bytes that were loaded for a view.
#[derive(Deserialize)]
struct LoadedView {
    distance: f64,
    pixels: f64,
    tiles: usize,
    bytes: f64,
}

/// Returns a table of the bytes that views of a model load; a note if the scripts cannot run.
pub fn table(program: &Program, name: &str, model: &Path, tile_faces: usize) -> Result<String> {
    if !root().join(JUDGES).join("node_modules").is_dir() {
        return Ok(format!("Not measured for {name}: `npm ci` in {JUDGES} first.\n\n"));
    }
    let folder = tempfile::tempdir()?;
    let [ours, other] = ["ours", "pyramid"].map(|name| folder.path().join(name));
    let arguments = ["--tile-faces", &tile_faces.to_string(), "--no-skirts"];
    let files = [model, &ours].map(|path| path.display().to_string());
    program
        .answer(["tiles"].into_iter().chain(files.each_ref().map(|f| &f[..])).chain(arguments))?;
    std::fs::create_dir(&other)?;
    let pyramid = Pyramid::new(program, model, tile_faces, &other)?;
    let loaded = views(&ours)?;
    pyramid.write_by_diagonal()?;
    let by_diagonal = views(&other)?;
    pyramid.write_by_measure()?;
    let by_measure = views(&other)?;
    let first = format!("{name}: radii, pixels");
    let headings = ["tiles", "kB", "pyramid, kB", "part", "measured, kB", "part"];
    let mut table = Table::new([&first[..]].into_iter().chain(headings));
    for ((view, diagonal), measure) in loaded.iter().zip(&by_diagonal).zip(&by_measure) {
        let kilobytes = |bytes: f64| format!("{:.0}", bytes / 1e3);
        let part = |other: &LoadedView| format!("{:.2}", view.bytes / other.bytes);
        table.row([
            format!("{}, {}", view.distance, view.pixels),
            view.tiles.to_string(),
            kilobytes(view.bytes),
            kilobytes(diagonal.bytes),
            part(diagonal),
            kilobytes(measure.bytes),
            part(measure),
        ]);
    }
    Ok(table.markdown())
}

/// Has 3DTilesRendererJS load a tileset for all views.
fn views(tileset: &Path) -> Result<Vec<LoadedView>> {
    let output = Command::new("node")
        .arg(root().join(JUDGES).join("bytes.mjs"))
        .arg(tileset)
        .output()
        .context("node")?;
    if !output.status.success() {
        bail!("bytes.mjs: {}", String::from_utf8_lossy(&output.stderr).trim());
    }
    Ok(serde_json::from_slice(&output.stdout)?)
}
