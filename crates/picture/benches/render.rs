//! A million faces at 1024 × 1024, in the styles that reports use.

use criterion::{Criterion, criterion_group, criterion_main};
use meshlod_picture::{Antialiasing, Camera, Normals, Style, View, Wireframe, render, visibility};
use meshlod_samples as samples;

fn pictures(criterion: &mut Criterion) {
    let mesh = samples::knot(1_000_000);
    let camera = Camera::fit_mesh(&mesh, &View::default());
    let one = Style { antialiasing: Antialiasing::Off, ..Style::default() };
    let lined = Style { wireframe: Some(Wireframe::default()), ..Style::default() };
    let styles = [
        ("smooth, 1 sample", one.clone()),
        ("flat, 1 sample", Style { normals: Normals::Flat, ..one }),
        ("smooth, 9 samples", Style::default()),
        (
            "creased, 9 samples",
            Style { normals: Normals::Creased { crease_rad: 0.7 }, ..lined.clone() },
        ),
        ("lined, 9 samples", lined),
    ];
    let mut group = criterion.benchmark_group("a knot of a million faces");
    group.sample_size(10);
    for (name, style) in &styles {
        group.bench_function(*name, |b| b.iter(|| render(&mesh, &camera, style)));
    }
    group.bench_function("visibility", |b| b.iter(|| visibility(&mesh, &camera, [1024, 1024])));
    group.finish();
}

criterion_group!(benches, pictures);
criterion_main!(benches);
