//! Simplifies procedural meshes to 10 %, by us and by meshoptimizer.

use criterion::{Criterion, criterion_group, criterion_main};
use meshlod::samples;
use meshlod::simplify::{Method, Options, Target, contract_to};
use meshlod_bench::peer::{Indexed, simplify_with_update};

fn to_a_tenth(c: &mut Criterion) {
    let mut group = c.benchmark_group("to 10 %");
    group.sample_size(10);
    for (name, mesh) in [("gyroid", samples::gyroid(50_000)), ("terrain", samples::terrain(50_000))]
    {
        for method in Method::ALL {
            let options = Options { method, ..Options::default() };
            group.bench_function(format!("{name}/{}", method.name()), |b| {
                b.iter(|| {
                    let (level, report) = contract_to(&mesh, Target::Ratio(0.1), &options).unwrap();
                    // The benchmark checks its own result.
                    assert!(report.reached && level.faces.len() * 10 <= mesh.faces.len());
                });
            });
        }
        let indexed = Indexed::from(&mesh);
        group.bench_function(format!("{name}/meshoptimizer with update"), |b| {
            b.iter(|| simplify_with_update(&indexed, mesh.faces.len() / 10));
        });
    }
    group.finish();
}

criterion_group!(benches, to_a_tenth);
criterion_main!(benches);
