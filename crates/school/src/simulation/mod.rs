//! Simulation of schools that follow their leaders round obstacles.
//!
//! Each member steers by Reynolds' three rules (keep apart, align, stay together) and towards a
//! slot of its own in an ellipsoid that moves with the leader \[Rey87\] \[CC05\]. Obstacles part a
//! school, and it closes again behind them. Lengths are in body lengths, times in seconds.
//!
//! ```
//! use meshlod::flock::Flock;
//! use meshlod_school::simulation::{Simulation, SimulationOptions};
//!
//! let mut simulation = Simulation::new(&SimulationOptions::default()).unwrap();
//! let steps = simulation.advance(1.0).unwrap();
//! assert_eq!(steps, 60);
//! let mut flock = Flock::default();
//! simulation.snapshot(simulation.alpha(), &mut flock);
//! assert_eq!(flock.members.len(), 150);
//! ```
//!
//! To read, from a step down: `schools`, time and leaders; `step`, all members in parallel over
//! the cells of the `grid`; `motion`, one member, with what `neighbours` and `avoid` (obstacles)
//! ask of it. Before it: `options`, `leader` (paths), `start` with `slots`; `swarm` holds the
//! arrays. Obstacles: `obstacle`, `field` (distances from a mesh, with their `sides`).

mod avoid;
mod error;
mod field;
mod grid;
mod leader;
mod motion;
mod neighbours;
mod obstacle;
mod options;
mod range;
mod schools;
mod sides;
mod slots;
mod snapshot;
mod start;
mod step;
mod swarm;

pub use error::{FieldError, PathError, SimulationError};
pub use field::DistanceField;
pub use leader::{Leader, LeaderPath};
pub use obstacle::{Obstacle, ObstacleDistance, Translate};
pub use options::{Behaviour, SchoolOptions, SimulationOptions, SteerEvery};
pub use schools::Simulation;
pub use step::Looks;
