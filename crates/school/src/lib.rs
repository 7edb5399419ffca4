//! Schools that swim: a simulation, scenes with a camera, recordings, and an evaluation of the
//! policies of [`meshlod::flock`].
//!
//! A [`scene::Film`] is a school and a camera, frame by frame; a
//! [`Selector`](meshlod::flock::select::Selector) chooses a level for every member:
//!
//! ```
//! use std::sync::Arc;
//! use meshlod::flock::levels::{ChainOptions, LevelTable, Look, ModelAxes};
//! use meshlod::flock::select::{Budget, PolicyName, Selector};
//! use meshlod_school::scene::{Film, Scenario, ScenarioName, ScenarioOptions};
//!
//! let fish = meshlod::samples::fish(2_000);
//! let options = ChainOptions { axes: ModelAxes::FISH, ..ChainOptions::default() };
//! let table = Arc::new(LevelTable::new(&fish, &Look::default(), &options)?);
//! let mut selector = Selector::new(PolicyName::Ours, table);
//! let budget = Budget { triangles: 10_000, ..Budget::default() };
//!
//! let mut film = Film::new(Scenario::named(ScenarioName::Ring, &ScenarioOptions::default())?)?;
//! let (flock, camera) = film.next_frame()?;
//! let levels = selector.select(flock, &camera, &budget);
//! assert_eq!(levels.len(), 150);
//! assert!(selector.triangles() <= 10_000);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The modules, from the bottom up:
//! - [`simulation`]: members that follow their leaders round obstacles;
//! - [`scene`]: named scenarios, each with obstacles and the path of a camera;
//! - [`recording`]: trajectories, cameras and levels as files that others can read;
//! - [`evaluate`]: triangles against image error, for every policy on the same [`Footage`].
//!
//! Lengths are in body lengths of a member: the longest side of the model's box is 1. Options of
//! scenarios and evaluations are read and written by serde, except the terrain that
//! [`scene::ScenarioOptions`] borrows. [`simulation::SimulationOptions`] stays in code: its schools
//! and obstacles hold paths and distance fields that are prepared in advance.
#![forbid(unsafe_code)]

pub mod evaluate;
mod footage;
pub mod recording;
pub mod scene;
pub mod simulation;

pub use footage::Footage;
