//! Parts of the HTML pages of `compare` and `demo`, which compare simplified meshes with the
//! original.
//!
//! A [`Subject`](subject::Subject) is a mesh and its style; a [`ChainBuilder`](chain::ChainBuilder)
//! simplifies it by one method and measures a [`Level`](chain::Level) at every size; a
//! [`SubjectRenderer`](renderer::SubjectRenderer) draws the pictures. [`columns`] is the table of
//! figures that pages, terminal and marks for the best share. The rest is markup.
//!
//! | files, in reading order | hold |
//! |---|---|
//! | `subject`, `chain`, `level_figures` | a mesh, its levels and their figures |
//! | `columns`, `figures`, `facts`, `counts`, `refine` | what the figures say |
//! | `renderer`, `picture_row`, `heat`, `key` | pictures |
//! | `document`, `table`, `chart`, `inline_picture`, `style` | markup |

pub mod chain;
pub mod chart;
pub mod columns;
pub mod counts;
pub mod document;
pub mod facts;
pub mod figures;
pub mod heat;
pub mod inline_picture;
pub mod key;
pub mod level_figures;
pub mod picture_row;
mod refine;
pub mod renderer;
pub mod style;
pub mod subject;
pub mod table;
