//! Recording of a film, for `--record`.

use std::path::{Path, PathBuf};

use meshlod::IoError;
use meshlod::flock::levels::LevelTable;
use meshlod::flock::select::InstanceLevel;
use meshlod::flock::{Flock, FlockCamera};
use meshlod::io::write_file;
use meshlod_school::recording::{Recording, Selection, write_levels};
use meshlod_school::scene::Scenario;

use crate::session::Session;
use crate::session::failure::Failure;
use crate::session::files;
use crate::text::numbers::count;

/// Frames of a film while they are recorded.
pub struct Recorder {
    folder: PathBuf,
    recording: Recording,
    selection: Selection,
}

/// Greatest number of members in all frames: they take 30 bytes each.
const MOST: usize = 100_000_000;

/// Fails if the folder is a file, or the recording too large.
pub fn check(folder: &Path, members: usize, frames: usize) -> Result<(), Failure> {
    match members.saturating_mul(frames) > MOST {
        false => files::check_folder(folder),
        true => Err(Failure::usage(format_args!(
            "--record: {} members in {} frames are too many; their product must be at most {}",
            count(members),
            count(frames),
            count(MOST)
        ))),
    }
}

impl Recorder {
    /// Starts a recording; `model` is the file of the members' model.
    pub fn new(folder: &Path, scenario: &Scenario, model: Option<&Path>) -> Self {
        let name = model.and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
        let recording = Recording::new(scenario, name);
        let selection = Selection::new(recording.scene().members);
        Self { folder: folder.into(), recording, selection }
    }

    /// Adds a frame.
    pub fn push(&mut self, flock: &Flock, camera: &FlockCamera, levels: &[InstanceLevel]) {
        self.recording.push(flock, camera);
        self.selection.push(levels);
    }

    /// Writes all files.
    pub fn write(&self, table: &LevelTable, session: &Session) -> Result<(), Failure> {
        session.progress.stage(&format!("writing {}", files::name(&self.folder)));
        files::make_folder(&self.folder)?;
        let put = |name: &str, bytes: &[u8]| -> Result<(), IoError> {
            write_file(&self.folder.join(name), bytes)
        };
        write_levels(table, put)?;
        self.selection.write(put)?;
        Ok(self.recording.write(put)?)
    }
}
