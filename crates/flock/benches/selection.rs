//! Time of a choice of levels for a million members, by policy, on one thread.
//!
//! `cargo bench -p meshlod-flock --bench selection`; a time divided by a million is that of one
//! member.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use meshlod_flock::levels::{ChainOptions, LevelTable, Look, ModelAxes};
use meshlod_flock::select::{Budget, PolicyName, Selector};
use meshlod_flock::{Flock, FlockCamera, School};
use meshlod_samples as samples;

const MEMBERS: usize = 1_000_000;

/// School of a million members, evenly strewn in an ellipsoid, heading along +z within 17°.
fn school(radii: Vec3) -> Flock {
    let mut state = 1u64;
    let mut random = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 40) as f32 / (1u64 << 23) as f32 - 1.0
    };
    let mut flock = Flock::default();
    while flock.members.len() < MEMBERS {
        let place = Vec3::new(random(), random(), random());
        if place.length() < 1.0 {
            let heading = Vec3::Z + 0.3 * Vec3::new(random(), random(), random());
            flock.members.push((place * radii).into(), heading.normalize().into());
        }
    }
    let (leader, heading) = (Vec3::ZERO, Vec3::Z);
    flock.schools.push(School { members: 0..MEMBERS, leader, heading, radii });
    flock
}

fn selection(criterion: &mut Criterion) {
    let options = ChainOptions { axes: ModelAxes::FISH, ..ChainOptions::default() };
    let table = LevelTable::new(&samples::fish(4_000), &Look::default(), &options);
    let table = Arc::new(table.expect("the sample has levels"));
    let radii = Vec3::new(80.0, 55.0, 165.0);
    let flock = school(radii);
    let camera = FlockCamera::look_at([3.0 * radii.x, 10.0, 0.0], [0.0; 3], 0.8, [1920, 1080]);
    let camera = camera.expect("the camera sees the school");
    let budget = Budget { triangles: 60 * MEMBERS, detail: 1.0, ..Budget::default() };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let mut group = criterion.benchmark_group("selection");
    group.throughput(Throughput::Elements(MEMBERS as u64)).sample_size(20);
    for policy in PolicyName::ALL {
        let mut selector = Selector::new(policy, table.clone());
        group.bench_function(policy.name(), |bencher| {
            bencher.iter(|| {
                pool.install(|| black_box(selector.select(&flock, &camera, &budget).len()))
            });
        });
    }
    group.finish();
}

criterion_group!(benches, selection);
criterion_main!(benches);
