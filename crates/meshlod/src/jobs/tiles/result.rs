//! Tilesets put where they belong: in a folder, or in one file.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use meshlod_io::{IoError, remove_abandoned, write_file, write_file_with};
use meshlod_tiles::TilesError;
use meshlod_tiles::archive::ArchiveWriter;
use meshlod_tiles::folder::{Folder, is_of_tile, remove_tiles, remove_where};
use meshlod_tiles::tileset::Finished;

/// Folder of the contents in that of the tileset.
pub(super) const TILES: &str = "tiles";

/// Writes a tileset as an archive.
pub(super) fn write_archive(
    finished: &Finished,
    folder: &Folder,
    out: &Path,
) -> Result<(), TilesError> {
    remove_abandoned([out]);
    let written = write_file_with(out, |file| {
        let mut archive = ArchiveWriter::new(file);
        for file in &finished.files {
            archive.add(&file.name, &file.text)?;
        }
        for record in &finished.records {
            let path = folder.content(record.cell);
            let named = |error| io::Error::other(IoError::system(&path, error));
            let bytes = fs::read(&path).map_err(named)?;
            archive.add(&format!("{TILES}/{}.glb", record.cell), &bytes)?;
        }
        archive.finish()
    });
    Ok(written?)
}

/// Writes a tileset to a folder, `tileset.json` last.
pub(super) fn write_folder(
    finished: &Finished,
    folder: &Folder,
    out: &Path,
) -> Result<(), TilesError> {
    let tiles = out.join(TILES);
    folder.forget_unfinished();
    fs::create_dir_all(out).map_err(|error| TilesError::system(out, error))?;
    // Nothing refers to tiles that are of two tilesets, if the process ends here.
    remove_where(out, |name| name == "tileset.json" || is_of_tile(name));
    place(&folder.content_folder(), &tiles)?;
    for file in finished.files.iter().rev() {
        write_file(&out.join(&file.name), &file.text)?;
    }
    Ok(())
}

/// Puts a folder in the place of another one; copies it if that is on another disk.
fn place(from: &Path, to: &Path) -> Result<(), TilesError> {
    let system = |error| TilesError::system(to, error);
    // Renamed in one step, it is at one of the two places if the process ends here.
    match fs::rename(from, to) {
        Err(error) if error.kind() == ErrorKind::CrossesDevices => {}
        Err(error) if error.kind() == ErrorKind::DirectoryNotEmpty => {
            remove_tiles(to);
            return fs::rename(from, to).map_err(system);
        }
        done => return done.map_err(|error| TilesError::system(from, error)),
    }
    let new = Unfinished(to.with_file_name(format!(".{TILES}-{}", std::process::id())));
    copy(from, &new.0)?;
    remove_tiles(to);
    fs::rename(&new.0, to).map_err(system)
}

/// Copies the files of a folder.
fn copy(from: &Path, to: &Path) -> Result<(), TilesError> {
    fs::create_dir_all(to).map_err(|error| TilesError::system(to, error))?;
    for entry in fs::read_dir(from).map_err(|error| TilesError::system(from, error))? {
        let entry = entry.map_err(|error| TilesError::system(from, error))?;
        let target = to.join(entry.file_name());
        fs::copy(entry.path(), &target).map_err(|error| TilesError::system(&target, error))?;
    }
    Ok(())
}

/// Copy in the making, which goes unless it has got its place.
struct Unfinished(PathBuf);

impl Drop for Unfinished {
    fn drop(&mut self) {
        // Nothing is there if all went well.
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_copy_takes_the_place_of_an_old_folder() {
        let folder = tempfile::tempdir().unwrap();
        let [from, to] = ["from", "to"].map(|name| folder.path().join(name));
        for (at, text) in [(&from, "new"), (&to, "old")] {
            fs::create_dir(at).unwrap();
            fs::write(at.join("0-0-0-0.glb"), text).unwrap();
        }
        let part = folder.path().join("part");
        copy(&from, &part).unwrap();
        assert_eq!(fs::read(part.join("0-0-0-0.glb")).unwrap(), b"new");
        assert!(from.join("0-0-0-0.glb").exists());
        place(&from, &to).unwrap();
        assert_eq!(fs::read(to.join("0-0-0-0.glb")).unwrap(), b"new");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2, "part and to");
        fs::write(to.join("wall.png"), "png").unwrap();
        fs::create_dir(&from).unwrap();
        fs::write(from.join("0-0-0-0.glb"), "newer").unwrap();
        assert!(place(&from, &to).is_err() && to.join("wall.png").exists());
        fs::remove_dir_all(&from).unwrap();
        fs::write(to.join("0-0-0-0.glb"), "new").unwrap();
        assert!(place(&from, &to).is_err() && to.join("0-0-0-0.glb").exists());
    }
}
