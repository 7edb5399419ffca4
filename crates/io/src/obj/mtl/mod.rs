//! MTL material libraries, of which every statement is kept.
//!
//! A line that is not known is kept as it is. What the known ones mean, [Ram95] says, and for `Pr`,
//! `Pm`, `Ke` and `norm`, the exporters that brought them in.

mod images;
mod lines;
mod meaning;
mod properties;
mod read;
mod statement;
mod write;

pub(crate) use meaning::untold;
pub(super) use read::resolve_materials;
pub(crate) use read::{Library, library_names};
pub(super) use write::names;
pub(crate) use write::one_line;
pub use write::write;
pub(crate) use write::{defined, is_superset, own_definitions, same_library, write_definitions};
