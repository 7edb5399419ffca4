//! Native part of the Python package `meshlod`: meshes that live in Rust, and what is done to them.
//!
//! The package in `python/meshlod` calls it with arrays that are contiguous and of the right type;
//! what is left to check is their contents. Work runs on threads of its own ([`work`]), without the
//! GIL, while the calling thread looks after Ctrl-C and progress. Copies of whole meshes are made
//! without the GIL too, but for arrays that come in, which others may change, and views of meshes
//! with seams, which are made once.
//!
//! | files, in reading order | hold |
//! |---|---|
//! | `arrays`, `numpy_views`, `mesh`, `scene` | what Python has |
//! | `work`, `lent_out`, `errors` | how work is done |
//! | `files`, `simplify`, `verbs`, `model`, `query`, `cut`, `tiles` | what is done |
//! | `report`, `command` | answers, and the command |

mod arrays;
mod command;
mod cut;
mod errors;
mod files;
mod flock;
mod lent_out;
mod mesh;
mod model;
mod numpy_views;
mod query;
mod report;
mod scene;
mod simplify;
mod tiles;
mod verbs;
mod work;

use pyo3::prelude::*;

/// Functions and classes behind the package `meshlod`.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::command::{
        answer, record_file_of_batch, remove_abandoned, run_command, run_file_of_batch,
    };
    #[pymodule_export]
    use super::cut::NativeCut;
    #[pymodule_export]
    use super::errors::MeshlodError;
    #[pymodule_export]
    use super::files::{load, save};
    #[pymodule_export]
    use super::flock::{NativeFilm, NativeLevelTable, NativeSelector};
    #[pymodule_export]
    use super::mesh::{NativeMesh, from_arrays};
    #[pymodule_export]
    use super::model::{NativeModel, build};
    #[pymodule_export]
    use super::scene::NativeScene;
    #[pymodule_export]
    use super::simplify::{levels, simplify, simplify_scene};
    #[pymodule_export]
    use super::tiles::{
        NativeTilePlan, NativeTileRun, assemble_tiles, plan_tiles, tile_plan_folder, tiles,
    };
    #[pymodule_export]
    use super::verbs::{check, compress, measure, render, repair, sizes, strip};
}
