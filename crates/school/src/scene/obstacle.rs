//! Obstacles of a scene, whose solids are meshes, so that pictures can show them.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use meshlod::Mesh;

use crate::scene::solid;
use crate::simulation::{DistanceField, FieldError, Obstacle, Translate};

/// Obstacle of a scene: its solids are closed meshes, or open terrains.
pub type SceneObstacle = Obstacle<Mesh>;

/// Cells of a mesh's distance field along its longest side.
const FIELD_CELLS: u32 = 128;

impl Translate for Mesh {
    fn translate(&mut self, by: Vec3) {
        let by = by.as_dvec3();
        self.positions.iter_mut().for_each(|p| *p = (DVec3::from(*p) + by).into());
    }
}

impl Obstacle<Mesh> {
    /// Returns the obstacle for a simulation.
    ///
    /// # Errors
    /// A mesh that has no distance field.
    pub fn for_simulation(&self) -> Result<Obstacle, FieldError> {
        self.try_map(|mesh| Ok(Arc::new(DistanceField::new(mesh, FIELD_CELLS)?)))
    }

    /// Returns the obstacle as a mesh, for drawing.
    pub fn mesh(&self) -> Mesh {
        match self {
            Self::Sphere { center, radius } => solid::capsule([*center; 2], *radius),
            Self::Capsule { ends, radius } => solid::capsule(*ends, *radius),
            Self::Solid(mesh) => mesh.clone(),
        }
    }
}
