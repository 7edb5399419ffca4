//! Scenario `obstacles`: balls, pillars and bars all along the way.

use std::f32::consts::TAU;

use glam::Vec3;

use crate::scene::lanes::Ring;
use crate::scene::setting::Setting;
use crate::scene::shot::Shot;
use crate::scene::{SceneError, SceneObstacle};

/// Time before the first frame.
const WARM_UP_S: f32 = 3.0;

/// Distance from obstacle to obstacle over the school's half length.
const APART: f32 = 2.6;

/// Sets up schools on a level ring of obstacles, the first of which the school is about to meet
/// when the film begins.
pub(super) fn set_up(counts: &[usize]) -> Result<Setting, SceneError> {
    let ring = Ring::of(counts[0]);
    let schools = ring.schools(counts, |_| 0.0)?;
    let first = ring.angle_of(schools[0].speed * WARM_UP_S + 0.8 * ring.radii.z + 1.2);
    let count = (TAU / ring.angle_of(APART * ring.radii.z)) as usize;
    let angle = |i: usize| first + i as f32 * TAU / count as f32;
    let obstacles = (0..count).flat_map(|i| at(&ring, angle(i), i)).collect();
    let shot = Shot::Beside { outside: 0.8 * ring.radii.x + 1.2 * ring.radii.z + 2.7 };
    Ok(Setting { schools, obstacles, shot, warm_up_s: WARM_UP_S })
}

/// Returns the obstacles at an angle of the ring: in turn a ball, a gate of two pillars, a bar
/// across the way, and a pillar.
fn at(ring: &Ring, angle: f32, number: usize) -> Vec<SceneObstacle> {
    let Vec3 { x: width, y: height, .. } = ring.radii;
    let middle = ring.point(angle, |_| 0.0);
    let outward = middle.normalize_or(Vec3::X);
    let (thin, tall) = ((0.16 * width).max(0.4), 2.0 * height + 1.0);
    let pillar = |offset: f32| {
        let foot = middle + outward * offset;
        let ends = [foot - Vec3::Y * tall, foot + Vec3::Y * tall];
        SceneObstacle::Capsule { ends, radius: thin }
    };
    match number % 4 {
        0 => {
            let center = middle + outward * 0.15 * width - Vec3::Y * 0.1 * height;
            vec![SceneObstacle::Sphere { center, radius: (0.42 * width).max(0.7) }]
        }
        1 => vec![pillar(-0.5 * width - thin), pillar(0.5 * width + thin)],
        2 => {
            let across = outward * (1.4 * width) + Vec3::Y * 0.4 * height;
            let ends = [middle - across, middle + across];
            vec![SceneObstacle::Capsule { ends, radius: thin }]
        }
        _ => vec![pillar(0.0)],
    }
}
