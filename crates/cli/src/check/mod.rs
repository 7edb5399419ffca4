//! What `check` says: findings gathered in one pass, told as JSON, as text, as a page.
//!
//! An [`Inspection`](inspection::Inspection) is all that is kept of a check; [`report`], [`text`] and
//! [`page`] tell of it. [`Sites`](sites::Sites) turn ids of the flattened scene into those of its
//! meshes. [`lock_file`] is beside them: locks as a file, out and in.

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
