//! Tests of the program from outside: exit codes, streams, files.

mod check;
mod compare;
mod compress;
mod constraints;
mod damaged_models;
mod demo;
mod error_bound;
mod flock;
mod hostile;
mod kept_error;
mod levels;
mod model_scenes;
mod models;
mod pipes;
mod queries;
mod repair;
mod run;
mod sides;
mod strip;
mod topology;
mod usage;
mod verbs;
mod view;
mod view_school;
mod volume;
