//! Review of a tileset that was written: every file is read again.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use meshlod_io::{Format, MeshInstance, ReadOptions, Scene, Weld, read_bytes};
use rustc_hash::FxHashMap;
use serde_json::Value;

use crate::cell::Cell;
use crate::error::TilesError;
use crate::lattice::{END, Point, TileLattice};
use crate::tileset_files::TilesetFiles;

/// Part of the size of the model by which boxes may be too small: rounding.
const ROUNDING: f64 = 1e-9;

/// Name of the file that a tileset begins with.
const TILESET: &str = "tileset.json";

/// Largest depth of external tilesets in each other.
const MOST_FILES: usize = 64;

/// Findings of a review of a tileset.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TilesetReview {
    /// Number of tiles.
    pub tiles: usize,
    /// Number of faces of all tiles, without skirts.
    pub faces: usize,
    /// Number of levels.
    pub levels: usize,
    /// Faults, one line each.
    pub findings: Vec<String>,
}

/// Reads a tileset of ours, all its tiles, and checks that transforms move tiles to where their cells
/// are, that contents are in their boxes and boxes in those around them, that errors do not rise
/// towards the leaves, and that the tiles of each level meet without a crack.
///
/// # Errors
/// A `tileset.json` or archive that cannot be read, or that is not one of ours.
pub fn review(path: &Path) -> Result<TilesetReview, TilesError> {
    let files = TilesetFiles::open(path)?;
    let whole = json(&files, TILESET)?;
    let extras = &whole["asset"]["extras"];
    let foreign = || TilesError::Foreign(files.path(TILESET));
    let lattice = serde_json::from_value(extras["lattice"].clone()).map_err(|_| foreign())?;
    let is_z_up = extras["zUp"].as_bool().ok_or_else(foreign)?;
    let mut reviewer = Reviewer {
        files,
        lattice,
        is_z_up,
        review: TilesetReview::default(),
        leaves: Vec::new(),
        inner: Vec::new(),
        deepest: 0,
        seen: BTreeSet::new(),
        root: None,
    };
    let mut root = whole["root"].clone();
    let placed = root.as_object_mut().and_then(|root| root.remove("transform"));
    if !placed.is_none_or(|transform| is_placement(&transform)) {
        reviewer.find(TILESET, "the transform of its root is not a place and a turn");
    }
    let error = whole["geometricError"].as_f64().unwrap_or(f64::NAN);
    reviewer.tile(&root, &Above { error, bounds: None, place: [0.0; 3], files: 0 });
    reviewer.check_levels();
    Ok(reviewer.review)
}

fn json(files: &TilesetFiles, name: &str) -> Result<Value, TilesError> {
    let reason = |error: serde_json::Error| error.to_string();
    serde_json::from_slice(&files.read(name)?)
        .map_err(|error| TilesError::Unreadable { path: files.path(name), reason: reason(error) })
}

/// Border edges of a tile by their points, each with the number of times that it is there, less
/// that of the edge in the other direction.
type Edges = FxHashMap<[Point; 2], i64>;

/// Knowledge of a tile by those that it refines.
struct Above {
    error: f64,
    bounds: Option<[[f64; 3]; 2]>,
    /// Sum of the transforms below that of the root, in the axes of the tileset.
    place: [f64; 3],
    /// Number of tilesets around it.
    files: usize,
}

struct Reviewer {
    files: TilesetFiles,
    lattice: TileLattice,
    is_z_up: bool,
    review: TilesetReview,
    leaves: Vec<(Cell, Edges)>,
    inner: Vec<(Cell, Edges)>,
    deepest: u8,
    /// Other tilesets that were read.
    seen: BTreeSet<String>,
    /// Cell of the first tile.
    root: Option<Cell>,
}

impl Reviewer {
    /// Reviews a tile and those that refine it.
    fn tile(&mut self, tile: &Value, above: &Above) {
        let uri = tile["content"]["uri"].as_str().unwrap_or_default().to_owned();
        if uri.ends_with(".json") {
            return self.tileset(tile, uri, above);
        }
        let Ok(cell) = serde_json::from_value::<Cell>(tile["extras"]["cell"].clone()) else {
            return self.find(&uri, "its cell is missing");
        };
        if !cell.is_sound() {
            return self.find(&uri, "its cell is not one of an octree");
        }
        self.review.tiles += 1;
        self.deepest = self.deepest.max(cell.depth);
        let error = tile["geometricError"].as_f64().unwrap_or(f64::NAN);
        if !(0.0..=above.error).contains(&error) {
            self.find(&uri, "its error is above that of the tile that it refines");
        }
        let bounds = self.bounds(tile, cell);
        let slack = ROUNDING * f64::from(END) * self.lattice.step;
        let root = *self.root.get_or_insert(cell);
        let place = movement(tile).map(|by| add(above.place, by));
        let expected = self.place(root, cell);
        let is_near = |place: [f64; 3]| (0..3).all(|i| (place[i] - expected[i]).abs() <= slack);
        if !place.is_some_and(is_near) {
            self.find(&uri, "its transform does not move it to its cell");
        }
        let is_inside = |[low, high]: [[f64; 3]; 2], [a, b]: [[f64; 3]; 2]| {
            (0..3).all(|axis| low[axis] >= a[axis] - slack && high[axis] <= b[axis] + slack)
        };
        match bounds {
            None => self.find(&uri, "it has no box"),
            Some(bounds) if above.bounds.is_some_and(|around| !is_inside(bounds, around)) => {
                self.find(&uri, "its box is not inside that of the tile that it refines");
            }
            Some(_) => {}
        }
        let children = tile["children"].as_array().cloned().unwrap_or_default();
        match self.content(&uri, cell) {
            Ok((edges, content)) => {
                if bounds.is_some_and(|bounds| !is_inside(content, bounds)) {
                    self.find(&uri, "it is not inside its box");
                }
                let tiles = if children.is_empty() { &mut self.leaves } else { &mut self.inner };
                tiles.push((cell, edges));
            }
            Err(reason) => self.find(&uri, &reason),
        }
        let below = Above { error, bounds, place: expected, files: above.files };
        children.iter().for_each(|child| self.tile(child, &below));
    }

    /// Reviews the tiles of another tileset, which a tile stands for.
    fn tileset(&mut self, tile: &Value, uri: String, above: &Above) {
        if !self.seen.insert(uri.clone()) {
            return self.find(&uri, "more than one tile refers to it");
        }
        let place = movement(tile).map_or(above.place, |by| add(above.place, by));
        match json(&self.files, &uri) {
            Ok(inner) if above.files < MOST_FILES => {
                self.tile(&inner["root"], &Above { place, files: above.files + 1, ..*above });
            }
            Ok(_) => self.find(&uri, "tilesets are nested too deeply"),
            Err(error) => self.review.findings.push(error.to_string()),
        }
    }

    /// Returns the way from the middle of one cell to that of another, in the axes of the tileset.
    fn place(&self, from: Cell, to: Cell) -> [f64; 3] {
        let (a, b) = (from.middle(), to.middle());
        let [x, y, z] = [0, 1, 2].map(|axis| f64::from(b[axis] - a[axis]) * self.lattice.step);
        if self.is_z_up { [x, y, z] } else { [x, -z, y] }
    }

    fn find(&mut self, uri: &str, what: &str) {
        self.review.findings.push(format!("{uri}: {what}"));
    }

    /// Returns the box of a tile in the axes of the model, in model units.
    fn bounds(&self, tile: &Value, cell: Cell) -> Option<[[f64; 3]; 2]> {
        let numbers = tile["boundingVolume"]["box"].as_array()?;
        let numbers: Vec<f64> = numbers.iter().map(Value::as_f64).collect::<Option<_>>()?;
        let [x, y, z, a, .., c] = numbers[..] else { return None };
        let b = *numbers.get(7)?;
        let turned = |[x, y, z]: [f64; 3]| if self.is_z_up { [x, y, z] } else { [x, z, -y] };
        let (center, half) = (turned([x, y, z]), turned([a, b, c]).map(f64::abs));
        let middle = self.lattice.place(cell.middle().map(f64::from));
        let side = |sign: f64| [0, 1, 2].map(|i| middle[i] + center[i] + sign * half[i]);
        Some([side(-1.0), side(1.0)])
    }

    /// Reads the content of a tile. Returns its border edges, and its bounds in model units.
    fn content(&mut self, uri: &str, cell: Cell) -> Result<(Edges, [[f64; 3]; 2]), String> {
        let bytes = self.files.read(uri).map_err(|error| error.to_string())?;
        let options = ReadOptions { weld: Weld::Off };
        let scene = read_bytes(&bytes, Format::Glb, &mut |_| None, &options);
        let scene = scene.map_err(|error| error.to_string())?;
        let (mut edges, mut bounds) =
            (Edges::default(), [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]]);
        for shown in scene.instances() {
            let points = self.points(&scene, &shown, cell);
            for place in points.iter().map(|point| self.lattice.place(point.map(f64::from))) {
                (0..3).for_each(|axis| {
                    bounds[0][axis] = bounds[0][axis].min(place[axis]);
                    bounds[1][axis] = bounds[1][axis].max(place[axis]);
                });
            }
            let mesh = &scene.meshes[shown.mesh];
            if mesh.name == "skirt" {
                continue;
            }
            self.review.faces += mesh.mesh.faces.len();
            for face in &mesh.mesh.faces {
                let [a, b, c] = face.map(|v| points[v.index()]);
                for [a, b] in [[a, b], [b, c], [c, a]] {
                    if cell.sides_of(a) & cell.sides_of(b) != 0 && a != b {
                        let (edge, sign) = if a < b { ([a, b], 1) } else { ([b, a], -1) };
                        *edges.entry(edge).or_default() += sign;
                    }
                }
            }
        }
        edges.retain(|_, sum| *sum != 0);
        Ok((edges, bounds))
    }

    /// Returns the vertices of a mesh on the lattice.
    fn points(&self, scene: &Scene, shown: &MeshInstance, cell: Cell) -> Vec<Point> {
        let (to, middle) = (shown.transform, cell.middle());
        let mesh = &scene.meshes[shown.mesh].mesh;
        let place = |at: &[f64; 3]| {
            let [x, y, z] = [0, 1, 2]
                .map(|row| to[3][row] + (0..3).map(|axis| to[axis][row] * at[axis]).sum::<f64>());
            let own = if self.is_z_up { [x, -z, y] } else { [x, y, z] };
            [0, 1, 2].map(|axis| (own[axis] / self.lattice.step).round() as i32 + middle[axis])
        };
        mesh.positions.iter().map(place).collect()
    }

    /// Checks at every depth that the border edges of what is shown then cancel out.
    fn check_levels(&mut self) {
        self.review.levels = usize::from(self.deepest) + 1;
        for depth in 0..=self.deepest {
            let leaves = self.leaves.iter().filter(|(cell, _)| cell.depth <= depth);
            let inner = self.inner.iter().filter(|(cell, _)| cell.depth == depth);
            let mut sums: BTreeMap<[Point; 2], i64> = BTreeMap::new();
            for (edge, sum) in leaves.chain(inner).flat_map(|(_, edges)| edges) {
                *sums.entry(*edge).or_default() += sum;
            }
            let open = sums.values().filter(|sum| **sum != 0).count();
            if open > 0 {
                let finding = format!("depth {depth}: {open} edges between tiles do not meet");
                self.review.findings.push(finding);
            }
        }
    }
}

fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|axis| a[axis] + b[axis])
}

/// Returns the columns of a matrix of 16 numbers.
fn columns(matrix: &Value) -> Option<[[f64; 4]; 4]> {
    let numbers = matrix.as_array()?.iter().map(Value::as_f64).collect::<Option<Vec<_>>>()?;
    let (columns, rest) = numbers.as_chunks::<4>();
    columns.try_into().ok().filter(|_| rest.is_empty())
}

/// Returns how far the transform of a tile moves it; `None` if it does anything else.
fn movement(tile: &Value) -> Option<[f64; 3]> {
    let Some(transform) = tile.get("transform") else { return Some([0.0; 3]) };
    let [x, y, z, [a, b, c, one]] = columns(transform)?;
    let is_straight =
        x == [1.0, 0.0, 0.0, 0.0] && y == [0.0, 1.0, 0.0, 0.0] && z == [0.0, 0.0, 1.0, 0.0];
    (is_straight && one == 1.0).then_some([a, b, c])
}

/// Returns true for a matrix that turns and moves a model as it is.
fn is_placement(matrix: &Value) -> bool {
    let Some([x, y, z, [a, b, c, one]]) = columns(matrix) else { return false };
    let dot = |a: [f64; 4], b: [f64; 4]| (0..4).map(|i| a[i] * b[i]).sum::<f64>();
    let are_units =
        [x, y, z].iter().all(|&axis| axis[3] == 0.0 && (dot(axis, axis) - 1.0).abs() < 1e-6);
    let is_square = [dot(x, y), dot(y, z), dot(z, x)].iter().all(|part| part.abs() < 1e-6);
    are_units && is_square && one == 1.0 && [a, b, c].iter().all(|at| at.is_finite())
}
