//! Output of `check`: findings collected in one pass, shown as JSON, as text and as a page.
//!
//! An [`Inspection`](inspection::Inspection) holds the results; [`report`], [`text`] and [`page`]
//! show them. [`Sites`](sites::Sites) map ids of the flattened scene to those of its meshes.
//! [`lock_file`] writes and reads locks.

mod contacts;
mod drawing;
pub mod inspection;
pub mod lock_file;
mod marks;
pub mod page;
pub mod proof;
pub mod report;
pub mod sites;
pub mod text;
