//! Multiresolution triangle meshes: every level in one structure, as fine as each query needs.
//!
//! An **update** is a local change between a coarse side and a fine side with the same boundary.
//! One update depends on another if it replaces a triangle that the other creates. A set of updates
//! that contains all its dependencies is a **cut**, and gives one mesh without cracks. This partial
//! order is the multi-triangulation, or MT ([`Explicit`] stores it literally, with all triangles).
//!
//! A simplification is such an order read backwards: its contractions are the updates. [`Forest`]
//! records one. [`Implicit`] packs it into 40 bytes per vertex, or 22, and stores no triangles but
//! the coarsest. [`Model`] adds tables for fast extraction. A [`Query`] can be answered in several
//! ways:
//!
//! | | result | use |
//! |---|---|---|
//! | [`Cut`] | the smallest cut, updated by each query | moving viewpoints; least memory |
//! | [`Geomorph`] | the smallest cut, to which vertices move | viewers in which nothing pops |
//! | [`Extractor::exact`] | the smallest cut | any query, from scratch |
//! | [`Extractor::saturated`] | a cut a few percent larger | cameras, faster |
//! | [`Extractor::uniform`] | the smallest cut | one tolerance everywhere: only errors matter |
//! | [`Extractor::at_most`] | the best cut within a face budget | budgets |
//!
//! [`Cut::level_within`] and [`Cut::locate`] answer spatial queries on a cut. The triangles of a
//! cut lie in slots, of which an update changes some: see [`SlotMesh`].
//!
//! ```
//! use meshlod_samples as samples;
//! use meshlod_multires::{Forest, Model, Query, SlotMesh, UpdateLimits, ViewCamera};
//! use meshlod_simplify::Options;
//!
//! let mesh = samples::torus(5000);
//! let forest = Forest::new(&mesh, &Options::default())?;
//! let model = Model::new(&forest)?;
//! assert_eq!(model.implicit().certify()?.sound, forest.update_count());
//!
//! // Fine near the camera, coarse far from it.
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
//! // A step back: the changes come triangle by triangle.
//! let far = ViewCamera { eye: [4.0, 0.0, 2.0], ..near };
//! cut.update(&Query::pixels(far, 1.0), &UpdateLimits::default())?;
//! assert!(cut.face_count() < faces && cut.patches().count() > 0);
//!
//! // One tolerance everywhere, by the face list.
//! let level = model.extractor().uniform(0.01)?.mesh();
//! assert!(level.faces.len() < mesh.faces.len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`Archive`] stores all of this in a `.mlod` file, of which a query reads only what it needs.
//!
//! A mesh that is a height field on a grid needs no recorded simplification: [`Rtin`] derives its
//! levels by arithmetic, in ten bytes per vertex, with proven error bounds (docs/notes/rtin.md).
//! [`Hierarchy`] is either kind of model, and [`HierarchyCut`] a cut of it: [`ModelFile::read`]
//! gives the one, its [`cut`](Hierarchy::cut) the other.
//!
//! Positions are stored as `f32` relative to the middle of the mesh; on request the input's are
//! kept exactly ([`Forest::lossless`]). Errors are the simplification's estimates made monotone, and
//! optionally smoothed ([`Forest::smooth_errors`]) or replaced by proven bounds
//! ([`Forest::measure_bounds`]).
//! docs/notes/multires.md has the rules, and the proof that they suffice.
#![forbid(unsafe_code)]

mod bounds;
mod cut;
mod error_kind;
mod explicit;
mod file;
mod forest;
mod hierarchy;
mod implicit;
mod length16;
mod level;
mod measured;
mod model;
mod pack;
mod query;
mod rtin;
mod slot_mesh;
mod wedges;

#[cfg(test)]
mod tests;

pub use cut::{
    Certificate, CertifyError, Cut, CutChange, Flaw, Geomorph, Located, Motion, UpdateLimits,
    VertexValues,
};
pub use error_kind::ErrorKind;
pub use explicit::{Explicit, ExplicitCut};
pub use file::{
    Archive, Extract, FieldParts, FileError, ModelFile, Resource, Source, Storage, StoredErrors,
    Surroundings, pack_resource, unpack_resource,
};
pub use forest::{BuildError, Forest, Recorder};
pub use hierarchy::{Hierarchy, HierarchyCut};
pub use implicit::{Extractor, Implicit, SplitRule};
pub use level::Level;
pub use measured::{PosedWedges, Posing};
pub use model::{Model, ModelBytes};
pub use query::{Focus, Ground, GroundShape, Limits, Query, QueryError, Tolerance, ViewCamera};
pub use rtin::{
    FieldBytesError, Fit, HeightField, HeightFieldError, HeightPrecision, Rtin, RtinCertifyError,
    RtinCut, RtinExtractor, RtinFlaw,
};
pub use slot_mesh::{Patch, SlotMesh};
pub use wedges::LayerFormat;
