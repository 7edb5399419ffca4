//! Folder of a plan: files whose names say what is in them, so that what is done is there.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use meshlod_io::{Image, write_file};
use serde::{Deserialize, Serialize};

use crate::cell::Cell;
use crate::chain::ChainSum;
use crate::error::TilesError;
use crate::plan::Plan;
use crate::scratch::read_blocks;
use crate::tile::{TileBuilder, TileMesh};
use crate::tile_file;

/// Folder of a plan.
#[derive(Clone, Debug)]
pub struct Folder {
    path: PathBuf,
}

/// Record of a tile that is done.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TileRecord {
    /// The tile.
    pub cell: Cell,
    /// Number of faces, without those of skirts.
    pub faces: usize,
    /// Bound of the distance between the tile as it is written and the part of the model that it
    /// shows, both ways, in model units.
    pub error: f64,
    /// Bound of the distance of the mesh that the next coarser tile is made from, in model units.
    pub bound: f64,
    /// Least and greatest coordinates of its content, in steps of the lattice.
    pub bounds: [[f64; 3]; 2],
    /// Bytes of the content.
    pub bytes: u64,
    /// Sum of its border edges, as two halves: see [`chain`](Self::chain).
    pub chain: [u64; 2],
    /// Number of edges between its parts that had no counterpart.
    pub open: usize,
    /// Whether it could not be simplified without harm to its border, and is as its parts are.
    pub is_unchanged: bool,
    /// Checksum of the mesh that the next coarser tile is made from.
    pub checksum: u32,
}

impl TileRecord {
    /// Returns the sum of the border edges.
    pub fn chain(&self) -> ChainSum {
        u128::from(self.chain[0]) << 64 | u128::from(self.chain[1])
    }

    /// Sets the sum of the border edges.
    pub fn with_chain(self, sum: ChainSum) -> Self {
        Self { chain: [(sum >> 64) as u64, sum as u64], ..self }
    }

    /// Creates the record of a tile of which nothing is known yet.
    pub fn new(cell: Cell) -> Self {
        Self {
            cell,
            faces: 0,
            error: 0.0,
            bound: 0.0,
            bounds: [[0.0; 3]; 2],
            bytes: 0,
            chain: [0; 2],
            open: 0,
            is_unchanged: false,
            checksum: 0,
        }
    }
}

impl Folder {
    /// Names the folder of a plan, which need not be there.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into() }
    }

    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Makes the folder and those in it.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn make(&self) -> Result<(), TilesError> {
        for folder in [self.path.clone(), self.path.join("tiles"), self.content_folder()] {
            fs::create_dir_all(&folder).map_err(|error| TilesError::system(&folder, error))?;
        }
        // Tells the folder of a plan that was ended early from any other.
        let lock = self.lock_file();
        File::create(&lock).map(drop).map_err(|error| TilesError::system(&lock, error))
    }

    /// Returns the path of the file that a process locks while it works on the plan.
    pub fn lock_file(&self) -> PathBuf {
        self.path.join("lock")
    }

    /// Returns the path of the scratch file.
    pub fn scratch(&self) -> PathBuf {
        self.path.join("pieces")
    }

    /// Returns the folder of the contents of tiles.
    pub fn content_folder(&self) -> PathBuf {
        self.path.join("content")
    }

    /// Returns the path of the content of a tile.
    pub fn content(&self, cell: Cell) -> PathBuf {
        self.content_folder().join(format!("{cell}.glb"))
    }

    fn plan_file(&self) -> PathBuf {
        self.path.join("plan.json")
    }

    fn mesh_file(&self, cell: Cell) -> PathBuf {
        self.path.join("tiles").join(format!("{cell}.mesh"))
    }

    fn record_file(&self, cell: Cell) -> PathBuf {
        self.path.join("tiles").join(format!("{cell}.json"))
    }

    /// Writes the plan, and the images of its materials.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn write_plan(&self, plan: &Plan, images: &[Image]) -> Result<(), TilesError> {
        for (i, image) in images.iter().enumerate() {
            write_file(&self.path.join(format!("image-{i}")), &image.bytes)?;
        }
        write_file(&self.plan_file(), &json(plan))?;
        Ok(())
    }

    /// Reads the plan; `None` if there is none.
    ///
    /// # Errors
    /// Errors of the system, and a damaged plan.
    pub fn plan(&self) -> Result<Option<Plan>, TilesError> {
        let path = self.plan_file();
        match fs::read(&path) {
            Ok(bytes) => {
                serde_json::from_slice(&bytes).map_err(|e| TilesError::damaged(&path, e)).map(Some)
            }
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(TilesError::system(&path, error)),
        }
    }

    /// Returns when the file of the plan was written and how long it is; `None` if there is none.
    pub fn plan_stamp(&self) -> Option<(SystemTime, u64)> {
        let facts = fs::metadata(self.plan_file()).ok()?;
        Some((facts.modified().ok()?, facts.len()))
    }

    /// Reads the images of a plan's materials.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn images(&self, plan: &Plan) -> Result<Vec<Image>, TilesError> {
        let read = |(i, name): (usize, &String)| {
            let path = self.path.join(format!("image-{i}"));
            let bytes = fs::read(&path).map_err(|error| TilesError::system(&path, error))?;
            Ok(Image { name: name.clone(), bytes })
        };
        plan.images.iter().enumerate().map(read).collect()
    }

    /// Reads the pieces of a leaf and joins them.
    ///
    /// # Errors
    /// Errors of the system, and a damaged file.
    pub fn leaf(&self, plan: &Plan, task: usize) -> Result<TileMesh, TilesError> {
        let path = self.scratch();
        let system = |error| TilesError::system(&path, error);
        let mut builder = TileBuilder::new(plan.layout.attributes(), &plan.labels);
        let mut file = File::open(&path).map_err(system)?;
        let blocks = &plan.blocks[plan.tasks[task] as usize];
        let has_materials = !plan.labels.is_empty();
        read_blocks(&mut file, blocks, &plan.layout, has_materials, &mut builder)
            .map_err(system)?;
        Ok(builder.leaf(plan.cell(task)?))
    }

    /// Returns the record of a tile; `None` if it is not done.
    pub fn record(&self, cell: Cell) -> Option<TileRecord> {
        let record: TileRecord =
            serde_json::from_slice(&fs::read(self.record_file(cell)).ok()?).ok()?;
        let length = fs::metadata(self.content(cell)).ok()?.len();
        (record.cell == cell && length == record.bytes).then_some(record)
    }

    /// Reads the mesh of a tile; `None` if it is not there, or not as its record says.
    pub fn mesh(&self, plan: &Plan, record: &TileRecord) -> Option<TileMesh> {
        let bytes = fs::read(self.mesh_file(record.cell)).ok()?;
        let is_same = crc32fast::hash(&bytes) == record.checksum;
        is_same.then(|| tile_file::decode(&bytes, &plan.layout, &plan.labels)).flatten()
    }

    /// Writes what was made of a tile, its record last.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn write_tile(
        &self,
        plan: &Plan,
        (tile, content): (&TileMesh, &[u8]),
        record: TileRecord,
    ) -> Result<TileRecord, TilesError> {
        let mesh = tile_file::encode(tile, &plan.layout);
        let record =
            TileRecord { bytes: content.len() as u64, checksum: crc32fast::hash(&mesh), ..record };
        write_file(&self.content(record.cell), content)?;
        write_file(&self.mesh_file(record.cell), &mesh)?;
        write_file(&self.record_file(record.cell), &json(&record))?;
        Ok(record)
    }

    /// Removes all files of the plan, and the folder if nothing else is in it.
    pub fn remove(&self) {
        self.forget_tiles();
        let images = fs::read_dir(&self.path).into_iter().flatten().flatten();
        let is_image = |name: &str| name.starts_with("image-") || name.starts_with(".pieces.");
        let images = images
            .map(|entry| entry.path())
            .filter(|path| path.file_name().and_then(|name| name.to_str()).is_some_and(is_image));
        for file in images.chain([self.scratch(), self.plan_file(), self.lock_file()]) {
            let _ = fs::remove_file(file);
        }
        let _ = fs::remove_dir(&self.path);
    }

    /// Removes all tiles that were made, as of another plan.
    pub fn forget_tiles(&self) {
        for part in [self.path.join("tiles"), self.content_folder()] {
            let _ = fs::remove_dir_all(part);
        }
    }

    /// Returns true if the folder is there and holds anything but files of a plan: a plan is made in
    /// a folder of its own, as its files are replaced and removed.
    pub fn is_foreign(&self) -> bool {
        let is_plan =
            ["plan.json", "lock", "pieces"].iter().any(|name| self.path.join(name).exists());
        let is_used = fs::read_dir(&self.path).is_ok_and(|mut entries| entries.next().is_some());
        is_used && !is_plan
    }

    /// Takes contents back from a folder that they were moved to, where that is so: tiles were done
    /// up to the root, whose content is there and not here.
    pub fn take_back(&self, root: Cell, from: &Path) {
        let content = self.content(root);
        let is_there = content.file_name().is_some_and(|name| from.join(name).exists());
        if is_there && self.record_file(root).exists() && !content.exists() {
            // Where that fails, the tiles are made anew.
            let _ = fs::remove_dir(self.content_folder());
            let _ = fs::rename(from, self.content_folder());
        }
    }

    /// Removes the record of a tile, so that it is made anew.
    pub fn forget_record(&self, cell: Cell) {
        let _ = fs::remove_file(self.record_file(cell));
    }

    /// Removes the mesh of a tile that nothing is made from any more.
    pub fn forget_mesh(&self, cell: Cell) {
        // It would only take space.
        let _ = fs::remove_file(self.mesh_file(cell));
    }
}

fn json(value: &impl Serialize) -> Vec<u8> {
    serde_json::to_vec(value).expect("plans and records are plain data")
}
