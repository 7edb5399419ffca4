//! Times the check: all kinds, and intersections by either broad phase.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use meshlod_check::{BroadPhase, CheckOptions, Kind, Kinds, findings};
use meshlod_samples as samples;

fn check(criterion: &mut Criterion) {
    let mesh = samples::knot(100_000);
    let mut group = criterion.benchmark_group("a knot of 100,000 faces");
    group.throughput(Throughput::Elements(mesh.faces.len() as u64));
    group.sample_size(10);
    let meeting = Kinds::NONE.with(Kind::SelfIntersection).with(Kind::Contact);
    for (name, kinds, broad_phase) in [
        ("all kinds", Kinds::ALL, BroadPhase::Tree),
        ("what meets", meeting, BroadPhase::Tree),
        ("what meets, by cubes", meeting, BroadPhase::Octree),
    ] {
        let options = CheckOptions { kinds, broad_phase, ..CheckOptions::default() };
        group.bench_function(name, |bencher| bencher.iter(|| findings(&mesh, &options)));
    }
    group.finish();
}

criterion_group!(benches, check);
criterion_main!(benches);
