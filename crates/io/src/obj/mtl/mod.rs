//! MTL material libraries; every statement is kept.
//!
//! Unknown lines are kept as they are. Statements are interpreted as in [Ram95]; `Pr`, `Pm`, `Ke`
//! and `norm` as by the exporters that introduced them.

mod images;
mod lines;
mod meaning;
mod properties;
mod read;
mod statement;
mod write;

pub(crate) use meaning::mtl_losses;
pub(super) use read::resolve_materials;
pub(crate) use read::{Library, library_names};
pub(super) use write::names;
pub(crate) use write::one_line;
pub use write::write;
pub(crate) use write::{defined, is_superset, own_definitions, same_library, write_definitions};
