//! Values of attributes in files: their bytes, their errors, and that parts of a file have the same.

use glam::DVec3;
use meshlod_fixtures as fixtures;
use meshlod_mesh::{AttributeBounds, Attributes, Layer, LayerKind, Mesh, WedgeId};
use meshlod_samples as samples;

use super::{Archive, Storage, diagonal, lattice};
use crate::forest::Stage;
use crate::tests::attributes::corner_values;
use crate::tests::walks::{Dice, query};
use crate::wedges::WedgeNumbers;
use crate::{Cut, Forest, Implicit, StoredErrors};

/// Reads the meshes of a scene, and a bound on the bytes that attributes take for each wedge.
fn models() -> impl Iterator<Item = (&'static str, f64, Vec<Mesh>)> {
    let all = [
        ("duck.glb", 4.8),
        ("spot.obj", 2.8),
        ("fish-bream.obj", 4.05),
        ("flight-helmet/FlightHelmet.gltf", 5.8),
    ];
    all.into_iter().filter_map(|(name, most)| {
        let Some(path) = fixtures::shared_mesh(name) else {
            eprintln!("skipped: {name} is missing");
            return None;
        };
        let scene = meshlod_io::read(&path, &meshlod_io::ReadOptions::default()).unwrap();
        Some((name, most, scene.meshes.into_iter().map(|mesh| mesh.mesh).collect()))
    })
}

fn forest(mesh: &Mesh) -> Forest {
    Forest::new(mesh, &Default::default()).unwrap()
}

fn is_predicted_last(layer: &Layer) -> bool {
    layer.kind == LayerKind::Tangent
}

/// Returns the size of a file of the first `layers` attribute layers, with the order of contractions
/// or without.
fn size(forest: &Forest, layers: Option<usize>, has_order: bool) -> usize {
    let mut forest = forest.clone();
    match (layers, &mut forest.wedges) {
        (Some(layers), Some(wedges)) => {
            let all = 0..wedges.len() as u32;
            let mut values = wedges.values.packed(all.clone()).layers(all.clone());
            values.sort_by_key(is_predicted_last);
            values.truncate(layers);
            wedges.values = WedgeNumbers::exact(&values);
            all.for_each(|wedge| wedges.values.push(&values, Some(WedgeId(wedge))));
        }
        _ => forest.wedges = None,
    }
    if !has_order {
        forest.updates.iter_mut().for_each(|update| update.stage = Stage::default());
    }
    Archive::write(&forest, &Storage::default()).unwrap().0.into_source().len()
}

/// `cargo test --release -p meshlod-multires --lib attributes_take -- --nocapture` prints the figures:
/// what wedges take, the order of contractions, and then each layer.
#[test]
fn attributes_take_few_bytes() {
    for (name, most, meshes) in models() {
        let (mut wedges, mut parts) = (0, Vec::<(String, usize)>::new());
        let mut add = |at: usize, what: &str, bytes: usize| {
            if parts.len() <= at {
                parts.push((what.into(), 0));
            }
            parts[at].1 += bytes;
        };
        for mesh in &meshes {
            let forest = forest(mesh);
            let all = mesh.attributes.as_ref();
            let mut layers = all.map_or(Vec::new(), |all| all.layers.clone());
            layers.sort_by_key(is_predicted_last);
            let mut last = size(&forest, Some(0), false);
            add(0, "names of wedges", last - size(&forest, None, false));
            let with_order = size(&forest, Some(0), true);
            add(1, "order", with_order - last);
            last = with_order;
            for (at, layer) in layers.iter().enumerate() {
                let next = size(&forest, Some(at + 1), true);
                add(at + 2, &format!("{:?}", layer.kind), next - last);
                last = next;
            }
            wedges += all.map_or(0, |all| all.wedge_count);
        }
        let each = |bytes: usize| bytes as f64 / wedges as f64;
        let all = each(parts.iter().map(|part| part.1).sum());
        let parts: Vec<String> =
            parts.iter().map(|(what, bytes)| format!("{what} {:.2}", each(*bytes))).collect();
        println!("{name}: {wedges} wedges, {all:.2} bytes for each: {}", parts.join(", "));
        assert!(all < most, "{name}: {all}");
    }
}

/// Where a value is linear over the surface, so are the differences of children, and what a parent is
/// off the line between them: both follow from the wedges around.
#[test]
fn linear_values_take_next_to_nothing() {
    let mut mesh = samples::torus(4000);
    let values = mesh.positions.iter().flat_map(|&at| {
        let at = DVec3::from(at);
        [0.4 + 0.2 * at.x - 0.1 * at.y, 0.5 + 0.15 * at.y + 0.2 * at.z].map(|x| x as f32)
    });
    let layer =
        Layer { kind: LayerKind::Uv(0), name: "uv".into(), width: 2, values: values.collect() };
    mesh.attributes = Some(Attributes {
        corners: mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect(),
        wedge_count: mesh.positions.len(),
        layers: vec![layer],
    });
    let forest = forest(&mesh);
    let bytes = size(&forest, Some(1), false) - size(&forest, Some(0), false);
    let each = bytes as f64 / mesh.positions.len() as f64;
    assert!(each < 0.75, "{each}");
}

/// Returns a torus with values at its vertices, and those of all levels in its file.
fn with_values(kind: LayerKind, value: impl FnMut(usize) -> f32) -> (Mesh, Vec<f32>) {
    let mut mesh = samples::torus(2000);
    let wedge_count = mesh.positions.len();
    let values = (0..wedge_count).map(value).collect();
    mesh.attributes = Some(Attributes {
        corners: mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect(),
        wedge_count,
        layers: vec![Layer { kind, name: "it".into(), width: 1, values }],
    });
    let file = Archive::write(&forest(&mesh), &Storage::default()).unwrap().0.into_source();
    let is = Archive::open(file).unwrap().read().unwrap().0;
    let mut values = Vec::new();
    (0..is.wedge_count() as u32).for_each(|wedge| is.append_values(wedge, &mut values));
    (mesh, values)
}

#[test]
fn no_level_has_colours_beyond_those_of_the_mesh() {
    let (_, values) = with_values(LayerKind::Color(0), |v| if v % 7 < 3 { 1.0 } else { 0.0 });
    assert!(values.iter().all(|x| (0.0..=1.0).contains(x)));
    assert!(values.iter().any(|x| (0.2..0.8).contains(x)), "levels mix the colours");
}

#[test]
fn a_stray_value_takes_nothing_from_the_others() {
    let (mesh, values) =
        with_values(LayerKind::Color(0), |v| if v == 40 { 1e9 } else { v as f32 / 999.0 });
    let attributes = mesh.attributes.as_ref().unwrap();
    for was in &attributes.layers[0].values {
        assert!(values.iter().any(|is| (is - was).abs() <= 1.0 / 512.0), "{was}");
    }
}

/// Returns the model of a forest with the positions and the order of nodes that a file has.
fn rounded(forest: &Forest, storage: &Storage) -> Implicit {
    let cells = lattice(forest, storage, diagonal(forest));
    Implicit::new(&forest.clone().quantized(cells, StoredErrors::AsRecorded).forest).unwrap()
}

#[test]
fn values_of_vertices_that_are_split_are_off_by_a_few_bounds_more() {
    let bounds = AttributeBounds::default();
    let mut off = 0.0f32;
    for (name, _, meshes) in models() {
        let forest = forest(&meshes[0]);
        let storage = Storage::default();
        let was = rounded(&forest, &storage);
        let file = Archive::write(&forest, &storage).unwrap().0.into_source();
        let is = Archive::open(file).unwrap().read().unwrap().0;
        let (mut was_values, mut values) = (Vec::new(), Vec::new());
        let mut end = 0;
        for layer in is.layers() {
            let start = end;
            end += layer.width;
            let (bound, times) = match layer.kind {
                LayerKind::Uv(_) => (bounds.uv as f32, 3.0),
                LayerKind::Normal => (2.0 * bounds.direction_rad as f32, 13.0),
                _ => continue,
            };
            for node in 0..was.node_count() as u32 {
                assert_eq!(was.wedges_of(node), is.wedges_of(node), "{name}");
                let times = if was.update_of(node).is_some() { times } else { 1.0 };
                for wedge in was.wedges_of(node) {
                    for (model, values) in [(&was, &mut was_values), (&is, &mut values)] {
                        values.clear();
                        model.append_values(wedge, values);
                    }
                    for (a, b) in was_values[start..end].iter().zip(&values[start..end]) {
                        assert!((a - b).abs() <= times * bound + 1e-6, "{name} {node}: {a} {b}");
                        off = off.max((a - b).abs() / bound);
                    }
                }
            }
        }
    }
    assert!(off == 0.0 || off > 3.0, "the leeway is used where there are models: {off}");
}

/// Returns a torus with charts, and as normals and tangents directions that either follow the surface or
/// none at all.
fn with_directions(is_smooth: bool) -> Mesh {
    let mut mesh = fixtures::charted(&samples::torus(900));
    let Some(attributes) = &mut mesh.attributes else { unreachable!("it has charts") };
    let mut at = vec![DVec3::ZERO; attributes.wedge_count];
    for (face, corners) in mesh.faces.iter().zip(&attributes.corners) {
        for (v, wedge) in face.iter().zip(corners) {
            at[wedge.index()] = mesh.positions[v.index()].into();
        }
    }
    let mut dice = Dice(7);
    let (mut normals, mut tangents) = (Vec::new(), Vec::new());
    for place in at {
        let ring = DVec3::new(place.x, place.y, 0.0).normalize_or(DVec3::X);
        let [normal, tangent] = match is_smooth {
            true => [(place - 0.7 * ring).normalize_or(ring), ring.cross(DVec3::Z)],
            false => [0, 1].map(|_| {
                let [x, y, z] = [0; 3].map(|_| dice.roll() - 0.5);
                DVec3::new(x, y, z).normalize_or(DVec3::X)
            }),
        };
        normals.extend(normal.as_vec3().to_array());
        tangents.extend(tangent.as_vec3().to_array());
        tangents.push(if dice.roll() < 0.3 { -1.0 } else { 1.0 });
    }
    let layer = |kind, width, values| Layer { kind, name: String::new(), width, values };
    attributes.layers.push(layer(LayerKind::Tangent, 4, tangents));
    attributes.layers.push(layer(LayerKind::Normal, 3, normals));
    mesh
}

#[test]
fn directions_across_folds_come_back_from_any_part_of_a_file() {
    for is_smooth in [true, false] {
        let mesh = with_directions(is_smooth);
        let forest = forest(&mesh);
        let storage = Storage { updates_per_chunk: 60, ..Storage::default() };
        let archive = Archive::write(&forest, &storage).unwrap().0;
        let mt = archive.read().unwrap().0;
        let is = rounded(&forest, &storage);
        let uvs: usize = is.layers().take_while(|layer| layer.width < 3).map(|all| all.width).sum();
        let bound = 1.01 * AttributeBounds::default().direction_rad as f32;
        for node in (0..is.node_count() as u32).filter(|&node| is.children_of(node).is_none()) {
            for wedge in is.wedges_of(node) {
                let (mut was, mut read) = (Vec::new(), Vec::new());
                is.append_values(wedge, &mut was);
                mt.append_values(wedge, &mut read);
                assert_eq!(was.len(), uvs + 3 + 4);
                let off = was.iter().zip(&read).skip(uvs).map(|(a, b)| (a - b).abs());
                assert!(off.fold(0.0, f32::max) <= bound, "{is_smooth} {node}: {was:?} {read:?}");
            }
        }
        let mut dice = Dice(4);
        for _ in 0..12 {
            let query = query(&mut dice, &mesh);
            let part = archive.extract(&query).unwrap().level.mesh();
            let whole = Cut::at(&mt, &query).unwrap().level().mesh();
            assert_eq!(corner_values(&part), corner_values(&whole), "{is_smooth}: {query:?}");
        }
    }
}
