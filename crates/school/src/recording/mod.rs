//! Recordings: trajectories, cameras, levels and selections as files that others can read.
//!
//! A recording is a folder. JSON files describe it, and arrays are NumPy's `.npy` files, little
//! endian and in C order:
//!
//! | file | holds |
//! |---|---|
//! | `scene.json` | version, frames and their time, members, schools, obstacles, model, seed |
//! | `positions.npy` | `f4 [frames, members, 3]`, in body lengths |
//! | `headings.npy` | `f4 [frames, members, 3]`, unit vectors |
//! | `speeds.npy` | `f4 [frames, members]`, in body lengths a second |
//! | `leaders.npy` | `f4 [frames, schools, 6]`: position and heading of each leader |
//! | `cameras.json` | eye, axes, field of view and picture size of every frame |
//! | `levels.json` | levels and chains of the model; layers of its vertices |
//! | `vertices.npy`, `triangles.npy` | `f4 [vertices, 3]` and `u4 [triangles, 3]` of all levels |
//! | `selection.npy` | `u2 [frames, members]`: levels chosen; 65535 is hidden, 65534 an impostor |
//!
//! The format is described in full in `docs/notes/flock-recordings.md`. This module touches no
//! files: writers pass names and bytes to a closure, readers request bytes by name from one.
//!
//! ```
//! use std::collections::BTreeMap;
//! use meshlod_school::recording::{Recording, Source};
//! use meshlod_school::scene::{Film, Scenario, ScenarioName, ScenarioOptions};
//!
//! let options = ScenarioOptions { members: 10, ..ScenarioOptions::default() };
//! let mut film = Film::new(Scenario::named(ScenarioName::Ring, &options)?)?;
//! let mut recording = Recording::new(film.scenario(), None);
//! for _ in 0..4 {
//!     let (flock, camera) = film.next_frame()?;
//!     recording.push(flock, &camera);
//! }
//! let mut folder = BTreeMap::new();
//! recording.write(|name: &str, bytes: &[u8]| -> Result<(), ()> {
//!     folder.insert(name.to_owned(), bytes.to_vec());
//!     Ok(())
//! }).unwrap();
//!
//! let mut source = Source::new(|name| folder.get(name).cloned().ok_or("no such file".into()));
//! let read = Recording::read(&mut source)?;
//! assert_eq!((read.frames(), read.flock(2)), (4, recording.flock(2)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cameras;
mod error;
mod json;
mod level_files;
mod level_reader;
mod limits;
pub mod npy;
mod scene_file;
mod selection;
mod source;
#[cfg(test)]
mod tests;
mod trajectory;

pub use error::RecordingError;
pub use level_files::write_levels;
pub use level_reader::read_levels;
pub use limits::VERSION;
pub use scene_file::RecordedScene;
pub use selection::Selection;
pub use source::Source;
pub use trajectory::Recording;
