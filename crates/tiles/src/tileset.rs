//! Files `tileset.json` [OGC23], which say how tiles refine each other.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Value, json};

use crate::cell::Cell;
use crate::error::TilesError;
use crate::folder::Folder;
use crate::folder::record::TileRecord;
use crate::plan::Plan;

/// Number of levels in one file.
const LEVELS: u8 = 5;

/// File of a tileset.
#[derive(Clone, Debug)]
pub struct TilesetFile {
    /// Name of the file.
    pub name: String,
    /// Its text.
    pub text: Vec<u8>,
}

/// All tiles together.
#[derive(Debug)]
pub struct Finished {
    /// The files; the first is `tileset.json`.
    pub files: Vec<TilesetFile>,
    /// Records of all tiles, by task.
    pub records: Vec<TileRecord>,
}

impl Finished {
    /// Returns the names of images that tiles should show and that cannot be decoded.
    pub fn lost_images<'p>(&self, plan: &'p Plan) -> Vec<&'p str> {
        let all = self.records.iter().flat_map(|record| &record.lost_images);
        let lost: BTreeSet<usize> = all.copied().collect();
        let images = lost.iter().filter_map(|&i| plan.images.get(i));
        // Of those whose files are missing, the reader has told.
        images.filter(|image| image.checksum != 0).map(|image| &*image.name).collect()
    }
}

/// Checks that all tiles are done and meet, and writes down how they refine each other.
///
/// # Errors
/// A task that is not done, and levels whose tiles do not meet.
pub fn finish(plan: &Plan, folder: &Folder) -> Result<Finished, TilesError> {
    let all = 0..plan.tasks.len();
    let record = |task: usize| {
        let found = folder.record(plan, task)?;
        let record = found.ok_or(TilesError::Missing { task })?;
        folder.check_content(task, &record).map(|()| record)
    };
    let records: Vec<TileRecord> = all.map(record).collect::<Result<_, _>>()?;
    check_chains(plan, &records)?;
    let errors = rising_errors(plan, &records);
    let root = records.len() - 1;
    let mut writer = Writer { plan, records: &records, errors: &errors, files: Vec::new() };
    let whole = writer.file("tileset.json", root, true);
    let mut files = vec![whole];
    files.append(&mut writer.files);
    Ok(Finished { files, records })
}

/// Checks at every depth that the border edges of all tiles which are shown then cancel out.
fn check_chains(plan: &Plan, records: &[TileRecord]) -> Result<(), TilesError> {
    let mut leaves = BTreeMap::new();
    let mut inner = BTreeMap::new();
    for (task, record) in records.iter().enumerate() {
        let sums = if plan.parts(task).is_empty() { &mut leaves } else { &mut inner };
        let sum: &mut u128 = sums.entry(record.cell.depth).or_default();
        *sum = sum.wrapping_add(record.chain());
    }
    for depth in 0..=plan.tree.depth() {
        let leaves = leaves.range(..=depth).fold(0u128, |sum, (_, own)| sum.wrapping_add(*own));
        let inner = inner.get(&depth).copied().unwrap_or(0);
        if leaves.wrapping_add(inner) != 0 {
            return Err(TilesError::Cracked { depth });
        }
    }
    match records.iter().find(|record| record.open > 0) {
        Some(record) => Err(TilesError::Cracked { depth: record.cell.depth + 1 }),
        None => Ok(()),
    }
}

/// Returns the error of each tile, at least as great as those of the tiles that refine it.
fn rising_errors(plan: &Plan, records: &[TileRecord]) -> Vec<f64> {
    let mut errors: Vec<f64> = Vec::with_capacity(records.len());
    for (task, record) in records.iter().enumerate() {
        let parts = plan.parts(task);
        errors.push(parts.iter().fold(record.error, |error, &part| error.max(errors[part])));
    }
    errors
}

struct Writer<'a> {
    plan: &'a Plan,
    records: &'a [TileRecord],
    errors: &'a [f64],
    files: Vec<TilesetFile>,
}

impl Writer<'_> {
    /// Makes the file whose root is a tile.
    fn file(&mut self, name: &str, task: usize, is_first: bool) -> TilesetFile {
        let last = self.records[task].cell.depth + LEVELS - 1;
        let frame = if is_first { None } else { Some(self.records[task].cell) };
        let mut root = self.tile(task, frame, last);
        if is_first {
            root["transform"] = json!(flat(self.placed(self.records[task].cell)));
        }
        let whole = match is_first {
            // Without any tile the error is the whole model.
            true => {
                let [low, high] = self.records[task].bounds;
                let sides = (0..3).map(|axis| (high[axis] - low[axis]).powi(2)).sum::<f64>();
                sides.sqrt() * self.plan.lattice.step
            }
            false => self.errors[task],
        };
        let generator = concat!("meshlod ", env!("CARGO_PKG_VERSION"));
        let used = match self.plan.options.meshopt {
            true => json!(["EXT_meshopt_compression", "KHR_mesh_quantization"]),
            false => json!(["KHR_mesh_quantization"]),
        };
        let tileset = json!({
            "asset": {
                "version": "1.1",
                "generator": generator,
                "extras": { "lattice": self.plan.lattice, "zUp": self.plan.options.is_z_up },
            },
            "geometricError": whole,
            "extensionsUsed": ["3DTILES_content_gltf"],
            "extensions": { "3DTILES_content_gltf": {
                "extensionsUsed": used, "extensionsRequired": used,
            } },
            "root": root,
        });
        TilesetFile { name: name.to_owned(), text: tileset.to_string().into_bytes() }
    }

    /// Describes a tile and those that refine it, relative to a cell; its own transform is left out
    /// if it is the first.
    fn tile(&mut self, task: usize, frame: Option<Cell>, last: u8) -> Value {
        let record = &self.records[task];
        let cell = record.cell;
        let mut tile = json!({
            "boundingVolume": { "box": self.bounding_box(task) },
            "geometricError": self.errors[task],
            "refine": "REPLACE",
        });
        if let Some(frame) = frame.filter(|frame| *frame != cell) {
            tile["transform"] = json!(flat(self.moved(frame, cell)));
        }
        let parts = self.plan.parts(task);
        if cell.depth > last {
            let name = format!("{cell}.json");
            let file = self.file(&name, task, false);
            self.files.push(file);
            tile["content"] = json!({ "uri": name });
            return tile;
        }
        tile["content"] = json!({ "uri": format!("tiles/{cell}.glb") });
        tile["extras"] = json!({ "faces": record.faces, "cell": cell });
        if let Some(measured) = record.measured {
            tile["extras"]["measured"] = json!(measured);
        }
        if !parts.is_empty() {
            let parts = parts.into_iter().map(|part| self.tile(part, Some(cell), last));
            tile["children"] = Value::Array(parts.collect());
        }
        tile
    }

    /// Returns the box around a tile and those that refine it, in the axes of the tileset, about the
    /// middle of its cell.
    fn bounding_box(&self, task: usize) -> [f64; 12] {
        let [low, high] = self.bounds(task);
        let middle = self.records[task].cell.middle();
        let step = self.plan.lattice.step;
        let center =
            [0, 1, 2].map(|axis| (0.5 * (low[axis] + high[axis]) - f64::from(middle[axis])) * step);
        let half = [0, 1, 2].map(|axis| 0.5 * (high[axis] - low[axis]) * step);
        let [x, y, z] = self.axes(center);
        let [a, b, c] = self.axes(half).map(f64::abs);
        [x, y, z, a, 0.0, 0.0, 0.0, b, 0.0, 0.0, 0.0, c]
    }

    fn bounds(&self, task: usize) -> [[f64; 3]; 2] {
        let parts = self.plan.parts(task).into_iter();
        parts.fold(self.records[task].bounds, |[low, high], part| {
            let [other_low, other_high] = self.bounds(part);
            let least = [0, 1, 2].map(|axis| f64::min(low[axis], other_low[axis]));
            [least, [0, 1, 2].map(|axis| f64::max(high[axis], other_high[axis]))]
        })
    }

    /// Turns a vector of the model to the axes of the tileset, whose z is up.
    fn axes(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        if self.plan.options.is_z_up { [x, y, z] } else { [x, -z, y] }
    }

    /// Returns the transform from one cell's middle to another's.
    fn moved(&self, from: Cell, to: Cell) -> [[f64; 4]; 4] {
        let (a, b, step) = (from.middle(), to.middle(), self.plan.lattice.step);
        let by = self.axes([0, 1, 2].map(|axis| f64::from(b[axis] - a[axis]) * step));
        translation(by)
    }

    /// Returns the transform of the root: the placement of the model, then the middle of its cell.
    fn placed(&self, cell: Cell) -> [[f64; 4]; 4] {
        let middle = self.plan.lattice.place(cell.middle().map(f64::from));
        let by = self.axes(middle);
        let to = self.plan.options.placement;
        let mut placed = to;
        placed[3] = [0, 1, 2, 3]
            .map(|row| to[3][row] + (0..3).map(|axis| to[axis][row] * by[axis]).sum::<f64>());
        placed
    }
}

fn translation([x, y, z]: [f64; 3]) -> [[f64; 4]; 4] {
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [x, y, z, 1.0]]
}

fn flat(matrix: [[f64; 4]; 4]) -> Vec<f64> {
    matrix.into_iter().flatten().collect()
}
