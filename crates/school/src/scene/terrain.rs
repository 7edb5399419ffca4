//! Scenario `terrain`: over hills.

use meshlod::mesh::Mesh;

use crate::scene::ground::{CircleHeights, Ground};
use crate::scene::lanes::Ring;
use crate::scene::setting::Setting;
use crate::scene::shot::Shot;
use crate::scene::{SceneError, SceneObstacle};

/// Heights of the terrain over its sides, compared with the model.
const FLATTENED: f64 = 0.45;

/// Sets up schools that swim over a terrain: any mesh, +y up, which is scaled to the school's way.
pub(super) fn set_up(counts: &[usize], terrain: &Mesh) -> Result<Setting, SceneError> {
    let ring = Ring::of(counts[0]);
    let radii = ring.radii;
    let terrain = placed(terrain, ring.radius + 4.0 * radii.x + 2.5 * radii.z + 8.0)?;
    let ground = Ground::new(&terrain).ok_or(SceneError::FlatTerrain)?;
    let smooth = ring.angle_of(1.2 * radii.z + 2.0);
    let least = |angle: f32| {
        ground.highest(ring.point(angle, |_| 0.0), radii.x.max(1.0)) + 0.8 * radii.y + 0.5
    };
    let way = CircleHeights::above(least, smooth);
    // The camera circles farther out and behind, above both the ground and the school.
    let outside = Ring { radius: ring.radius + 0.7 * radii.z + 1.5, ..ring };
    let behind = ring.angle_of(1.4 * radii.z + 2.0);
    let least = |angle: f32| {
        let free = ground.highest(outside.point(angle, |_| 0.0), 2.0) + 1.5;
        free.max(way.at(angle + behind) + 0.55 * radii.z + 1.0)
    };
    let heights = CircleHeights::above(least, smooth);
    let schools = ring.schools(counts, |angle| way.at(angle))?;
    let shot = Shot::Over { radius: outside.radius, behind, heights };
    Ok(Setting { schools, obstacles: vec![SceneObstacle::Solid(terrain)], shot, warm_up_s: 1.0 })
}

/// Returns the terrain centred over the origin, its sides reaching `half` along x and z.
fn placed(terrain: &Mesh, half: f32) -> Result<Mesh, SceneError> {
    let bounds = terrain.bounds();
    let [width, _, depth] = [0, 1, 2].map(|axis| bounds.max[axis] - bounds.min[axis]);
    let shorter = width.min(depth);
    if terrain.validate().is_err() || bounds.is_empty() || !shorter.is_normal() {
        return Err(SceneError::FlatTerrain);
    }
    let center = bounds.center();
    let scale = 2.0 * f64::from(half) / shorter;
    let scales = [scale, scale * FLATTENED, scale];
    let place = |p: &[f64; 3]| [0, 1, 2].map(|axis| (p[axis] - center[axis]) * scales[axis]);
    let positions: Vec<[f64; 3]> = terrain.positions.iter().map(place).collect();
    if !positions.iter().flatten().all(|x| x.is_finite()) {
        return Err(SceneError::FlatTerrain);
    }
    Ok(Mesh::new(positions, terrain.faces.clone()))
}
