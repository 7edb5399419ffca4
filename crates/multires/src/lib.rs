//! Every level of a triangle mesh in one structure, asked where it matters.
//!
//! An **update** is a local change between a coarse side and a fine side with the same boundary. Updates
//! need each other: what takes a triangle away comes after what makes it. A set of updates that has with
//! each all that it needs is a **cut**, and gives one mesh without a crack. That partial order is the MT
//! ([`Explicit`] stores it as it is, triangles and all).
//!
//! A simplification is such an order read backwards: its contractions are the updates. [`Forest`] is the
//! record of one; [`Implicit`] packs it into 40 bytes a vertex, or 22, and stores no triangle but the coarsest;
//! [`Model`] adds the lists that make extraction fast. Asked with a [`Query`], it answers in several ways:
//!
//! | | gives | for |
//! |---|---|---|
//! | [`Cut`] | the smallest cut, changed by the next query | what moves; what has no room for more |
//! | [`Extractor::exact`] | the smallest cut | any query, from scratch |
//! | [`Extractor::saturated`] | a cut a few percent larger | cameras, faster: no update asks for others |
//! | [`Extractor::uniform`] | the smallest cut | one tolerance everywhere: only errors are looked at |
//! | [`Extractor::at_most`] | the best cut of so many faces | budgets |
//!
//! What a [`Cut`] has at a place, [`Cut::level_within`] and [`Cut::locate`] find.
//!
//! ```
//! use meshlod_samples as samples;
//! use meshlod_multires::{Forest, Model, Query, UpdateLimits, ViewCamera};
//! use meshlod_simplify::Options;
//!
//! let mesh = samples::torus(5000);
//! let forest = Forest::new(&mesh, &Options::default())?;
//! let model = Model::new(&forest)?;
//! assert_eq!(model.implicit().certify()?.sound, forest.update_count());
//!
//! // Near the camera fine, far from it coarse.
//! let near = ViewCamera {
//!     eye: [2.0, 0.0, 1.0],
//!     look: [0.0; 3],
//!     up: [0.0, 0.0, 1.0],
//!     fov_rad: 0.8,
//!     viewport: [1920, 1080],
//! };
//! let mut cut = model.cut();
//! cut.update(&Query::pixels(near, 1.0), &UpdateLimits::default())?;
//! let faces = cut.face_count();
//!
//! // A step back: what changes is told triangle by triangle.
//! let far = ViewCamera { eye: [4.0, 0.0, 2.0], ..near };
//! cut.update(&Query::pixels(far, 1.0), &UpdateLimits::default())?;
//! assert!(cut.face_count() < faces && cut.patches().count() > 0);
//!
//! // The same mesh at once, by the face list.
//! let level = model.extractor().uniform(0.01)?.mesh();
//! assert!(level.faces.len() < mesh.faces.len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`Archive`] is all of it as a `.mlod` file, of which a query reads what it needs.
//!
//! A mesh that is a height field on a grid needs no record: [`Rtin`] has its levels by
//! arithmetic, in ten bytes a vertex, with errors that are bounds. docs/notes/rtin.md tells how.
//!
//! Positions are kept as `f32` about the middle of the mesh, those of the input to the bit where that is
//! asked for ([`Forest::lossless`]); errors are the simplification's estimates,
//! made monotone, maybe evened out ([`Forest::even_out`]), or proven bounds ([`Forest::measure_bounds`]). docs/notes/multires.md has the rules,
//! and why they suffice.
#![forbid(unsafe_code)]

mod bounds;
mod cut;
mod explicit;
mod file;
mod forest;
mod frame;
mod implicit;
mod level;
mod model;
mod pack;
mod query;
mod rtin;

#[cfg(test)]
mod tests;

pub use bounds::ErrorKind;
pub use cut::{Certificate, CertifyError, Cut, CutChange, Flaw, Located, Patch, UpdateLimits};
pub use explicit::{Explicit, ExplicitCut};
pub use file::{Archive, Extract, FileError, ModelFile, Source, Storage};
pub use forest::{BuildError, Forest, Recorder};
pub use frame::Frame;
pub use implicit::{Extractor, Implicit, SplitRule};
pub use level::Level;
pub use model::{Model, ModelBytes};
pub use query::{Focus, Query, QueryError, Tolerance, ViewCamera};
pub use rtin::{
    FieldBytesError, Fit, HeightField, HeightFieldError, HeightPrecision, Rtin, RtinCertifyError,
    RtinExtractor, RtinFlaw,
};
