//! Boundary weights: the higher, the closer a boundary stays, on both engines.

use meshlod_mesh::{Connectivity, FaceId, Mesh, Side, Twin, VertexId};
use meshlod_samples as samples;
use meshlod_simplify::{Method, Options, Simplifier, SimplifyError, Target, contract_to};
use meshlod_spatial::Bvh;

fn options(method: Method, boundary_weight: Option<f64>) -> Options {
    Options { method, boundary_weight, ..Options::default() }
}

/// Boundary edges of a mesh, as faces without area.
fn rim(mesh: &Mesh) -> Mesh {
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    let sides = (0..mesh.faces.len()).flat_map(|f| (0..3).map(move |k| (f, k)));
    let open =
        sides.filter(|&(f, k)| connectivity.twin(Side::new(FaceId::new(f), k)) == Twin::Boundary);
    let edge = |(f, k): (usize, usize)| {
        let [from, to] = [mesh.faces[f][k], mesh.faces[f][(k + 1) % 3]];
        [from, to, to]
    };
    Mesh::new(mesh.positions.clone(), open.map(edge).collect())
}

/// Mean distance of the boundary's vertices from the boundary of a level.
fn slipped(mesh: &Mesh, level: &Mesh) -> f64 {
    let now = Bvh::new(&rim(level)).unwrap();
    let ends: Vec<VertexId> = rim(mesh).faces.iter().map(|edge| edge[0]).collect();
    let away = |v: &VertexId| now.closest(mesh.positions[v.index()], None).distance_squared.sqrt();
    ends.iter().map(away).sum::<f64>() / ends.len() as f64
}

fn hills() -> Mesh {
    Mesh { attributes: None, ..samples::terrain(8000) }
}

#[test]
fn a_higher_weight_keeps_a_boundary_closer() {
    let mesh = hills();
    let slips = |on_kernel: bool, options: &Options| {
        let start = if on_kernel { Simplifier::new } else { Simplifier::on_policy_engine };
        let mut simplifier = start(&mesh, options).unwrap();
        assert!(simplifier.run(Target::Ratio(0.05), &mut ()).unwrap().reached);
        slipped(&mesh, &simplifier.level())
    };
    for (method, on_kernel) in [
        (Method::LindstromTurk, true),
        (Method::LindstromTurk, false),
        (Method::LindstromTurkFaces, false),
        (Method::Qem, true),
        (Method::Qem, false),
        (Method::KimJang, false),
    ] {
        assert!(method.weighs_boundaries());
        let weights = [0.01, 1.0, 100.0];
        let [low, middle, high] =
            weights.map(|weight| slips(on_kernel, &options(method, Some(weight))));
        let falls = high < 0.8 * middle && middle < 0.95 * low;
        assert!(falls, "{method:?}, kernel {on_kernel}: {low} {middle} {high}");
    }
}

#[test]
fn the_default_weight_is_that_of_the_method() {
    let mesh = hills();
    for (method, weight) in
        [(Method::LindstromTurk, 9.0), (Method::LindstromTurkFaces, 9.0), (Method::Qem, 2.0)]
    {
        let [given, own] = [Some(weight), None].map(|weight| {
            contract_to(&mesh, Target::Ratio(0.2), &options(method, weight)).unwrap()
        });
        assert_eq!(given, own, "{method:?}");
    }
}

#[test]
fn zero_and_huge_weights_are_accepted() {
    let mesh = hills();
    for method in [Method::LindstromTurk, Method::Qem] {
        for weight in [0.0, 1e300] {
            let (level, report) =
                contract_to(&mesh, Target::Ratio(0.2), &options(method, Some(weight))).unwrap();
            assert!(report.reached, "{method:?} {weight}: {report:?}");
            level.validate().unwrap();
        }
    }
}

#[test]
fn invalid_weights_are_refused() {
    for weight in [-1.0, f64::NAN, f64::INFINITY] {
        let refused = contract_to(
            &hills(),
            Target::Ratio(0.5),
            &options(Method::LindstromTurk, Some(weight)),
        );
        assert!(matches!(refused, Err(SimplifyError::BadWeight(_))), "{weight}");
    }
}
