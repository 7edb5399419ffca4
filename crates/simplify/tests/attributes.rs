//! Attributes through simplification.

use std::collections::HashMap;

use meshlod_fixtures as fixtures;
use meshlod_mesh::{Attributes, Layer, LayerKind, Mesh, VertexId, WedgeId};
use meshlod_samples as samples;
use meshlod_simplify::{
    AttributeWeights, Method, Options, Simplifier, SimplifyError, Target, contract_to,
};

/// A layer as a function of the position.
type Painted = (LayerKind, fn([f64; 3]) -> Vec<f32>);

/// Gives every vertex one wedge, with these layers.
fn with_layers(mesh: Mesh, layers: &[Painted]) -> Mesh {
    let layer = |&(kind, of): &Painted| Layer {
        kind,
        name: String::new(),
        width: of([0.0; 3]).len(),
        values: mesh.positions.iter().flat_map(|&p| of(p)).collect(),
    };
    let attributes = Attributes {
        corners: mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect(),
        wedge_count: mesh.positions.len(),
        layers: layers.iter().map(layer).collect(),
    };
    Mesh { attributes: Some(attributes), ..mesh }
}

fn to(mesh: &Mesh, method: Method, ratio: f64) -> Mesh {
    contract_to(mesh, Target::Ratio(ratio), &Options { method, ..Options::default() }).unwrap().0
}

/// Every corner with its position and its values in a layer.
fn corners(mesh: &Mesh, layer: usize) -> impl Iterator<Item = ([f64; 3], &[f32])> {
    let attributes = mesh.attributes.as_ref().unwrap();
    let wedges = attributes.corners.iter().flatten();
    let positions = mesh.faces.iter().flatten().map(|v| mesh.positions[v.index()]);
    positions.zip(wedges.map(move |&w| attributes.layers[layer].of(w)))
}

#[test]
fn what_is_linear_on_a_flat_stays_so() {
    let uv = |[x, y, _]: [f64; 3]| vec![(0.3 * x + 0.1 * y) as f32, (0.2 * y - 0.1 * x) as f32];
    let other = |[x, y, _]: [f64; 3]| vec![(x - 2.0 * y + 5.0) as f32 / 16.0];
    let flat =
        with_layers(fixtures::grid(16), &[(LayerKind::Uv(0), uv), (LayerKind::Other, other)]);
    for method in Method::ALL {
        let level = to(&flat, method, 0.1);
        assert!(level.faces.len() < 60, "{}", method.name());
        for (layer, of) in [(0, uv as fn(_) -> _), (1, other)] {
            for (p, found) in corners(&level, layer) {
                let expected = of(p);
                let off = found.iter().zip(&expected).map(|(a, b)| (a - b).abs());
                assert!(off.fold(0.0, f32::max) < 1e-4, "{}: {p:?} {found:?}", method.name());
            }
        }
    }
}

#[test]
fn an_end_that_stays_keeps_its_values_to_the_bit() {
    let of = |[x, y, z]: [f64; 3]| vec![(x * x).sin() as f32, (y + z * 7.0).cos() as f32];
    let mesh = with_layers(samples::torus(1000), &[(LayerKind::Uv(0), of)]);
    for method in [Method::QemEndpoint, Method::Spr] {
        for (p, found) in corners(&to(&mesh, method, 0.1), 0) {
            assert_eq!(found, of(p));
        }
    }
}

/// Fraction of a unit square's left half that is dark in a mesh with grey levels, and of its right
/// half.
fn dark_halves(mesh: &Mesh) -> [f64; 2] {
    let mut dark = [0.0; 2];
    let attributes = mesh.attributes.as_ref().unwrap();
    for (face, wedges) in mesh.faces.iter().zip(&attributes.corners) {
        let [a, b, c] = mesh.triangle(*face);
        let area = 0.5 * (b - a).cross(c - a).length();
        let grey = wedges.map(|w| f64::from(attributes.layers[0].of(w)[0]));
        let side = usize::from(a.x + b.x + c.x > 1.5);
        dark[side] += 2.0 * area * (1.0 - grey.iter().sum::<f64>() / 3.0);
    }
    dark
}

#[test]
fn an_edge_between_colours_is_kept_where_colours_count() {
    let side = 24;
    let mut square = fixtures::grid(side);
    square.positions.iter_mut().flatten().for_each(|x| *x /= side as f64);
    // Dark to the left of 0.52, across the grid's lines.
    let of = |[x, y, _]: [f64; 3]| vec![f32::from(u8::from(x + 0.1 * y > 0.57)); 3];
    let square = with_layers(square, &[(LayerKind::Color(0), of)]);
    let off = |weights| {
        let options = Options { weights, ..Options::default() };
        let (level, report) = contract_to(&square, Target::Faces(60), &options).unwrap();
        assert!(report.reached);
        let [before, after] = [&square, &level].map(dark_halves);
        (before[0] - after[0]).abs() + (before[1] - after[1]).abs()
    };
    let (with, without) = (off(AttributeWeights::DEFAULT), off(AttributeWeights::NONE));
    assert!(with < 0.05 && 2.5 * with < without, "{with} with colours, {without} without");
}

#[test]
fn skin_weights_stay_one_in_all() {
    let joints =
        |[x, y, _]: [f64; 3]| vec![(x * 9.0).floor() as f32, (y * 7.0).floor() as f32, 98.0, 99.0];
    let weights = |[x, y, _]: [f64; 3]| {
        let [a, b] = [x.sin().abs() * 0.5, y.cos().abs() * 0.5].map(|w| w as f32);
        vec![a, b, 1.0 - a - b, 0.0]
    };
    let mesh = with_layers(
        samples::knot(2000),
        &[(LayerKind::Joints(0), joints), (LayerKind::Weights(0), weights)],
    );
    for method in Method::ALL {
        let level = to(&mesh, method, 0.1);
        for (_, weights) in corners(&level, 1) {
            assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-5, "{weights:?}");
        }
        let known: Vec<f32> = corners(&mesh, 0).flat_map(|(_, joints)| joints).copied().collect();
        assert!(corners(&level, 0).flat_map(|(_, joints)| joints).all(|j| known.contains(j)));
    }
}

/// Tube around z whose texture wraps once and meets itself along x = 1, y = 0.
fn tube(around: u32, along: u32) -> Mesh {
    let at = |i: u32, j: u32| VertexId(j * around + i % around);
    // The last column of wedges belongs to the vertices of the first.
    let wedge = |i: u32, j: u32| WedgeId(j * (around + 1) + i);
    let mut mesh = Mesh::default();
    let mut values = Vec::new();
    for j in 0..=along {
        for i in 0..=around {
            let angle = f64::from(i % around) / f64::from(around) * std::f64::consts::TAU;
            if i < around {
                mesh.positions.push([angle.cos(), angle.sin(), f64::from(j) * 0.1]);
            }
            values.extend([i as f32 / around as f32, j as f32 / along as f32]);
        }
    }
    let mut corners = Vec::new();
    for (i, j) in (0..along).flat_map(|j| (0..around).map(move |i| (i, j))) {
        let quad = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
        for triangle in [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|k: usize| quad[k])) {
            mesh.faces.push(triangle.map(|(i, j)| at(i, j)));
            corners.push(triangle.map(|(i, j)| wedge(i, j)));
        }
    }
    let wedge_count = ((around + 1) * (along + 1)) as usize;
    let uv = Layer { kind: LayerKind::Uv(0), name: String::new(), width: 2, values };
    mesh.attributes = Some(Attributes { corners, wedge_count, layers: vec![uv] });
    mesh
}

#[test]
fn a_texture_meets_itself_along_its_seam() {
    let tube = tube(32, 20);
    tube.validate().unwrap();
    for method in Method::ALL {
        let level = to(&tube, method, 0.1);
        assert!(
            level.faces.len() <= tube.faces.len() / 4,
            "{}: {}",
            method.name(),
            level.faces.len()
        );
        let mut us = vec![Vec::new(); level.positions.len()];
        let vertices = level.faces.iter().flatten();
        for (v, (p, uv)) in vertices.zip(corners(&level, 0)) {
            let turn = (p[1].atan2(p[0]) / std::f64::consts::TAU).rem_euclid(1.0);
            let off = (turn - f64::from(uv[0]) + 0.5).rem_euclid(1.0) - 0.5;
            assert!(off.abs() < 0.03, "{}: {p:?} {uv:?}", method.name());
            us[v.index()].push(uv[0]);
        }
        // Only vertices on the seam, where the texture begins and ends, have two texture
        // coordinates.
        let seam: Vec<_> = us.iter().filter(|us| us.iter().any(|u| *u != us[0])).collect();
        assert!(seam.len() >= 2, "{}", method.name());
        let at_an_end = |u: &f32| *u < 0.03 || *u > 0.97;
        assert!(seam.iter().all(|us| us.iter().all(at_an_end)), "{}: {seam:?}", method.name());
    }
}

#[test]
fn attributes_cost_lindstrom_turk_no_volume() {
    let uv = |[x, y, z]: [f64; 3]| vec![(x * y) as f32, (z + x * x) as f32];
    let mesh = with_layers(samples::torus(5000), &[(LayerKind::Uv(0), uv)]);
    let volume = |mesh: &Mesh| -> f64 {
        let sixfold = |&face| {
            let [a, b, c] = mesh.triangle(face);
            a.cross(b).dot(c)
        };
        mesh.faces.iter().map(sixfold).sum::<f64>()
    };
    let level = to(&mesh, Method::LindstromTurk, 0.1);
    assert!(level.faces.len() <= mesh.faces.len() / 10);
    let drift = volume(&level) / volume(&mesh) - 1.0;
    assert!(drift.abs() < 1e-6, "{drift}");
}

#[test]
fn one_value_far_from_all_others_does_no_harm() {
    let three: fn([f64; 3]) -> Vec<f32> = |at| at.map(|x| x as f32).to_vec();
    let two: fn([f64; 3]) -> Vec<f32> = |[x, y, _]| vec![x as f32, y as f32];
    let layers =
        [(LayerKind::Normal, three), (LayerKind::Color(0), three), (LayerKind::Uv(0), two)];
    let mesh = with_layers(samples::sphere(2000), &layers);
    for (layer, far) in (0..3).flat_map(|layer| [1e18, 1e24, 1e36].map(|far| (layer, far))) {
        let mut mesh = mesh.clone();
        let layers = &mut mesh.attributes.as_mut().unwrap().layers;
        let middle = layers[layer].values.len() / 2;
        layers[layer].values[middle] = far;
        let level = to(&mesh, Method::LindstromTurk, 0.2);
        assert!(level.faces.len() <= 400, "{layer}, {far}: {}", level.faces.len());
    }
}

#[test]
fn values_out_of_all_bounds_do_no_harm() {
    let uv =
        |[x, y, _]: [f64; 3]| vec![(x * 3e38) as f32, if y > 0.5 { f32::MAX } else { f32::MIN }];
    let normal = |[x, y, _]: [f64; 3]| match () {
        _ if x > 0.8 => vec![f32::NAN; 3],
        _ if y > 0.8 => vec![f32::INFINITY; 3],
        _ => vec![0.0; 3],
    };
    let mut mesh = samples::sphere(1000);
    // Faces without area, and some with hardly any.
    for face in [3, 50, 400] {
        let [a, b, _] = mesh.faces[face];
        let [a, b] = [a, b].map(|v| v.index());
        mesh.positions[b] = mesh.positions[a];
        mesh.positions[b][2] += f64::MIN_POSITIVE;
    }
    let mesh = with_layers(mesh, &[(LayerKind::Uv(0), uv), (LayerKind::Normal, normal)]);
    for method in Method::ALL {
        let level = to(&mesh, method, 0.1);
        level.validate().unwrap();
        assert!(level.faces.len() < 500, "{} stops at {}", method.name(), level.faces.len());
        assert!(corners(&level, 0).all(|(_, uv)| uv.iter().all(|x| x.is_finite())));
    }
}

#[test]
fn weights_are_numbers_of_at_least_0() {
    for uv in [-1.0, f64::NAN, f64::INFINITY] {
        let weights = AttributeWeights { uv, ..AttributeWeights::DEFAULT };
        let options = Options { weights, ..Options::default() };
        let refused = contract_to(&samples::sphere(100), Target::Ratio(0.5), &options);
        assert!(matches!(refused, Err(SimplifyError::BadWeight(_))));
    }
}

#[test]
fn attributes_that_count_for_nothing_change_no_position() {
    let mesh = samples::fish(1000);
    let bare = Mesh { attributes: None, ..mesh.clone() };
    let (weights, method) = (AttributeWeights::NONE, Method::Qem);
    let options = Options { weights, method, ..Options::default() };
    // Seams still count, so the comparison uses a mesh without any.
    let flat = with_layers(bare.clone(), &[(LayerKind::Color(0), |[x, ..]| vec![x as f32; 3])]);
    let [with, without] = [&flat, &bare].map(|mesh| {
        // The policy engine, since the kernel takes another path where there are none at all.
        let mut simplifier = Simplifier::on_policy_engine(mesh, &options).unwrap();
        simplifier.run(Target::Ratio(0.1), &mut ()).unwrap();
        simplifier.level()
    });
    assert_eq!((with.positions, with.faces), (without.positions, without.faces));
}

/// Textured torus with a separate normal at every corner.
fn faceted() -> Mesh {
    let mesh = samples::torus(2000);
    let around = |p: [f64; 3]| vec![p[1].atan2(p[0]).cos() as f32, p[2] as f32];
    let uv = mesh.faces.iter().flatten().flat_map(|&v| around(mesh.positions[v.index()]));
    let normals = mesh.faces.iter().flat_map(|&face| {
        let [a, b, c] = mesh.triangle(face);
        [(b - a).cross(c - a).normalize().as_vec3().to_array(); 3].concat()
    });
    let layer = |kind, width, values| Layer { kind, name: String::new(), width, values };
    let layers = vec![
        layer(LayerKind::Uv(0), 2, uv.collect()),
        layer(LayerKind::Normal, 3, normals.collect()),
        layer(LayerKind::Uv(1), 2, vec![0.25; 6 * mesh.faces.len()]),
    ];
    let wedge_count = 3 * mesh.faces.len();
    let corners: Vec<_> = (0..wedge_count).map(WedgeId::new).collect();
    let corners = corners.as_chunks::<3>().0.to_vec();
    Mesh { attributes: Some(Attributes { corners, wedge_count, layers }), ..mesh }
}

#[test]
fn creases_in_the_shading_stop_nothing_and_tear_no_texture() {
    let mesh = faceted();
    for method in [Method::Qem, Method::LindstromTurk] {
        let level = to(&mesh, method, 0.05);
        assert!(level.faces.len() <= 100, "{} {}", method.name(), level.faces.len());
        let mut uvs = HashMap::new();
        for (place, uv) in corners(&level, 0) {
            let at = uvs.entry(place.map(f64::to_bits)).or_insert(uv);
            assert_eq!(*at, uv, "{}", method.name());
        }
        assert!(level.attributes.as_ref().unwrap().wedge_count > 2 * level.positions.len());
    }
}

/// Number of faces flipped in their texture.
fn turned(mesh: &Mesh) -> usize {
    let area =
        |[a, b, c]: [&[f32]; 3]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let uvs: Vec<&[f32]> = corners(mesh, 0).map(|(_, uv)| uv).collect();
    uvs.as_chunks::<3>().0.iter().filter(|face| area(**face) < 0.0).count()
}

#[test]
fn few_faces_flip_in_their_texture() {
    // Texture bent back and forth until it nearly folds, on a hill with bends of its own.
    let mut hill = fixtures::grid(100);
    hill.positions.iter_mut().for_each(|[x, y, z]| *z = 4.0 * (*x * 0.4).sin() * (*y * 0.3).cos());
    let uv = |[x, y, _]: [f64; 3]| {
        vec![(x + 3.2 * (0.3 * y).sin()) as f32, (y + 3.2 * (0.3 * x).sin()) as f32]
    };
    let hill = with_layers(hill, &[(LayerKind::Uv(0), uv)]);
    assert_eq!(turned(&hill), 0);
    let levels = [0.1, 0.05].map(|ratio| turned(&to(&hill, Method::LindstromTurk, ratio)));
    // Without a check they are 18 and 13; the order of edges changes this by about 4.
    assert!(levels[0] + levels[1] <= 20, "{levels:?}");
}
