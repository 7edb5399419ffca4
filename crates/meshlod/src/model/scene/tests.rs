//! Scenes into files and out of them.

use glam::{DMat4, DVec3};
use meshlod_io::{Image, Material, Node, ReadOptions, Scene, SceneMesh, gltf};
use meshlod_measure::{DistanceOptions, distance};
use meshlod_mesh::{Attributes, Labels, Layer, LayerKind, Mesh, WedgeId};
use meshlod_multires::{Archive, Forest, Query, Resource, Storage};
use meshlod_picture::Picture;
use meshlod_samples as samples;
use meshlod_simplify::Options;

use super::*;
use crate::Constraints;

/// Returns a picture of noise, which does not compress.
fn noise(side: u32) -> Image {
    let mut state = 1u64;
    let bytes = (0..4 * side * side).map(|_| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 56) as u8
    });
    let png = Picture::new(side, side, bytes.collect()).unwrap().png();
    Image { name: format!("noise {side}.png"), bytes: png }
}

fn transform(stretch: [f64; 3], angle: f64, moved: [f64; 3]) -> [[f64; 4]; 4] {
    let turned = DMat4::from_rotation_x(angle) * DMat4::from_scale(DVec3::from(stretch));
    (DMat4::from_translation(DVec3::from(moved)) * turned).to_cols_array_2d()
}

/// Gives a mesh a layer of each kind that moves: joints, weights and a morph target.
fn moving(mesh: &mut Mesh) {
    let count = mesh.positions.len();
    let weights = mesh.positions.iter().map(|p| (0.5 + 0.3 * p[0].sin()) as f32);
    let layer = |kind, name: &str, width, values| Layer { kind, name: name.into(), width, values };
    let layers = [
        layer(LayerKind::Joints(0), "JOINTS_0", 4, [1.0, 2.0, 0.0, 0.0].repeat(count)),
        layer(
            LayerKind::Weights(0),
            "WEIGHTS_0",
            4,
            weights.flat_map(|w| [w, 1.0 - w, 0.0, 0.0]).collect(),
        ),
        layer(
            LayerKind::Other,
            "target 0 POSITION",
            3,
            mesh.positions.iter().flatten().map(|&x| (0.1 * x) as f32).collect(),
        ),
    ];
    mesh.attributes.as_mut().unwrap().layers.extend(layers);
}

/// Gives a mesh texture coordinates, without seams.
fn mapped(mut mesh: Mesh) -> Mesh {
    let values = mesh.positions.iter().flat_map(|p| [p[0] as f32, p[1] as f32]).collect();
    mesh.attributes = Some(Attributes {
        corners: mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect(),
        wedge_count: mesh.positions.len(),
        layers: vec![Layer { kind: LayerKind::Uv(0), name: "uv".into(), width: 2, values }],
    });
    mesh
}

/// A scene of three meshes: a torus with three primitives, two of one material; a sphere shown three
/// times, once mirrored and once within another node; and a knot that nothing moves.
pub(super) fn scene() -> Scene {
    let mut torus = mapped(samples::torus(400));
    let of_face = (0..torus.faces.len()).map(|face| (face * 3 / torus.faces.len()) as u32);
    let names = ["a", "b", "a"].map(String::from).to_vec();
    torus.materials = Some(Labels { names, of_face: of_face.collect() });
    let mut sphere = mapped(samples::sphere(300));
    moving(&mut sphere);
    let mesh = |name: &str, mesh, materials| SceneMesh { name: name.into(), mesh, materials };
    let node = |name: &str, transform, mesh, children| Node {
        name: name.into(),
        transform,
        mesh,
        children,
        ..Node::default()
    };
    let unmoved = DMat4::IDENTITY.to_cols_array_2d();
    let material = |name: &str, image, alpha| Material {
        name: name.into(),
        base_color: [0.5, 0.25, 1.0, alpha],
        base_color_image: image,
        is_double_sided: false,
        ..Material::default()
    };
    Scene {
        meshes: vec![
            mesh("torus", torus, vec![Some(1), None, Some(1)]),
            mesh("sphere", sphere, vec![Some(0)]),
            mesh("knot", samples::knot(300), vec![None]),
        ],
        nodes: vec![
            node("top", transform([1.0; 3], 0.4, [1.0, 0.0, 5.0]), Some(0), vec![1, 2]),
            node("small", transform([-0.5, 0.5, 0.5], 0.0, [2.0, 0.0, 0.0]), Some(1), vec![]),
            node("large", transform([2.0; 3], 1.0, [-3.0, 1.0, 0.0]), Some(1), vec![]),
            node("flat", transform([0.3, 1.9, 0.0], 0.0, [0.0, 6.0, 0.0]), Some(1), vec![]),
            node("plain", unmoved, Some(2), vec![]),
        ],
        roots: vec![0, 3, 4],
        materials: vec![material("red", Some(1), 1.0), material("glass", Some(0), 0.5)],
        images: vec![noise(64), noise(200)],
        ..Scene::default()
    }
}

/// Returns a scene as a glTF document.
fn as_gltf(scene: &Scene) -> Scene {
    let glb = gltf::write_glb(scene, &[]).unwrap();
    gltf::read(&glb, &mut |_| None, ReadOptions::default().weld).unwrap()
}

/// Returns a file of a glTF scene that keeps its vertices.
pub(super) fn lossless_file(scene: Scene) -> Vec<u8> {
    file(as_gltf(&scene), true)
}

/// Returns a file of a scene, in chunks of 40 updates.
fn file(scene: Scene, is_lossless: bool) -> Vec<u8> {
    let placed = place_scene(scene, &Constraints::default(), Options::default()).unwrap();
    let options = Forest::options(&placed.mesh, &placed.options);
    let record = if is_lossless { Forest::lossless } else { Forest::new };
    let mut forest = record(&placed.mesh, &options).unwrap();
    if !is_lossless {
        forest.measure_bounds();
    }
    let storage = Storage { updates_per_chunk: 40, ..Storage::default() };
    let archive = Archive::write(&forest, &storage).unwrap().0;
    let resources = placed.rest.unwrap().resources(&archive.chunk_lengths());
    archive.with_resources(&resources).unwrap().into_source()
}

fn extracted(bytes: &[u8], error: f64) -> Scene {
    let archive = Archive::open(bytes.to_vec()).unwrap();
    let level = archive.extract(&Query::uniform(error)).unwrap().level.mesh();
    ModelScene::read(&archive).unwrap().into_scene("level", level).unwrap()
}

/// Returns the corners of the faces of a mesh with their values, rounded, in a canonical order.
fn corners(mesh: &Mesh) -> Vec<[Vec<i64>; 3]> {
    let rounded = |x: f64| (x * 1e4).round() as i64;
    let corner = |face: usize, k: usize| {
        let mut values = mesh.positions[mesh.faces[face][k].index()].map(rounded).to_vec();
        if let Some(attributes) = &mesh.attributes {
            let mut layers: Vec<&Layer> = attributes.layers.iter().collect();
            layers.sort_by(|a, b| a.name.cmp(&b.name));
            let wedge = attributes.corners[face][k];
            let own = layers.iter().flat_map(|layer| layer.of(wedge));
            values.extend(own.map(|&x| rounded(x.into())));
        }
        values.extend(mesh.materials.iter().map(|labels| i64::from(labels.of(face))));
        values
    };
    let mut faces: Vec<_> = (0..mesh.faces.len())
        .map(|face| {
            let mut corners = [0, 1, 2].map(|k| corner(face, k));
            let least = (0..3).min_by_key(|&k| &corners[k]).unwrap();
            corners.rotate_left(least);
            corners
        })
        .collect();
    faces.sort_unstable();
    faces
}

#[test]
fn a_scene_comes_back() {
    for scene in [scene(), as_gltf(&scene())] {
        let back = extracted(&file(scene.clone(), true), 0.0);
        assert_eq!((&back.nodes, &back.roots), (&scene.nodes, &scene.roots));
        assert_eq!(back.materials, scene.materials);
        assert!(back.images == scene.images && back.source.is_some() == scene.source.is_some());
        assert_eq!(back.meshes.len(), 3);
        for (new, old) in back.meshes.iter().zip(&scene.meshes) {
            assert_eq!(new.name, old.name);
            assert_eq!(new.materials, old.materials, "{}", old.name);
            let mut old = old.mesh.clone();
            // A mesh with one label and one without labels are written alike.
            old.materials.get_or_insert_with(|| Labels {
                names: vec![String::new()],
                of_face: vec![0; new.mesh.faces.len()],
            });
            assert!(corners(&new.mesh) == corners(&old), "{}", new.name);
        }
        let again = as_gltf(&back);
        assert_eq!(again.flatten().faces.len(), scene.flatten().faces.len());
        assert_eq!(again.nodes, scene.nodes);
    }
}

#[test]
fn what_is_rounded_is_near_and_weights_are_whole() {
    let scene = as_gltf(&scene());
    let back = extracted(&file(scene.clone(), false), 0.0);
    let [old, new] = [&scene, &back].map(Scene::flatten);
    let far = distance(&old, &new, &DistanceOptions { samples: 2_000, seed: 1 }).unwrap().max();
    assert!(far < 2e-4 * old.bounds().diagonal(), "{far}");
    let attributes = back.meshes[1].mesh.attributes.as_ref().unwrap();
    let weights = attributes.layer(LayerKind::Weights(0)).unwrap();
    for four in weights.values.as_chunks::<4>().0 {
        assert!((four.iter().sum::<f32>() - 1.0).abs() < 1e-6, "{four:?}");
    }
}

#[test]
fn no_instance_is_further_off_than_the_error() {
    let scene = scene();
    let bytes = file(scene.clone(), false);
    for error in [0.1, 0.5] {
        let back = extracted(&bytes, error);
        let faces =
            |scene: &Scene| scene.meshes.iter().map(|mesh| mesh.mesh.faces.len()).sum::<usize>();
        assert!(faces(&back) < faces(&scene));
        for (k, instance) in scene.instances().into_iter().enumerate() {
            let only = |scene: &Scene| {
                let instance = scene.instances()[k];
                let mut mesh = scene.meshes[instance.mesh].mesh.clone();
                meshlod_io::transform(&mut mesh, &instance.transform);
                mesh
            };
            let [old, new] = [&scene, &back].map(only);
            let options = DistanceOptions { samples: 5_000, seed: 1 };
            let far = distance(&old, &new, &options).unwrap().max();
            assert!(far <= error, "{}: {far} of {error}", scene.nodes[instance.node].name);
        }
    }
}

#[test]
fn every_start_of_a_file_opens_with_what_it_has() {
    for scene in [scene(), as_gltf(&scene())] {
        let bytes = file(scene.clone(), false);
        let whole = Archive::open(bytes.clone()).unwrap();
        let base = whole.chunk_ends().next().unwrap() as usize;
        let (mut pixels, mut names, mut whole_images) = (0, 0, 0);
        for end in (base..bytes.len()).step_by(997).chain([bytes.len()]) {
            let archive = Archive::open(bytes[..end].to_vec()).unwrap();
            let level = archive.extract(&Query::uniform(0.0)).unwrap().level.mesh();
            let model = ModelScene::read(&archive).unwrap();
            let missing = model.missing;
            let back = model.into_scene("level", level).unwrap();
            assert!(gltf::write_glb(&back, &[]).is_ok(), "{end}");
            assert_eq!(back.nodes.len(), if missing.scene { 1 } else { 5 });
            let decoded = back
                .images
                .iter()
                .filter_map(|image| meshlod_picture::Texture::decode(&image.bytes).ok());
            let seen = decoded.map(|texture| texture.levels().next().unwrap().0).sum::<u32>();
            assert!(seen >= pixels, "{end}: images only grow");
            (pixels, names) = (seen, names + usize::from(!missing.scene));
            whole_images = 2 - missing.previews - missing.images;
        }
        assert!(pixels == 264 && names > 10 && whole_images == 2, "{pixels} {names}");
    }
}

#[test]
fn damaged_scenes_are_errors_or_scenes() {
    for scene in [scene(), as_gltf(&scene())] {
        let archive = Archive::open(file(scene, false)).unwrap();
        let level = archive.extract(&Query::uniform(0.1)).unwrap().level.mesh();
        let mut all: Vec<Resource> = (0..archive.resource_count())
            .map(|i| Resource { after_chunks: 0, bytes: archive.resource(i).unwrap().unwrap() })
            .collect();
        let head = all[0].bytes.clone();
        let (mut refused, mut read, mut state) = (0, 0, 7u64);
        let mut bytes = archive.into_source();
        for _ in 0..300 {
            all[0].bytes = head.clone();
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let at = (state >> 33) as usize % head.len();
            all[0].bytes[at] ^= 1 << (state >> 61);
            let archive = Archive::open(bytes).unwrap().with_resources(&all).unwrap();
            match ModelScene::read(&archive).map(|model| model.into_scene("", level.clone())) {
                Ok(Ok(scene)) => {
                    read += 1;
                    gltf::write_glb(&scene, &[]).ok();
                }
                Ok(Err(_)) | Err(_) => refused += 1,
            }
            bytes = archive.into_source();
        }
        assert!(refused > 20 && read > 20, "{refused} {read}");
        all.pop();
        all[0].bytes = head;
        let short = Archive::open(bytes).unwrap().with_resources(&all).unwrap();
        assert!(ModelScene::read(&short).is_err(), "a part is not there at all");
    }
}

#[test]
fn a_scene_comes_back_from_joined_resources() {
    for scene in [scene(), as_gltf(&scene())] {
        let placed = place_scene(scene.clone(), &Constraints::default(), Options::default());
        let PlacedScene { mesh, rest, .. } = placed.unwrap();
        let bytes = rest.unwrap().to_bytes().unwrap();
        let model = ModelScene::unpack(&bytes).unwrap();
        assert_eq!(model.missing, MissingParts::default());
        let back = model.into_scene("scene", mesh.clone()).unwrap();
        assert_eq!((&back.nodes, &back.roots), (&scene.nodes, &scene.roots));
        assert!(back.materials == scene.materials && back.images == scene.images);
        for (new, old) in back.meshes.iter().zip(&scene.meshes) {
            let places = |mesh: &Mesh| {
                let bare = Mesh::new(mesh.positions.clone(), mesh.faces.clone());
                corners(&bare)
            };
            assert!(places(&new.mesh) == places(&old.mesh), "{}", new.name);
        }
        let (mut refused, mut read, mut state) = (0, 0, 5u64);
        for _ in 0..300 {
            let mut damaged = bytes.clone();
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            damaged[(state >> 33) as usize % bytes.len().min(1000)] ^= 1 << (state >> 61);
            let model = ModelScene::unpack(&damaged);
            match model.and_then(|model| model.into_scene("", mesh.clone())) {
                Ok(scene) => {
                    read += 1;
                    gltf::write_glb(&scene, &[]).ok();
                }
                Err(_) => refused += 1,
            }
        }
        assert!(refused > 20 && read > 0, "{refused} {read}");
    }
}

#[test]
fn levels_of_another_scene_are_refused() {
    let archive = Archive::open(file(scene(), false)).unwrap();
    let model = ModelScene::read(&archive).unwrap();
    assert!(!model.is_flat() && !model.is_unmoved());
    assert!(model.clone().into_scene("", samples::torus(100)).is_err());
    let mut level = archive.extract(&Query::uniform(1.0)).unwrap().level.mesh();
    level.objects.as_mut().unwrap().names.push("more".into());
    assert!(model.into_scene("", level).is_err());
}

#[test]
fn a_bare_mesh_needs_no_scene() {
    let bare = Scene::from_mesh("torus", samples::torus(100));
    let placed = place_scene(bare.clone(), &Constraints::default(), Options::default()).unwrap();
    assert!(placed.rest.is_none() && placed.mesh == bare.flatten());
    let mut named = bare;
    named.nodes[0].name = "named".into();
    let placed = place_scene(named, &Constraints::default(), Options::default()).unwrap();
    assert!(placed.rest.is_some());
}
