//! A pyramid of fixed levels, with errors taken from the size of the model.
//!
//! It is laid out as Obj2Tiles 1.6.1 does with `--octree` (OpenDroneMap/Obj2Tiles, TilingStage.cs):
//! each level is the whole model simplified to a part of its faces and cut, at one division less
//! than the next finer one. Of `n` levels number `k`, from 0 for the finest, has the error
//! `diagonal / 2^(n - k)`, and the finest has 0. The root is one tile of the coarsest level, made
//! coarser by us, so smaller than it would be there, with the diagonal as its error.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde_json::{Value, json};

use super::tileset::{Tile, Tileset};
use crate::lab::command::Program;

/// Parts of the faces, the finest level first.
const RATIOS: [f64; 4] = [1.0, 0.5, 0.25, 0.125];

/// Pyramid of a model, each level a tileset of its own of which only leaves are used.
pub struct Pyramid {
    folder: PathBuf,
    levels: Vec<Tileset>,
    measured: Vec<f64>,
}

impl Pyramid {
    /// Makes the levels of a model in a folder, with as many faces a tile as the tiles of ours that
    /// are as large: twice as many at each coarser level.
    pub fn new(program: &Program, model: &Path, tile_faces: usize, folder: &Path) -> Result<Self> {
        let mut pyramid =
            Self { folder: folder.to_owned(), levels: Vec::new(), measured: Vec::new() };
        let model = model.display().to_string();
        for (k, ratio) in RATIOS.into_iter().enumerate() {
            let level = folder.join(format!("{k}.ply")).display().to_string();
            let (mut of, mut error) = (&model, 0.0);
            if k > 0 {
                program.answer(["simplify", &model, &level, "--ratio", &ratio.to_string()])?;
                let report = program.answer(["measure", &model, &level])?;
                error = report["max"].as_f64().context("max of measure")?;
                of = &level;
            }
            let output = folder.join(k.to_string());
            let (out, faces) = (output.display().to_string(), (tile_faces << k).to_string());
            program.answer(["tiles", of, &out, "--tile-faces", &faces, "--no-skirts"])?;
            pyramid.levels.push(Tileset::read(&output)?);
            pyramid.measured.push(error);
        }
        Ok(pyramid)
    }

    /// Writes `tileset.json` with errors from the diagonal of the model.
    pub fn write_by_diagonal(&self) -> Result<()> {
        let [low, high] = self.bounds(RATIOS.len(), None);
        let diagonal = (0..3).map(|axis| (high[axis] - low[axis]).powi(2)).sum::<f64>().sqrt();
        let finer = |k: usize| RATIOS.len() as i32 - k as i32;
        let error = |k: usize| if k == 0 { 0.0 } else { diagonal / 2f64.powi(finer(k)) };
        self.write(diagonal, error)
    }

    /// Writes `tileset.json` with the greatest distance of each level that was measured.
    pub fn write_by_measure(&self) -> Result<()> {
        self.write(self.measured[RATIOS.len() - 1] * 2.0, |k| self.measured[k])
    }

    fn write(&self, whole: f64, error: impl Fn(usize) -> f64 + Copy) -> Result<()> {
        let coarsest = RATIOS.len() - 1;
        let root = self.levels[coarsest].tiles.first().context("a tileset without tiles")?;
        let [low, high] = self.bounds(RATIOS.len(), None);
        let tiles = self.tiles(RATIOS.len(), None);
        let children: Vec<Value> =
            tiles.map(|tile| self.json(coarsest, tile, root.middle, error)).collect();
        let tileset = json!({
            "asset": { "version": "1.1" },
            "geometricError": whole,
            "root": {
                "boundingVolume": { "box": boxed([low, high], root.middle) },
                "geometricError": whole,
                "refine": "REPLACE",
                // Without content 3DTilesRendererJS does not get beyond the root.
                "content": { "uri": format!("{coarsest}/{}", root.uri) },
                "transform": translation(root.middle),
                "children": children,
            },
        });
        Ok(std::fs::write(self.folder.join("tileset.json"), tileset.to_string())?)
    }

    /// Describes a tile of level `k` and those that refine it, about a place.
    fn json(
        &self,
        k: usize,
        tile: &Tile,
        about: [f64; 3],
        error: impl Fn(usize) -> f64 + Copy,
    ) -> Value {
        let moved = [0, 1, 2].map(|axis| tile.middle[axis] - about[axis]);
        let finer = self.tiles(k, Some(tile));
        let children = finer.map(|finer| self.json(k - 1, finer, tile.middle, error));
        let children: Vec<Value> = children.collect();
        let mut json = json!({
            "boundingVolume": { "box": boxed(self.bounds(k, Some(tile)), tile.middle) },
            "geometricError": error(k),
            "refine": "REPLACE",
            "content": { "uri": format!("{k}/{}", tile.uri) },
            "transform": translation(moved),
        });
        if !children.is_empty() {
            json["children"] = Value::Array(children);
        }
        json
    }

    /// Lists the tiles of the level below `k` that refine a tile of level `k`: each
    /// refines the one whose box is closest to the middle of its own. All tiles of the coarsest level
    /// refine `None`, whose level is the number of levels.
    fn tiles<'p>(&'p self, k: usize, of: Option<&'p Tile>) -> impl Iterator<Item = &'p Tile> {
        let finer = k.checked_sub(1).map(|finer| leaves(&self.levels[finer]));
        finer.into_iter().flatten().filter(move |finer| {
            of.is_none_or(|of| {
                let away = |tile: &&Tile| squared(beyond(middle(finer), tile));
                let nearest = leaves(&self.levels[k]).min_by(|a, b| away(a).total_cmp(&away(b)));
                nearest.is_some_and(|nearest| nearest.uri == of.uri)
            })
        })
    }

    /// Returns the corners of the box around a tile of level `k` and all that refine it.
    fn bounds(&self, k: usize, tile: Option<&Tile>) -> [[f64; 3]; 2] {
        let own = tile.map_or([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], corners);
        self.tiles(k, tile).fold(own, |[low, high], finer| {
            let [a, b] = self.bounds(k - 1, Some(finer));
            let least = [0, 1, 2].map(|axis| f64::min(low[axis], a[axis]));
            [least, [0, 1, 2].map(|axis| f64::max(high[axis], b[axis]))]
        })
    }
}

fn translation([x, y, z]: [f64; 3]) -> [f64; 16] {
    [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, y, z, 1.0]
}

fn leaves(tileset: &Tileset) -> impl Iterator<Item = &Tile> {
    tileset.tiles.iter().filter(|tile| tile.is_leaf)
}

fn squared(v: [f64; 3]) -> f64 {
    v.into_iter().map(|x| x * x).sum()
}

/// Returns how far a place is beyond the box of a tile, by axis.
fn beyond(place: [f64; 3], tile: &Tile) -> [f64; 3] {
    let [low, high] = corners(tile);
    [0, 1, 2].map(|axis| (low[axis] - place[axis]).max(place[axis] - high[axis]).max(0.0))
}

/// Returns the middle of the box of a tile.
fn middle(tile: &Tile) -> [f64; 3] {
    [0, 1, 2].map(|axis| tile.middle[axis] + tile.bounds[axis])
}

fn corners(tile: &Tile) -> [[f64; 3]; 2] {
    let half = [tile.bounds[3], tile.bounds[7], tile.bounds[11]];
    let side = |sign: f64| {
        let middle = middle(tile);
        [0, 1, 2].map(|axis| middle[axis] + sign * half[axis])
    };
    [side(-1.0), side(1.0)]
}

/// Returns a box as a `boundingVolume` has it, about a place.
fn boxed([low, high]: [[f64; 3]; 2], about: [f64; 3]) -> [f64; 12] {
    let [x, y, z] = [0, 1, 2].map(|axis| 0.5 * (low[axis] + high[axis]) - about[axis]);
    let [a, b, c] = [0, 1, 2].map(|axis| 0.5 * (high[axis] - low[axis]));
    [x, y, z, a, 0.0, 0.0, 0.0, b, 0.0, 0.0, 0.0, c]
}
