//! Commands of the program, one per file: arguments, work, answer.
//!
//! | files, in reading order | hold |
//! |---|---|
//! | `simplify`, `lods` | levels |
//! | `build`, `extract` | all levels in one file |
//! | `tiles` | models of any size |
//! | `strip`, `compress`, `decompress`, `convert` | other forms |
//! | `check`, `repair`, `measure`, `info` | what a mesh is |
//! | `render`, `view`, `flock` | pictures |
//! | `serve`, `page` | models in a browser |
//! | `batch`, `run`, `sample` | many files, recipes, samples |

pub mod batch;
pub mod build;
pub mod check;
pub mod completions;
pub mod compress;
pub mod convert;
pub mod decompress;
pub mod extract;
pub mod flock;
pub mod info;
pub mod lods;
pub mod man;
pub mod measure;
pub mod page;
pub mod render;
pub mod repair;
pub mod run;
pub mod sample;
pub mod serve;
pub mod simplify;
pub mod strip;
pub mod tiles;
pub mod view;
