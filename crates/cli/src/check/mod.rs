//! Output of `check`: findings collected in one pass, shown as JSON, as text and as a page.
//!
//! An [`Inspection`](inspection::Inspection) holds the results; [`report`], [`text`] and [`page`]
//! show them by [`group`], each with its [`advice`]. [`Sites`](sites::Sites) map ids of the
//! flattened scene to those of its meshes. [`lock_file`] writes and reads locks.
//!
//! | files, in reading order | hold |
//! |---|---|
//! | `inspection`, `sites`, `places` | findings, and where they are |
//! | `advice`, `proof`, `tileset` | what they mean, and levels without cracks |
//! | `report`, `text` | JSON and text |
//! | `marks`, `drawing`, `findings`, `page` | pictures and the page |
//! | `lock_file` | locks |

mod advice;
pub mod drawing;
mod findings;
pub mod inspection;
pub mod lock_file;
mod marks;
pub mod page;
mod places;
pub mod proof;
pub mod report;
pub mod sites;
pub mod text;
pub mod tileset;
