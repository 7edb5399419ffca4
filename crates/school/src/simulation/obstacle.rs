//! Obstacles that members swim round: balls, capsules, and meshes as distance fields.

use std::sync::Arc;

use glam::Vec3;

use crate::simulation::field::DistanceField;
use crate::simulation::range::{FARTHEST, is_near};

/// Obstacle, in body lengths; `S` is the form of its solids: a distance field for the simulation, a
/// mesh for pictures ([`SceneObstacle`](crate::scene::SceneObstacle)).
#[derive(Clone, Debug, PartialEq)]
pub enum Obstacle<S = Arc<DistanceField>> {
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
    /// Inside of a closed mesh, or underside of an open terrain.
    Solid(S),
}

/// Signed distance from a point to an obstacle, negative inside, and its gradient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObstacleDistance {
    /// Signed distance, exact for balls and capsules and interpolated in fields.
    pub distance: f32,
    /// Unit vector out of the obstacle.
    pub outward: Vec3,
}

/// Solid that can be moved.
pub trait Translate {
    /// Moves the solid by a vector, in body lengths.
    fn translate(&mut self, by: Vec3);
}

impl Translate for Arc<DistanceField> {
    /// Moves the field; one that others share is copied first.
    fn translate(&mut self, by: Vec3) {
        Arc::make_mut(self).translate(by);
    }
}

impl<S> Obstacle<S> {
    /// Returns the obstacle with its solid in another form.
    ///
    /// # Errors
    /// Those of `form`.
    pub fn try_map<T, E>(&self, form: impl FnOnce(&S) -> Result<T, E>) -> Result<Obstacle<T>, E> {
        Ok(match self {
            Self::Sphere { center, radius } => {
                Obstacle::Sphere { center: *center, radius: *radius }
            }
            Self::Capsule { ends, radius } => Obstacle::Capsule { ends: *ends, radius: *radius },
            Self::Solid(solid) => Obstacle::Solid(form(solid)?),
        })
    }

    /// Moves the obstacle.
    pub fn translate(&mut self, by: Vec3)
    where
        S: Translate,
    {
        match self {
            Self::Sphere { center, .. } => *center += by,
            Self::Capsule { ends, .. } => ends.iter_mut().for_each(|end| *end += by),
            Self::Solid(solid) => solid.translate(by),
        }
    }
}

impl Obstacle {
    /// Returns the signed distance from a point to the obstacle.
    ///
    /// From points without a shortest way out, such as the centre of a ball, the direction is up.
    pub fn distance(&self, point: Vec3) -> ObstacleDistance {
        match self {
            Self::Sphere { center, radius } => from_core(point, *center, *radius),
            Self::Capsule { ends: [a, b], radius } => {
                let (axis, offset) = (*b - *a, point - *a);
                let along = offset.dot(axis) / axis.length_squared().max(f32::MIN_POSITIVE);
                from_core(point, *a + axis * along.clamp(0.0, 1.0), *radius)
            }
            Self::Solid(field) => field.distance(point),
        }
    }

    /// Returns centre and radius of a ball around the obstacle.
    pub(super) fn ball(&self) -> (Vec3, f32) {
        match self {
            Self::Sphere { center, radius } => (*center, *radius),
            Self::Capsule { ends: [a, b], radius } => {
                ((*a + *b) * 0.5, a.distance(*b) * 0.5 + radius)
            }
            Self::Solid(field) => field.ball(),
        }
    }

    pub(super) fn is_valid(&self) -> bool {
        let near = |point: &Vec3| is_near(*point);
        let wide = |radius: f32| radius > 0.0 && radius <= FARTHEST;
        match self {
            Self::Sphere { center, radius } => near(center) && wide(*radius),
            Self::Capsule { ends: [a, b], radius } => near(a) && near(b) && wide(*radius),
            Self::Solid(field) => near(&field.ball().0),
        }
    }
}

fn from_core(point: Vec3, core: Vec3, radius: f32) -> ObstacleDistance {
    let offset = point - core;
    let length = offset.length();
    let outward = if length > 1e-6 { offset / length } else { Vec3::Y };
    ObstacleDistance { distance: length - radius, outward }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_capsule_is_round_at_its_ends_and_straight_between() {
        let capsule = Obstacle::Capsule { ends: [Vec3::ZERO, Vec3::Y * 4.0], radius: 1.0 };
        let at = |x, y| capsule.distance(Vec3::new(x, y, 0.0));
        assert_eq!(at(3.0, 2.0), ObstacleDistance { distance: 2.0, outward: Vec3::X });
        assert_eq!(at(0.0, 7.0), ObstacleDistance { distance: 2.0, outward: Vec3::Y });
        assert_eq!(at(0.0, 2.0).distance, -1.0);
        assert_eq!(capsule.ball(), (Vec3::Y * 2.0, 3.0));
    }

    #[test]
    fn a_capsule_without_length_is_a_ball() {
        let capsule = Obstacle::Capsule { ends: [Vec3::X; 2], radius: 1.0 };
        let ball = Obstacle::Sphere { center: Vec3::X, radius: 1.0 };
        for point in [Vec3::X, Vec3::ZERO, Vec3::new(4.0, 5.0, 6.0)] {
            assert_eq!(capsule.distance(point), ball.distance(point));
        }
    }
}
