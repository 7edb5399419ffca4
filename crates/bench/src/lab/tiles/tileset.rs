//! Tiles of a tileset of ours, and those of a level as one model.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use meshlod::io::{Node, Scene};
use meshlod::mesh::Mesh;
use meshlod::tiles::Cell;
use serde_json::Value;

/// Tileset in a folder.
pub struct Tileset {
    folder: PathBuf,
    /// All tiles, parents before their children.
    pub tiles: Vec<Tile>,
}

/// Tile of a tileset.
pub struct Tile {
    /// Path of its content, relative to the folder.
    pub uri: String,
    /// Cell of the octree.
    pub cell: Cell,
    /// Its `geometricError`, in model units.
    pub error: f64,
    /// Number of faces, without those of skirts.
    pub faces: usize,
    /// Whether no tile refines it.
    pub is_leaf: bool,
    /// Middle of its cell in the axes of the tileset, whose z is up.
    pub middle: [f64; 3],
    /// Its `boundingVolume.box`, about that middle.
    pub bounds: [f64; 12],
}

impl Tileset {
    /// Reads `tileset.json` and all files that it names but the contents. The tileset must not be
    /// placed on the globe.
    pub fn read(folder: &Path) -> Result<Self> {
        let mut set = Self { folder: folder.to_owned(), tiles: Vec::new() };
        set.add(&json(&folder.join("tileset.json"))?["root"], [0.0; 3])?;
        Ok(set)
    }

    fn add(&mut self, tile: &Value, around: [f64; 3]) -> Result<()> {
        let own = |row: usize| tile["transform"][12 + row].as_f64().unwrap_or(0.0);
        let middle = [0, 1, 2].map(|axis| around[axis] + own(axis));
        let uri = tile["content"]["uri"].as_str().context("a tile without content")?;
        if uri.ends_with(".json") {
            return self.add(&json(&self.folder.join(uri))?["root"], middle);
        }
        let children = tile["children"].as_array().map_or(&[][..], Vec::as_slice);
        self.tiles.push(Tile {
            uri: uri.to_owned(),
            cell: serde_json::from_value(tile["extras"]["cell"].clone())?,
            error: tile["geometricError"].as_f64().context("a tile without an error")?,
            faces: serde_json::from_value(tile["extras"]["faces"].clone())?,
            is_leaf: children.is_empty(),
            middle,
            bounds: serde_json::from_value(tile["boundingVolume"]["box"].clone())?,
        });
        children.iter().try_for_each(|child| self.add(child, middle))
    }

    /// Returns the depths of tiles, the coarsest first.
    pub fn depths(&self) -> RangeInclusive<u8> {
        0..=self.tiles.iter().map(|tile| tile.cell.depth).max().unwrap_or(0)
    }

    /// Lists the tiles of a level: those of a depth, and leaves that are less deep.
    pub fn level(&self, depth: u8) -> impl Iterator<Item = &Tile> {
        let is_shown = move |tile: &&Tile| match tile.is_leaf {
            true => tile.cell.depth <= depth,
            false => tile.cell.depth == depth,
        };
        self.tiles.iter().filter(is_shown)
    }

    /// Returns the path of the content of a tile.
    pub fn content(&self, tile: &Tile) -> PathBuf {
        self.folder.join(&tile.uri)
    }

    /// Returns the bytes of all contents.
    pub fn bytes(&self) -> Result<u64> {
        self.tiles.iter().map(|tile| Ok(self.content(tile).metadata()?.len())).sum()
    }

    /// Joins the tiles of a level, without skirts, in the axes of the model, whose y is up: as a
    /// scene that has their materials, and as one mesh of it, whose vertices are joined where tiles
    /// meet.
    pub fn joined(&self, depth: u8) -> Result<(Scene, Mesh)> {
        let mut all = Scene::default();
        for tile in self.level(depth) {
            let path = self.content(tile);
            let scene = meshlod::read(&path, &Default::default())?;
            append(&mut all, scene, tile.middle);
        }
        let mut mesh = all.flatten();
        // Grids are powers of two of model units: vertices of two tiles at one point are equal.
        meshlod::mesh::weld(&mut mesh, 0.0);
        Ok((all, mesh))
    }
}

fn json(path: &Path) -> Result<Value> {
    let bytes = std::fs::read(path).with_context(|| path.display().to_string())?;
    Ok(serde_json::from_slice(&bytes)?)
}

/// Appends what a tile shows about its middle, in the axes of the tileset.
fn append(all: &mut Scene, tile: Scene, [x, y, z]: [f64; 3]) {
    let (images, materials) = (all.images.len(), all.materials.len());
    let mut place = Node::default();
    place.transform[3] = [x, z, -y, 1.0];
    let place_index = all.nodes.len();
    all.roots.push(place_index);
    all.nodes.push(place);
    for shown in tile.instances() {
        if tile.meshes[shown.mesh].name == "skirt" {
            continue;
        }
        let mut mesh = tile.meshes[shown.mesh].clone();
        mesh.materials.iter_mut().flatten().for_each(|material| *material += materials);
        all.nodes.push(Node {
            transform: shown.transform,
            mesh: Some(all.meshes.len()),
            ..Node::default()
        });
        let node = all.nodes.len() - 1;
        all.nodes[place_index].children.push(node);
        all.meshes.push(mesh);
    }
    all.materials.extend(tile.materials.into_iter().map(|mut material| {
        material.base_color_image = material.base_color_image.map(|image| image + images);
        material
    }));
    all.images.extend(tile.images);
}
