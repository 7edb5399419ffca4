//! MTL material libraries, of which every statement is kept.

mod lines;
mod meaning;
mod read;
mod statement;
mod write;

pub(crate) use meaning::untold;
pub(crate) use read::Library;
pub(super) use read::resolve_materials;
pub use write::write;
pub(crate) use write::{is_superset, same_library, says_nothing};
pub(super) use write::{names, one_line};
