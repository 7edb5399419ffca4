//! Times the selection for a million members.
use std::sync::Arc;
use std::time::Instant;

use meshlod_flock::levels::{ChainOptions, LevelTable, Look, ModelAxes};
use meshlod_flock::select::{Budget, PolicyName, Selector};
use meshlod_flock::{Camera, Flock, School};

fn main() {
    let count: usize = std::env::args().nth(1).map_or(1_000_000, |s| s.parse().unwrap());
    let options = ChainOptions { axes: ModelAxes::FISH, ..ChainOptions::default() };
    let table = Arc::new(
        LevelTable::new(&meshlod_samples::fish(4_000), &Look::default(), &options).unwrap(),
    );
    let mut flock = Flock::default();
    let radii = glam::Vec3::new(30.0, 20.0, 60.0) * (count as f32 / 50_000.0).cbrt();
    let mut seed = 1u64;
    let mut random = || {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (seed >> 40) as f32 / (1u64 << 24) as f32
    };
    while flock.members.len() < count {
        let p = glam::Vec3::new(random(), random(), random()) * 2.0 - 1.0;
        if p.length() > 1.0 {
            continue;
        }
        let h = (glam::Vec3::Z + 0.3 * (glam::Vec3::new(random(), random(), random()) * 2.0 - 1.0))
            .normalize();
        flock.members.push((p * radii).into(), h.into());
    }
    flock.schools.push(School {
        members: 0..count,
        leader: glam::Vec3::ZERO,
        heading: glam::Vec3::Z,
        radii,
    });
    let camera = Camera::look_at([radii.x * 3.0, 10.0, 0.0], [0.0; 3], 0.8, [1920, 1080]).unwrap();
    for policy in PolicyName::ALL {
        let mut selector = Selector::new(policy, table.clone());
        let budget = Budget { triangles: count * 60, ..Budget::default() };
        selector.select(&flock, &camera, &budget);
        let mut times = Vec::new();
        for _ in 0..9 {
            let start = Instant::now();
            selector.select(&flock, &camera, &budget);
            times.push(start.elapsed().as_secs_f64() * 1e9 / count as f64);
        }
        times.sort_by(f64::total_cmp);
        println!("{:18} {:6.2} ns  {} triangles", policy.name(), times[4], selector.triangles());
    }
}
