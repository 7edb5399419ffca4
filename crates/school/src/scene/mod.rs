//! Scenarios: schools, obstacles, and the path of a camera.
//!
//! Five scenarios have names, see [`ScenarioName`]. Each one scales with the number of members, so
//! that a school of ten and one of ten thousand fill the picture alike. A [`Film`] runs a scenario
//! frame by frame:
//!
//! ```
//! use meshlod_school::scene::{Film, Scenario, ScenarioName, ScenarioOptions};
//!
//! let options = ScenarioOptions { members: 40, ..ScenarioOptions::default() };
//! let scenario = Scenario::named(ScenarioName::Obstacles, &options)?;
//! let mut film = Film::new(scenario)?;
//! for _ in 0..3 {
//!     let (flock, camera) = film.next_frame()?;
//!     assert_eq!((flock.members.len(), camera.size()), (40, [960, 540]));
//! }
//! # Ok::<(), meshlod_school::scene::SceneError>(())
//! ```
//!
//! To read: `scenario`, the recipe; `setting` with one file a scenario (`ring`, `obstacle_course`,
//! `terrain`), which place schools on `lanes` above the `ground`; `shot`, the camera; `film`, the
//! run; `obstacle` and `solid`, what stands in the way and its meshes.

mod error;
mod film;
mod ground;
mod lanes;
mod name;
mod obstacle;
mod obstacle_course;
mod ring;
mod scenario;
mod setting;
mod shot;
mod solid;
mod terrain;

pub use error::SceneError;
pub use film::Film;
pub use name::ScenarioName;
pub use obstacle::SceneObstacle;
pub use scenario::{Scenario, ScenarioOptions};
