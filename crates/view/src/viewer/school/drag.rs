//! Obstacles under the pointer, and how far a drag moves them.

use glam::Vec3;
use meshlod::flock::FlockCamera;
use meshlod_school::scene::SceneObstacle;

/// Obstacle under the pointer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PickedObstacle {
    /// Index among the obstacles of the scenario.
    pub index: usize,
    /// Distance along the view axis of the plane in which it is dragged, in body lengths.
    pub depth: f32,
}

/// Returns the nearest obstacle under a point of the picture; `at` is in halves of the picture's
/// width and height from its middle, to the right and up. Obstacles that are meshes are the ground,
/// and stay.
pub(crate) fn pick(
    camera: &FlockCamera,
    at: [f32; 2],
    obstacles: &[SceneObstacle],
) -> Option<PickedObstacle> {
    let (eye, ray) = (camera.eye(), ray(camera, at));
    let hits = obstacles.iter().enumerate().filter_map(|(index, obstacle)| {
        let (ends, radius) = match obstacle {
            SceneObstacle::Sphere { center, radius } => ([*center; 2], *radius),
            SceneObstacle::Capsule { ends, radius } => (*ends, *radius),
            SceneObstacle::Solid(_) => return None,
        };
        let way = hit(eye, ray, ends, radius)?;
        Some((way, PickedObstacle { index, depth: way * ray.dot(camera.axes()[2]) }))
    });
    hits.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, picked)| picked)
}

/// Returns how far a point at a depth moves, in body lengths, to follow a drag by pixels to the
/// right and down, in the plane that faces the camera.
pub(crate) fn drag(camera: &FlockCamera, depth: f32, [x, y]: [f32; 2]) -> Vec3 {
    let [right, up, _] = camera.axes();
    (right * x - up * y) * (depth / camera.pixels_at_one())
}

/// Returns the unit vector from the eye to a point of the picture.
fn ray(camera: &FlockCamera, [x, y]: [f32; 2]) -> Vec3 {
    let [right, up, forward] = camera.axes();
    let [across, down] = camera.tangents();
    (forward + right * (x * across) + up * (y * down)).normalize()
}

/// Returns how far along a ray of unit length its nearest point to a segment is, if that is within a
/// radius of the segment and in front of the eye; the point lies inside the capsule or on it.
fn hit(eye: Vec3, ray: Vec3, [a, b]: [Vec3; 2], radius: f32) -> Option<f32> {
    let (along, offset) = (b - a, eye - a);
    let (length, slant) = (along.length_squared(), ray.dot(along));
    // Where the distance of the two lines is least; ends of the segment where that is beyond them.
    let spread = length - slant * slant;
    let part = if spread > 1e-6 * length && length > 0.0 {
        (offset.dot(along) - slant * offset.dot(ray)) / spread
    } else {
        0.0
    };
    let nearest = a + along * part.clamp(0.0, 1.0);
    let way = (nearest - eye).dot(ray);
    let distance = (eye + ray * way - nearest).length();
    (way > 0.0 && distance <= radius).then_some(way)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> FlockCamera {
        FlockCamera::look_at([0.0; 3], [0.0, 0.0, -1.0], 1.0, [400, 300]).unwrap()
    }

    fn ball(x: f32, y: f32, z: f32) -> SceneObstacle {
        SceneObstacle::Sphere { center: Vec3::new(x, y, z), radius: 1.0 }
    }

    #[test]
    fn the_nearest_obstacle_under_the_pointer_is_picked() {
        let all = [ball(0.0, 0.0, -20.0), ball(0.0, 0.5, -10.0), ball(0.0, 0.0, 5.0)];
        let picked = pick(&camera(), [0.0; 2], &all).unwrap();
        assert_eq!((picked.index, picked.depth), (1, 10.0));
        assert_eq!(pick(&camera(), [0.9, 0.0], &all), None);
    }

    #[test]
    fn a_pillar_is_picked_along_its_whole_length_and_no_farther() {
        let ends = [Vec3::new(3.0, -4.0, -10.0), Vec3::new(3.0, 4.0, -10.0)];
        let pillar = [SceneObstacle::Capsule { ends, radius: 0.5 }];
        let [across, down] = camera().tangents();
        let at = |x: f32, y: f32| pick(&camera(), [x / across / 10.0, y / down / 10.0], &pillar);
        for y in [-4.2, -2.0, 0.0, 4.2] {
            assert!(at(3.0, y).is_some_and(|picked| (picked.depth - 10.0).abs() < 0.1), "{y}");
        }
        assert_eq!([at(3.0, 4.8), at(3.7, 0.0), at(-3.0, 0.0)], [None; 3]);
        let ahead = [Vec3::new(0.0, 0.0, -5.0), Vec3::new(0.0, 0.0, -9.0)];
        let ahead = [SceneObstacle::Capsule { ends: ahead, radius: 0.5 }];
        assert_eq!(pick(&camera(), [0.0; 2], &ahead).unwrap().depth, 5.0);
    }

    #[test]
    fn an_obstacle_stays_under_the_pointer() {
        let camera = camera();
        let mut center = Vec3::new(1.0, 0.0, -10.0);
        let before = pick(&camera, [0.15, 0.0], &[ball(1.0, 0.0, -10.0)]).unwrap();
        // A quarter of the picture to the right and up.
        center += drag(&camera, 10.0, [100.0, -75.0]);
        let [across, down] = camera.tangents();
        let expected = Vec3::new(1.0 + 5.0 * across, 5.0 * down, -10.0);
        assert!((center - expected).length() < 1e-4, "{center}");
        let moved = [SceneObstacle::Sphere { center, radius: 1.0 }];
        let after = pick(&camera, [0.65, 0.5], &moved).unwrap();
        assert_eq!((after.index, before.index), (0, 0));
    }

    #[test]
    fn the_ground_stays() {
        let ground = SceneObstacle::Solid(meshlod::samples::terrain(200));
        assert_eq!(pick(&camera(), [0.0; 2], &[ground]), None);
    }
}
