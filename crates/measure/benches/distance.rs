//! Preparing a knot and measuring its distance from a coarser one, half a million samples each way.

use criterion::{Criterion, criterion_group, criterion_main};
use meshlod_measure::{DistanceOptions, PreparedSurface, quality, surface_distance, volume};
use meshlod_samples as samples;

fn measures(criterion: &mut Criterion) {
    let (fine, coarse) = (samples::knot(400_000), samples::knot(40_000));
    let options = DistanceOptions::default();
    let mut group = criterion.benchmark_group("a knot of 400,000 faces");
    group.sample_size(10);
    group.bench_function("prepared", |b| {
        b.iter_with_large_drop(|| PreparedSurface::new(&fine).unwrap());
    });
    let (a, b) = (PreparedSurface::new(&fine).unwrap(), PreparedSurface::new(&coarse).unwrap());
    group.bench_function("distance to 40,000 faces", |bencher| {
        bencher.iter(|| surface_distance(&a, &b, &options).unwrap());
    });
    group.bench_function("volume", |b| b.iter(|| volume(&fine)));
    group.bench_function("quality", |b| b.iter(|| quality(&fine)));
    group.finish();
}

criterion_group!(benches, measures);
criterion_main!(benches);
