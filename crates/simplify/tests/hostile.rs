//! Meshes made to be slow or to break the arithmetic. They must terminate, with a valid result or
//! an error.

use meshlod_fixtures as fixtures;
use meshlod_mesh::{Attributes, Connectivity, Layer, LayerKind, Mesh, VertexId, WedgeId};
use meshlod_samples as samples;
use meshlod_simplify::{Method, Options, Refusal, SimplifyError, Target, contract_to};

fn run(mesh: &Mesh, target: Target) -> (Mesh, meshlod_simplify::Report) {
    contract_to(mesh, target, &Options::default()).unwrap()
}

#[test]
fn a_flat_grows_no_hubs() {
    let (level, report) = run(&fixtures::grid(200), Target::Ratio(0.02));
    assert!(report.reached);
    assert_eq!(report.refusals.count(Refusal::Valence), 0);
    let connectivity = Connectivity::new(&level.faces, level.positions.len());
    let valence = |v| connectivity.star(VertexId::new(v)).len();
    let most = (0..level.positions.len()).map(valence).max().unwrap();
    assert!(most < 40, "a vertex of {most} faces");
}

#[test]
fn a_hub_shrinks_with_its_rim() {
    for method in Method::ALL {
        let options = Options { method, ..Options::default() };
        let (level, report) =
            contract_to(&fixtures::cone(20_000), Target::Faces(100), &options).unwrap();
        assert!(report.reached, "{}: {}", method.name(), report.refusals);
        assert!((level.bounds().max[2] - 0.5).abs() < 0.05, "{}: the tip is gone", method.name());
    }
}

#[test]
fn a_hub_given_twice_is_a_hub() {
    let mut mesh = fixtures::cone(20_000);
    mesh.faces.extend_from_within(..);
    let (_, report) = run(&mesh, Target::Faces(100));
    assert_eq!((report.duplicate_faces, report.reached), (20_000, true));
}

#[test]
fn a_bound_holds_where_faces_have_no_area() {
    let positions = (0..200).map(|i| [f64::from(i) * f64::from(i), 0.0, 0.0]).collect();
    let strip = |i: u32| [VertexId(i), VertexId(i + 1), VertexId(i + 2)];
    let mesh = Mesh::new(positions, (0..198).map(strip).collect());
    let (level, report) = run(&mesh, Target::Error(1e-6));
    assert!(report.error_estimate <= 1e-6);
    let ends = |mesh: &Mesh| [mesh.bounds().min[0], mesh.bounds().max[0]];
    let [from, to] = ends(&level);
    assert!(from.abs() < 1e-5 && (to - ends(&mesh)[1]).abs() < 1e-5, "{from} {to}");
}

#[test]
fn scale_changes_nothing_until_it_is_refused_by_name() {
    let scaled = |factor: f64, method| {
        let mut mesh = samples::torus(1000);
        mesh.positions.iter_mut().flatten().for_each(|x| *x *= factor);
        contract_to(&mesh, Target::Ratio(0.1), &Options { method, ..Options::default() })
    };
    for method in Method::ALL {
        let faces = |factor| scaled(factor, method).unwrap().0.faces;
        // Scaling by a power of two does not change rounding.
        for factor in [2f64.powi(-90), 2f64.powi(90)] {
            assert_eq!(faces(factor), faces(1.0), "{} at {factor:e}", method.name());
        }
    }
    for factor in [1e-40, 1e40] {
        let refused = scaled(factor, Method::default());
        assert!(matches!(refused, Err(SimplifyError::Extent { .. })), "{factor:e}");
    }
}

#[test]
fn all_in_one_point_ends() {
    let mut mesh = samples::sphere(2000);
    mesh.positions.fill([1.0; 3]);
    let (level, _) = run(&mesh, Target::Ratio(0.1));
    assert!(level.faces.len() <= mesh.faces.len());
}

/// Sphere with one layer of four values per vertex.
fn with_layer(kind: LayerKind, value: impl Fn(usize) -> [f32; 4]) -> Mesh {
    let mut mesh = samples::sphere(2000);
    let count = mesh.positions.len();
    mesh.attributes = Some(Attributes {
        corners: mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect(),
        wedge_count: count,
        layers: vec![Layer {
            kind,
            name: String::new(),
            width: 4,
            values: (0..count).flat_map(value).collect(),
        }],
    });
    mesh
}

#[test]
fn the_hand_of_a_tangent_stays_one_or_minus_one() {
    let hand = |v: usize| if v.is_multiple_of(2) { 1.0 } else { -1.0 };
    let mesh = with_layer(LayerKind::Tangent, |v| [1.0, 0.0, 0.0, hand(v)]);
    let (level, _) = run(&mesh, Target::Ratio(0.1));
    let values = &level.attributes.unwrap().layers[0].values;
    assert!(values.iter().skip(3).step_by(4).all(|w| w.abs() == 1.0));
}

#[test]
fn joints_are_never_blended() {
    let mesh = with_layer(LayerKind::Joints(0), |v| [(v % 50) as f32; 4]);
    let (level, _) = run(&mesh, Target::Ratio(0.1));
    let values = &level.attributes.unwrap().layers[0].values;
    assert!(values.iter().all(|joint| joint.fract() == 0.0));
}

#[test]
fn a_wedge_at_two_vertices_is_refused() {
    let mut mesh = with_layer(LayerKind::Other, |_| [0.0; 4]);
    mesh.attributes.as_mut().unwrap().corners[0].swap(0, 1);
    let error = contract_to(&mesh, Target::Ratio(0.5), &Options::default()).unwrap_err();
    assert!(matches!(error, SimplifyError::Mesh(_)), "{error}");
}

/// Closed fold: two sheets so close that their normals nearly cancel.
fn fold() -> Mesh {
    let mut mesh = samples::sphere(2000);
    mesh.positions.iter_mut().for_each(|p| p[2] *= 1e-7);
    mesh
}

#[test]
fn no_vertex_leaves_the_box_of_a_fold() {
    let mesh = fold();
    let bounds = mesh.bounds();
    for method in Method::ALL {
        let options = Options { method, ..Options::default() };
        let (level, _) = contract_to(&mesh, Target::Ratio(0.05), &options).unwrap();
        for axis in 0..3 {
            let room = 0.1 * bounds.diagonal();
            let (least, most) = (bounds.min[axis] - room, bounds.max[axis] + room);
            let inside = |p: &[f64; 3]| (least..most).contains(&p[axis]);
            assert!(level.positions.iter().all(inside), "{}", method.name());
        }
    }
}

#[test]
fn a_hub_that_shares_its_vertex_with_a_surface_in_parts_is_simplified() {
    // The apex of the cone is a copy with more neighbours than a vertex has room for.
    let mut mesh = Mesh { attributes: None, ..samples::sphere(120_000) };
    let (count, tip) = (mesh.positions.len() as u32, mesh.positions[0]);
    let cone = fixtures::cone(30);
    let beside = |p: &[f64; 3]| [0, 1, 2].map(|axis| tip[axis] * 1.1 + 0.1 * p[axis]);
    mesh.positions.extend(cone.positions[1..].iter().map(beside));
    let joined = |v: VertexId| VertexId(if v.0 == 0 { 0 } else { count + v.0 - 1 });
    mesh.faces.extend(cone.faces.iter().map(|face| face.map(joined)));
    for method in [Method::LindstromTurk, Method::Qem] {
        let options = Options { method, ..Options::default() };
        let (level, report) = contract_to(&mesh, Target::Faces(200), &options).unwrap();
        assert!(report.reached && report.non_manifold_vertices == 1);
        assert_eq!(level.faces.len(), report.output_faces);
    }
}
