//! Measurements of triangle meshes: two-sided surface distance, area, volume and triangle quality.
//!
//! [`distance`] measures how far two meshes are apart, by samples spread evenly over both. To
//! measure many meshes against one, build a [`PreparedSurface`] of each and call
//! [`surface_distance`]. [`certified_distance`] encloses the maximum, which samples bound from below
//! only, and [`faces_beyond`] lists the faces that are farther away than they may be.
//!
//! ```
//! use meshlod_measure::{DistanceOptions, PreparedSurface, distance, surface_distance, volume};
//! use meshlod_mesh::{Mesh, VertexId};
//!
//! let square = |z: f64| {
//!     let positions = vec![[0.0, 0.0, z], [3.0, 0.0, z], [3.0, 4.0, z], [0.0, 4.0, z]];
//!     Mesh::new(positions, [[0, 1, 2], [0, 2, 3]].map(|face| face.map(VertexId)).to_vec())
//! };
//! let (original, level) = (square(0.0), square(0.5));
//! let options = DistanceOptions { samples: 1000, ..Default::default() };
//!
//! let apart = distance(&original, &level, &options).unwrap();
//! assert_eq!((apart.mean(), apart.rms(), apart.max()), (0.5, 0.5, 0.5));
//! assert_eq!(apart.percent(apart.max()), 10.0);
//!
//! let target = PreparedSurface::new(&original).unwrap();
//! let again = surface_distance(&target, &PreparedSurface::new(&level).unwrap(), &options).unwrap();
//! assert_eq!(again, apart);
//! assert_eq!(volume(&level), 0.0);
//! ```
#![forbid(unsafe_code)]

mod certified;
mod distance;
#[cfg(test)]
mod fixtures;
mod prepared;
mod quality;
mod sample;
mod size;

pub use certified::{
    BeyondOptions, Bracket, CertifiedDistance, CertifiedOptions, FaceBeyond, FacesBeyond,
    certified_distance, certified_one_way, certified_surface_distance, faces_beyond,
    least_provable,
};
pub use distance::{
    Distance, DistanceOptions, MeasureError, OneSidedDistance, Place, distance, surface_distance,
    vertex_errors,
};
pub use prepared::{PreparedSurface, SurfaceError};
pub use quality::{QUALITY_BINS, Quality, quality};
pub use size::{area, volume};
