//! Spatial search over triangle meshes: closest points by a bounding volume hierarchy ([`Bvh`]),
//! faces that cover a triangle ([`Sheet`]), an octree of triangles ([`Octree`]) and sorting along a
//! space-filling curve ([`curve_order`]).
//!
//! The hierarchy's boxes are compact and rounded outwards. Answers are computed from the triangles
//! in `f64` and do not depend on the tree, the hint or the number of threads.
//!
//! | files, in reading order | hold |
//! |---|---|
//! | `triangle`, `box3`, `sum` | geometry |
//! | `bvh`, `build`, `closest`, `within_box` | the hierarchy and its queries |
//! | `parts` | a hierarchy over parts that go one by one |
//! | `mates`, `sheet` | faces over a triangle |
//! | `octree`, `curve` | other orders |
//!
//! ```
//! use meshlod_mesh::{FaceId, Mesh, VertexId};
//! use meshlod_spatial::Bvh;
//!
//! let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
//! let mesh = Mesh::new(positions, vec![[VertexId(0), VertexId(1), VertexId(2)]]);
//! let bvh = Bvh::new(&mesh).unwrap();
//!
//! let closest = bvh.closest([0.25, 0.25, 2.0], None);
//! assert_eq!(closest.point, [0.25, 0.25, 0.0]);
//! assert_eq!((closest.face, closest.distance_squared), (FaceId(0), 4.0));
//! ```
#![forbid(unsafe_code)]

mod box3;
mod build;
mod bvh;
mod closest;
mod curve;
mod mates;
mod octree;
mod parts;
mod sheet;
mod sum;
#[cfg(test)]
mod tests;
mod triangle;
mod within_box;

pub use bvh::{Bvh, BvhError};
pub use closest::ClosestPoint;
pub use curve::curve_order;
pub use mates::Mates;
pub use octree::{Octree, OctreeLeaf};
pub use parts::{NearestPart, PartBvh, PartBvhBuilder, PartSearch, Within};
pub use sheet::{Cover, Sheet};
pub use sum::CompensatedSum;
pub use triangle::{Triangle, closest_point};
