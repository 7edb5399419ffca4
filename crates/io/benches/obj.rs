//! Reading OBJ, against tobj on the same bytes: Sponza (polygons with uvs, 5.6 MB) and a scan's
//! triangles (a torus of 200,000 faces, bare). Ours must be no slower.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use meshlod_fixtures::shared_mesh;
use meshlod_io::{Precision, Scene, obj};

fn sponza(c: &mut Criterion) {
    let Some(path) = shared_mesh("sponza.obj") else { return };
    let bytes = std::fs::read(path).expect("the file can be read");
    let scene = obj::read(&bytes, &mut |_| None).expect("Sponza is well");
    assert_eq!(scene.meshes[0].mesh.faces.len(), 66_450);
    compare(c, "sponza", &bytes, &scene);
}

fn scan(c: &mut Criterion) {
    let mesh = meshlod_samples::torus(200_000);
    let scene = Scene::from_mesh("", mesh);
    let mut bytes = Vec::new();
    obj::write(&scene, Precision::F32, &mut bytes, &[]).expect("a torus fits OBJ");
    compare(c, "scan", &bytes, &scene);
}

fn compare(c: &mut Criterion, name: &str, bytes: &[u8], scene: &Scene) {
    let mut group = c.benchmark_group(name);
    group.sample_size(20).throughput(Throughput::Bytes(bytes.len() as u64));
    group.bench_function("read", |b| b.iter(|| obj::read(black_box(bytes), &mut |_| None)));
    let options = tobj::LoadOptions { triangulate: true, ..Default::default() };
    group.bench_function("tobj", |b| {
        b.iter(|| {
            let none = |_: &std::path::Path| Ok(Default::default());
            tobj::load_obj_buf(&mut black_box(bytes), &options, none)
        });
    });
    group.bench_function("write", |b| {
        let mut out = Vec::with_capacity(2 * bytes.len());
        b.iter(|| {
            out.clear();
            obj::write(scene, Precision::F32, &mut out, &[])
        });
    });
    group.finish();
}

criterion_group!(benches, sponza, scan);
criterion_main!(benches);
