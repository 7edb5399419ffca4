//! Pages that hold levels against their input: what `compare` and `demo` have in common.
//!
//! A [`Subject`](subject::Subject) is a mesh and how it is shown; a [`Descent`](descent::Descent)
//! takes it down by one method and gives a [`Level`](descent::Level) at every stop, with all that is
//! measured of it; a [`Studio`](studio::Studio) takes the pictures. [`columns`] is the table of the
//! figures: pages, terminal and the marks for the best come from that one list. The rest is markup.

pub mod chart;
pub mod columns;
pub mod counts;
pub mod descent;
pub mod document;
pub mod facts;
pub mod figures;
pub mod heat;
pub mod key;
pub mod level_json;
pub mod look;
mod refine;
pub mod strip;
pub mod studio;
pub mod subject;
pub mod table;
