//! Triangle meshes with attributes and labels, their connectivity and bounding boxes.
//!
//! No I/O, no threads, no policy. Positions are `f64`; attributes hang on *wedges*, which have
//! their own corner indices, so that a texture seam never tears the surface.
//!
//! ```
//! use meshlod_mesh::{Connectivity, VertexId};
//!
//! let tetrahedron = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].map(|face| face.map(VertexId));
//! let connectivity = Connectivity::new(&tetrahedron, 4);
//! assert!(connectivity.is_closed());
//! ```
//!
//! | files, in reading order | hold |
//! |---|---|
//! | `ids`, `mesh` | vertices, faces, wedges; [`Mesh`] and its validity |
//! | `attributes`, `octahedral` | values on wedges; directions as integers |
//! | `labels`, `face_layers`, `locks` | what faces and vertices carry besides |
//! | `connectivity`, `components`, `closed`, `duplicates` | topology, from indices alone |
//! | `weld`, `condition` | vertices merged, borders sewn, non-manifold vertices split |
//! | `arrays`, `point`, `bevy` | meshes of other crates |
//! | `strip_triangles` | triangles of a strip |
//! | `bounds`, `frame`, `buckets`, `union_find`, `names` | small tools |
#![forbid(unsafe_code)]

mod arrays;
mod attributes;
#[cfg(feature = "bevy_mesh")]
mod bevy;
mod bounds;
mod buckets;
mod closed;
mod components;
mod condition;
mod connectivity;
mod duplicates;
mod face_layers;
mod frame;
mod ids;
mod labels;
mod locks;
mod mesh;
mod names;
pub mod octahedral;
mod point;
mod strip_triangles;
mod union_find;
mod weld;

pub use arrays::{ArraysError, MeshArrays};
pub use attributes::{AttributeBounds, Attributes, Layer, LayerKind};
#[cfg(feature = "bevy_mesh")]
pub use bevy::BevyMeshError;
pub use bounds::Bounds;
pub use buckets::Buckets;
pub use closed::closed_faces;
pub use components::{face_components, joined_vertices};
pub use condition::{
    Borders, ConditionOptions, Conditioned, Conditioning, NearBorders, Search, condition,
    is_balanced, near_borders,
};
pub use connectivity::{Connectivity, Marks, Side, Twin};
pub use face_layers::{FaceLayer, FaceLayerKind};
pub use frame::Frame;
pub use ids::{FaceId, VertexId, WedgeId};
pub use labels::Labels;
pub use locks::{Lock, Locks};
pub use mesh::{Mesh, MeshError};
pub use names::UnknownName;
pub use point::Point;
pub use strip_triangles::strip_triangles;
pub use union_find::UnionFind;
pub use weld::{first_near, merge_equal_wedges, weld};
