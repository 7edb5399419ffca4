//! Folder of a plan: files whose names say what is in them, so that what is done is there.

mod block_file;
mod names;
pub mod record;
mod sealed;
mod tile_file;

use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use meshlod_io::{Image, remove_abandoned, write_file};

use crate::cell::Cell;
use crate::error::TilesError;
use crate::plan::{Look, Plan, PlanImage};
use crate::scratch::read_blocks;
use crate::texture::DecodedImages;
use crate::tile::{TileBuilder, TileMesh};

use names::{first, is_image};
use record::TileRecord;
use sealed::{SEAL, seal, unseal};

pub use names::{has_other_files, is_of_tile, remove_tiles, remove_where};

/// Folder of a plan.
#[derive(Clone, Debug)]
pub struct Folder {
    path: PathBuf,
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
        let file = File::options().create(true).append(true).open(&lock);
        file.map(drop).map_err(|error| TilesError::system(&lock, error))
    }

    /// Returns the path of the file that a process locks while it works on the plan.
    pub fn lock_file(&self) -> PathBuf {
        self.path.join("lock")
    }

    /// Returns the path of the file that a process locks for a run of several steps.
    pub fn run_file(&self) -> PathBuf {
        self.path.join("run")
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

    fn blocks_file(&self) -> PathBuf {
        self.path.join("blocks")
    }

    fn image_file(&self, image: usize) -> PathBuf {
        self.path.join(format!("image-{image}"))
    }

    /// Writes the plan, the blocks of its leaves and the images of its materials.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn write_plan(&self, plan: &Plan, images: &[Image]) -> Result<(), TilesError> {
        for (i, image) in images.iter().enumerate() {
            write_file(&self.image_file(i), &image.bytes)?;
        }
        write_file(&self.blocks_file(), &block_file::encode(plan))?;
        write_file(&self.plan_file(), &seal(plan))?;
        Ok(())
    }

    /// Reads the plan; `None` if there is none.
    ///
    /// # Errors
    /// Errors of the system, and a damaged plan.
    pub fn plan(&self) -> Result<Option<Plan>, TilesError> {
        let path = self.plan_file();
        let bytes = match fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(TilesError::system(&path, error)),
        };
        let plan: Plan = unseal(&bytes).map_err(|reason| TilesError::damaged(&path, reason))?;
        match plan.is_sound() {
            true => Ok(Some(plan)),
            false => Err(TilesError::damaged(&path, "is not a plan of tiles")),
        }
    }

    /// Returns when the file of the plan was written and how long it is; `None` if there is none.
    pub fn plan_stamp(&self) -> Option<(SystemTime, u64)> {
        let facts = fs::metadata(self.plan_file()).ok()?;
        Some((facts.modified().ok()?, facts.len()))
    }

    /// Returns the materials of a plan's model. Their images are read when a tile needs them.
    pub fn look(&self, plan: &Plan) -> Look {
        let image = |own: &PlanImage| Image { name: own.name.clone(), bytes: Vec::new() };
        let files = plan.images.iter().enumerate();
        let files = files.map(|(i, image)| (self.image_file(i), image.checksum)).collect();
        Look {
            labels: plan.labels.clone(),
            materials: plan.materials.clone(),
            images: plan.images.iter().map(image).collect(),
            decoded: DecodedImages::of_files(files),
        }
    }

    /// Reads the pieces of a leaf and joins them.
    ///
    /// # Errors
    /// Errors of the system, and a damaged file.
    pub fn leaf(&self, plan: &Plan, task: usize) -> Result<TileMesh, TilesError> {
        let blocks = match plan.blocks.get(plan.tasks[task] as usize) {
            Some(blocks) => blocks.clone(),
            None => block_file::read(&self.blocks_file(), task, plan.tasks.len())?,
        };
        let path = self.scratch();
        let mut builder = TileBuilder::new(plan.layout.attributes(), &plan.labels);
        let mut file = File::open(&path).map_err(|error| TilesError::system(&path, error))?;
        let has_materials = !plan.labels.is_empty();
        let read = read_blocks(&mut file, &blocks, &plan.layout, has_materials, &mut builder);
        read.map_err(|error| match error.kind() {
            ErrorKind::InvalidData | ErrorKind::UnexpectedEof => TilesError::damaged(&path, error),
            _ => TilesError::system(&path, error),
        })?;
        Ok(builder.leaf(plan.cell(task)?))
    }

    /// Returns the record of a tile whose content is there; `None` if it has none.
    ///
    /// # Errors
    /// A task that there is not, and a record or content that is not as it was written.
    pub fn record(&self, plan: &Plan, task: usize) -> Result<Option<TileRecord>, TilesError> {
        let cell = plan.cell(task)?;
        let path = self.record_file(cell);
        let damaged = |path| Err(TilesError::DamagedTile { path, task });
        let Some(bytes) = read_if_there(&path)? else { return Ok(None) };
        let Ok(record) = unseal::<TileRecord>(&bytes) else { return damaged(path) };
        if record.cell != cell {
            return damaged(path);
        }
        let content = self.content(cell);
        match fs::metadata(&content) {
            Ok(facts) if facts.len() == record.bytes => Ok(Some(record)),
            Err(error) if !is_missing(&error) => Err(TilesError::system(&content, error)),
            _ => damaged(content),
        }
    }

    /// Checks the bytes of the content of a tile.
    ///
    /// # Errors
    /// A content that is not as it was written, and errors of the system.
    pub fn check_content(&self, task: usize, record: &TileRecord) -> Result<(), TilesError> {
        let path = self.content(record.cell);
        let is_same = |bytes: Vec<u8>| crc32fast::hash(&bytes) == record.content_checksum;
        match read_if_there(&path)?.is_some_and(is_same) {
            true => Ok(()),
            false => Err(TilesError::DamagedTile { path, task }),
        }
    }

    /// Reads the mesh of a tile.
    ///
    /// # Errors
    /// A file that is not there, or not as it was written, and errors of the system.
    pub fn mesh(
        &self,
        plan: &Plan,
        task: usize,
        record: &TileRecord,
    ) -> Result<TileMesh, TilesError> {
        let bytes = self.mesh_bytes(record)?;
        let mesh = bytes.and_then(|bytes| tile_file::decode(&bytes, &plan.layout, &plan.labels));
        mesh.ok_or_else(|| TilesError::DamagedTile { path: self.mesh_file(record.cell), task })
    }

    fn mesh_bytes(&self, record: &TileRecord) -> Result<Option<Vec<u8>>, TilesError> {
        let bytes = read_if_there(&self.mesh_file(record.cell))?;
        Ok(bytes.filter(|bytes| crc32fast::hash(bytes) == record.mesh_checksum))
    }

    /// Returns the record of a tile if all that was made of it is there, as it was written.
    ///
    /// # Errors
    /// A task that there is not, and files that are there and cannot be read.
    pub fn done(&self, plan: &Plan, task: usize) -> Result<Option<TileRecord>, TilesError> {
        let Some(record) = self.shown(plan, task)? else { return Ok(None) };
        Ok(self.mesh_bytes(&record)?.map(|_| record))
    }

    /// Returns the record of a tile if its content is there, as it was written; its mesh need not be.
    ///
    /// # Errors
    /// As [`Folder::done`].
    pub fn shown(&self, plan: &Plan, task: usize) -> Result<Option<TileRecord>, TilesError> {
        let checked = self.record(plan, task).and_then(|record| match record {
            Some(record) => self.check_content(task, &record).map(|()| Some(record)),
            None => Ok(None),
        });
        match checked {
            Err(TilesError::DamagedTile { .. }) => Ok(None),
            checked => checked,
        }
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
        let record = TileRecord {
            bytes: content.len() as u64,
            content_checksum: crc32fast::hash(content),
            mesh_checksum: crc32fast::hash(&mesh),
            ..record
        };
        write_file(&self.content(record.cell), content)?;
        write_file(&self.mesh_file(record.cell), &mesh)?;
        write_file(&self.record_file(record.cell), &seal(&record))?;
        Ok(record)
    }

    /// Removes all files of the plan, and the folder if nothing else is in it.
    pub fn remove(&self) {
        self.forget_plan();
        self.forget_tiles();
        let _ = fs::remove_file(self.run_file());
        let _ = fs::remove_file(self.lock_file());
        let _ = fs::remove_dir(&self.path);
    }

    /// Removes the plan and what belongs to it, also what a process left that was ended early.
    pub fn forget_plan(&self) {
        // The plan goes first: without it, nothing is taken for done.
        let named = [self.plan_file(), self.blocks_file(), self.scratch()];
        named.iter().for_each(|path| drop(fs::remove_file(path)));
        let parts = fs::read_dir(&self.path).into_iter().flatten().flatten();
        let is_part = |name: &str| is_image(name) || name.starts_with(".pieces.");
        for part in parts.filter(|entry| entry.file_name().to_str().is_some_and(is_part)) {
            let _ = fs::remove_file(part.path());
        }
        remove_abandoned(named.iter().map(|path| &**path));
    }

    /// Removes all tiles that were made, as of another plan.
    pub fn forget_tiles(&self) {
        for part in [self.path.join("tiles"), self.content_folder()] {
            remove_tiles(&part);
        }
    }

    /// Removes contents that processes which were ended have begun.
    pub fn forget_unfinished(&self) {
        remove_where(&self.content_folder(), |name| name.starts_with('.') && is_of_tile(name));
    }

    /// Returns true if the folder is there and holds anything but files of a plan: a plan is made in
    /// a folder of its own, as its files are replaced and removed.
    pub fn is_foreign(&self) -> bool {
        let mut entries = fs::read_dir(&self.path).into_iter().flatten().flatten();
        let is_foreign = |name: &str| {
            let name = name.strip_prefix('.').unwrap_or(name);
            let stem = if name.starts_with("plan.json") { "plan.json" } else { first(name) };
            let named = ["plan.json", "blocks", "pieces", "lock", "run", "tiles", "content"];
            !named.contains(&stem) && !is_image(name)
        };
        let is_plan = |bytes: Vec<u8>| bytes.is_empty() || bytes.starts_with(SEAL);
        let inner = ["tiles", "content"].map(|name| self.path.join(name));
        entries.any(|entry| entry.file_name().to_str().is_none_or(is_foreign))
            || inner.iter().any(|inner| has_other_files(inner))
            || fs::read(self.plan_file()).is_ok_and(|bytes| !is_plan(bytes))
    }

    /// Takes contents back from a folder that they were moved to, where that is so: tiles were done
    /// up to the root, whose content is there and not here.
    pub fn take_back(&self, root: Cell, from: &Path) {
        let content = self.content(root);
        let record = fs::read(self.record_file(root)).ok();
        let record = record.and_then(|bytes| unseal::<TileRecord>(&bytes).ok());
        let there = content.file_name().and_then(|name| fs::read(from.join(name)).ok());
        let is_own = record
            .zip(there)
            .is_some_and(|(record, bytes)| crc32fast::hash(&bytes) == record.content_checksum);
        if is_own && !content.exists() {
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

/// Reads a file; `None` if there is none.
fn read_if_there(path: &Path) -> Result<Option<Vec<u8>>, TilesError> {
    match fs::read(path) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(error) if is_missing(&error) => Ok(None),
        Err(error) => Err(TilesError::system(path, error)),
    }
}

fn is_missing(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_of_a_plan_are_ours() {
        let ours = ["2-0-3-1.glb", ".2-0-3-1.glb.77-0", "0-0-0-0.json", "10-1-2-3.mesh"];
        let foreign =
            ["wall.png", "2-0-3.glb", "2-0-3-1.glb.bak", "2-0-3-x.glb", "1-1-1-1.txt", ""];
        assert!(ours.into_iter().all(is_of_tile) && !foreign.into_iter().any(is_of_tile));
        assert!(is_image("image-0") && is_image(".image-12.77-0"));
        assert!(!is_image("image-1.png") && !is_image("image-") && !is_image("image-a"));

        let temporary = tempfile::tempdir().unwrap();
        let folder = Folder::new(temporary.path());
        folder.make().unwrap();
        assert!(!folder.is_foreign());
        let article = folder.path().join("content/article.md");
        fs::write(&article, "text").unwrap();
        assert!(folder.is_foreign());
        folder.remove();
        assert!(article.exists());
        fs::remove_file(article).unwrap();
        assert!(!folder.is_foreign());
        fs::write(folder.path().join("plan.json"), "{}").unwrap();
        assert!(folder.is_foreign());
        fs::remove_file(folder.path().join("plan.json")).unwrap();
        assert!(!folder.is_foreign());
        fs::write(folder.path().join("image-1.png"), "png").unwrap();
        assert!(folder.is_foreign());
    }
}
