//! Obstacles as the simulation avoids them and as pictures show them.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use meshlod_mesh::Mesh;

use crate::scene::solid;
use crate::simulation::{DistanceField, FieldError, Obstacle};

/// Obstacle of a scene, in body lengths.
#[derive(Clone, Debug, PartialEq)]
pub enum SceneObstacle {
    /// Ball.
    Sphere {
        /// Centre of the ball.
        center: Vec3,
        /// Radius of the ball.
        radius: f32,
    },
    /// All points within a distance from a segment, such as a pillar.
    Capsule {
        /// Ends of the segment.
        ends: [Vec3; 2],
        /// Distance from the segment.
        radius: f32,
    },
    /// Inside of a closed mesh, or what lies under an open terrain.
    Mesh(Mesh),
}

/// Cells of a mesh's distance field along its longest side.
const FIELD_CELLS: u32 = 128;

impl SceneObstacle {
    /// Returns the obstacle for a simulation.
    ///
    /// # Errors
    /// A mesh that has no distance field.
    pub fn for_simulation(&self) -> Result<Obstacle, FieldError> {
        Ok(match self {
            Self::Sphere { center, radius } => {
                Obstacle::Sphere { center: *center, radius: *radius }
            }
            Self::Capsule { ends, radius } => Obstacle::Capsule { ends: *ends, radius: *radius },
            Self::Mesh(mesh) => Obstacle::Field(Arc::new(DistanceField::new(mesh, FIELD_CELLS)?)),
        })
    }

    /// Moves the obstacle.
    pub fn translate(&mut self, by: Vec3) {
        match self {
            Self::Sphere { center, .. } => *center += by,
            Self::Capsule { ends, .. } => ends.iter_mut().for_each(|end| *end += by),
            Self::Mesh(mesh) => {
                let by = by.as_dvec3();
                mesh.positions.iter_mut().for_each(|p| *p = (DVec3::from(*p) + by).into());
            }
        }
    }

    /// Returns the obstacle as a mesh, for drawing.
    pub fn mesh(&self) -> Mesh {
        match self {
            Self::Sphere { center, radius } => solid::capsule([*center; 2], *radius),
            Self::Capsule { ends, radius } => solid::capsule(*ends, *radius),
            Self::Mesh(mesh) => mesh.clone(),
        }
    }
}
