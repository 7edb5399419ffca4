//! Triangle meshes: ids, attributes, connectivity, bounds, procedural samples.
//!
//! No I/O, no threads, no policy. Positions are `f64`; attributes hang on *wedges*, which have
//! their own corner indices, so that a texture seam never tears the surface.
//!
//! ```
//! use meshlod_mesh::{Connectivity, sample};
//!
//! let mesh = sample::sphere(1000);
//! let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
//! assert!(connectivity.is_closed());
//! ```
#![forbid(unsafe_code)]

mod attributes;
mod bounds;
mod buckets;
mod components;
mod connectivity;
mod ids;
mod labels;
mod locks;
mod mesh;
pub mod sample;
mod weld;

pub use attributes::{Attributes, Layer, LayerKind};
pub use bounds::Bounds;
pub use buckets::Buckets;
pub use components::face_components;
pub use connectivity::{Connectivity, Marks, Side, Twin};
pub use ids::{FaceId, VertexId, WedgeId};
pub use labels::Labels;
pub use locks::{Lock, Locks};
pub use mesh::{Mesh, MeshError};
pub use weld::{first_near, merge_equal_wedges, weld};
