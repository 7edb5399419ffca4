//! Parts of `flock`, which films schools of a model.
//!
//! [`model`] reads the model and finds its [`axes`]; [`shoot`] runs the film and writes its frames
//! with their [`figures`], and [`record`] the files for others; [`summary`] is the answer.
//! [`evaluate`] compares all policies instead.

pub mod axes;
pub mod evaluate;
pub mod figures;
pub mod model;
pub mod names;
pub mod record;
mod sample_fish;
pub mod scene;
pub mod school_args;
pub mod score;
pub mod shoot;
pub mod summary;
