//! Reading and writing the Stanford dragon, 871,414 faces in 16.6 MB: reading must take no more
//! than 60 ms on one core, from memory and from disk.

use criterion::{Criterion, criterion_group, criterion_main};
use meshlod_fixtures::shared_mesh;
use meshlod_io::{Precision, ply, stl};

fn dragon(c: &mut Criterion) {
    let Some(path) = shared_mesh("dragon.ply") else { return };
    let bytes = std::fs::read(&path).expect("the file can be read");
    let mesh = ply::read(&bytes).expect("the dragon is well");
    assert_eq!((mesh.positions.len(), mesh.faces.len()), (437_645, 871_414));

    let mut group = c.benchmark_group("dragon");
    group.sample_size(20);
    group.bench_function("read from memory", |b| b.iter(|| ply::read(&bytes)));
    group.bench_function("read from disk", |b| {
        b.iter(|| ply::read(&std::fs::read(&path).expect("the file can be read")));
    });
    group.bench_function("write", |b| {
        let mut out = Vec::with_capacity(2 * bytes.len());
        b.iter(|| {
            out.clear();
            ply::write(&mesh, Precision::F32, &mut out)
        });
    });
    let mut soup = Vec::new();
    stl::write(&mesh, &mut soup).expect("the dragon fits STL");
    group.bench_function("read and weld as STL", |b| b.iter(|| stl::read(&soup)));
}

fn text(c: &mut Criterion) {
    let Some(path) = shared_mesh("bunny-zipper-ascii.ply") else { return };
    let bytes = std::fs::read(path).expect("the file can be read");
    c.bench_function("bunny as text", |b| b.iter(|| ply::read(&bytes)));
}

criterion_group!(benches, dragon, text);
criterion_main!(benches);
