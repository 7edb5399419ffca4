//! Cuts of scenes: materials, textures, colours and instances are drawn as the mesh's are, and
//! vertices that move draw what `multires` says.

mod common;

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use common::{difference, gpu};
use glam::{DMat4, DVec3};
use meshlod::io::{Image, Material, Node, SceneMesh};
use meshlod::mesh::Labels;
use meshlod::model::{SceneLayout, place_scene};
use meshlod::multires::{Archive, Focus, Forest, Geomorph, Implicit, Query, Storage, UpdateLimits};
use meshlod::picture::{Background, Camera, Normals, Paint, Picture, Style, View};
use meshlod::scene::OwnedPaint;
use meshlod::{Constraints, ReadOptions, Scene, samples};
use meshlod_view::stage::{Coloring, Display, Loaded, Subject};
use meshlod_view::{
    Canvas, CutFollower, CutModel, CutQuery, CutTolerance, FollowOptions, Gpu, GpuCut, Renderer,
    Shade, TargetFormat, Transition, render,
};

const SIZE: [u32; 2] = [320, 240];

/// Draws a subject of a stage, as the viewer does.
fn drawn(gpu: &Gpu, subject: &Subject, camera: &Camera, display: &Display) -> Picture {
    let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
    let canvas = Canvas::new(gpu, SIZE).unwrap();
    let placement = renderer.placement();
    placement.set(camera, SIZE, subject.origin(), &subject.display(display).shade());
    canvas.draw(|pass| subject.draw(&renderer, pass, &placement, display));
    canvas.read().unwrap()
}

fn save(name: &str, pictures: &[(&str, &Picture)]) {
    if let Some(folder) = std::env::var_os("MESHLOD_PICTURES") {
        for (which, picture) in pictures {
            let path = Path::new(&folder).join(format!("{name}-{which}.png"));
            std::fs::write(path, picture.png()).unwrap();
        }
    }
}

/// Returns a lossless file of the levels of a scene, as `meshlod build` writes it.
fn levels_of(scene: &Scene) -> Vec<u8> {
    let scene = scene.clone();
    let placed = place_scene(scene, &Constraints::default(), Default::default()).unwrap();
    let options = Forest::options(&placed.mesh, &placed.options);
    let forest = Forest::lossless(&placed.mesh, &options).unwrap();
    let archive = Archive::write(&forest, &Storage::default()).unwrap().0.into_source();
    let archive = Archive::open(archive).unwrap();
    let Some(rest) = placed.rest else { return archive.into_source() };
    let resources = rest.resources(&archive.chunk_lengths());
    archive.with_resources(&resources).unwrap().into_source()
}

/// Asserts that the finest cut of a scene's levels looks as the scene itself does.
fn assert_like_mesh(gpu: &Gpu, name: &str, scene: &Scene) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mlod");
    std::fs::write(&path, levels_of(scene)).unwrap();
    let loaded = Loaded::read(&path, &ReadOptions::default()).unwrap();
    let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
    let mut subject = Subject::new(&renderer, &loaded).unwrap();
    let Subject::Levels(levels) = &mut subject else { panic!("{name}: no levels") };
    let tolerance = CutTolerance::Uniform(0.0);
    levels.ask(CutQuery { focus: Focus::Everything, tolerance });
    levels.finish().unwrap();
    let view = View { aspect: 4.0 / 3.0, ..View::default() };
    let camera = Camera::fit_mesh(&loaded.mesh, &view);
    let single_sided = loaded.single_sided.to_vec();
    for display in [Display::default(), Display { coloring: Coloring::Clay, ..Display::default() }]
    {
        let own = display.coloring == Coloring::Own;
        let paint = if own { loaded.paint.as_paint() } else { OwnedPaint::CLAY.as_paint() };
        let style = Style {
            size: SIZE,
            paint,
            // Levels without normals of their own are smooth.
            normals: match loaded.normals {
                Normals::FromMesh => Normals::FromMesh,
                _ => Normals::Smooth,
            },
            background: Background::Transparent,
            single_sided: &single_sided,
            ..Style::default()
        };
        let expected = render(gpu, &loaded.mesh, &camera, &style).unwrap();
        let picture = drawn(gpu, &subject, &camera, &display);
        let (far, mean) = difference(&picture, &expected, 24);
        println!("{name}: {:.3} % far, mean {mean:.3} levels", 100.0 * far);
        save(
            &format!("{name}-{}", display.coloring.name()),
            &[("cut", &picture), ("mesh", &expected)],
        );
        assert!(far < 0.005 && mean < 0.5, "{name}: {far} {mean}");
        let covered = picture.rgba().chunks_exact(4).filter(|pixel| pixel[3] > 0).count();
        assert!(covered > 3_000, "{name}: {covered} pixels");
    }
    let wired = Display { wireframe: true, ..Display::default() };
    let plain = drawn(gpu, &subject, &camera, &Display::default());
    assert!(drawn(gpu, &subject, &camera, &wired) != plain, "{name}: no lines");
}

/// Returns an image of squares in two colours.
fn squares(a: [u8; 3], b: [u8; 3]) -> Image {
    let texels = (0..64 * 64).flat_map(|i| {
        let [r, g, b] = if (i / 8 + i / 64 / 8) % 2 == 0 { a } else { b };
        [r, g, b, 255]
    });
    let bytes = Picture::new(64, 64, texels.collect()).unwrap().png();
    Image { name: "squares".into(), bytes }
}

/// A fish of two textured materials, shown four times: turned, mirrored, small within another node,
/// and where it is; and a bare knot of another material.
fn scene() -> Scene {
    let mut fish = samples::fish(1_500);
    let faces = fish.faces.len();
    fish.materials = Some(Labels {
        names: vec!["front".into(), "back".into()],
        of_face: (0..faces)
            .map(|f| u32::from(fish.positions[fish.faces[f][0].index()][0] > 0.0))
            .collect(),
    });
    let mut knot = samples::knot(2_000);
    knot.attributes = None;
    let mesh = |name: &str, mesh, materials| SceneMesh { name: name.into(), mesh, materials };
    let node = |transform: DMat4, mesh, children| Node {
        transform: transform.to_cols_array_2d(),
        mesh: Some(mesh),
        children,
        ..Node::default()
    };
    let material = |color, image, is_double_sided| Material {
        base_color: color,
        base_color_image: image,
        is_double_sided,
        ..Material::default()
    };
    let at = |x: f64, y: f64| DMat4::from_translation(DVec3::new(x, y, 0.0));
    let mirror = DMat4::from_scale(DVec3::new(-0.6, 0.9, 0.6));
    Scene {
        meshes: vec![mesh("fish", fish, vec![Some(0), Some(1)]), mesh("knot", knot, vec![Some(2)])],
        nodes: vec![
            node(DMat4::IDENTITY, 0, vec![1]),
            node(at(0.0, 1.5) * DMat4::from_scale(DVec3::splat(0.5)), 0, vec![]),
            node(at(2.5, 0.0) * DMat4::from_rotation_z(1.0), 0, vec![]),
            node(at(-2.5, 0.5) * mirror, 0, vec![]),
            node(at(0.0, -2.5) * DMat4::from_scale(DVec3::splat(0.4)), 1, vec![]),
        ],
        roots: vec![0, 2, 3, 4],
        materials: vec![
            material([1.0; 4], Some(0), true),
            material([0.6, 1.0, 0.6, 1.0], Some(1), false),
            material([0.8, 0.3, 0.1, 1.0], None, true),
        ],
        images: vec![squares([250, 40, 40], [240, 220, 60]), squares([40, 60, 250], [230; 3])],
        ..Scene::default()
    }
}

#[test]
fn a_scene_of_materials_and_instances_looks_as_its_meshes_do() {
    let Some(gpu) = gpu() else { return };
    assert_like_mesh(gpu, "scene", &scene());
}

#[test]
fn seams_colours_and_a_single_material_look_as_their_meshes_do() {
    let Some(gpu) = gpu() else { return };
    let mut one = Scene::from_mesh("one", samples::fish(2_000));
    one.materials = vec![Material { base_color_image: Some(0), ..Material::default() }];
    one.meshes[0].materials = vec![Some(0)];
    one.images = vec![squares([200, 30, 90], [250; 3])];
    assert_like_mesh(gpu, "one", &one);
    assert_like_mesh(gpu, "bare", &Scene::from_mesh("bare", common::bumpy(2_000)));
}

#[test]
fn a_cut_of_many_materials_follows_by_partial_uploads() {
    let Some(gpu) = gpu() else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mlod");
    std::fs::write(&path, levels_of(&scene())).unwrap();
    let loaded = Loaded::read(&path, &ReadOptions::default()).unwrap();
    let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
    let [mut walked, mut fresh] = [(); 2].map(|()| Subject::new(&renderer, &loaded).unwrap());
    let camera = Camera::fit_mesh(&loaded.mesh, &View::default());
    let view =
        |pixels| CutTolerance::Pixels { camera: meshlod_view::view_camera(&camera, SIZE), pixels };
    let ask = |subject: &mut Subject, tolerance: CutTolerance| {
        let Subject::Levels(levels) = subject else { panic!("no levels") };
        let focus = match tolerance {
            CutTolerance::Pixels { camera, .. } => Focus::Frustum(camera),
            _ => Focus::Everything,
        };
        levels.take_uploaded();
        levels.ask(CutQuery { focus, tolerance });
        levels.finish().unwrap();
        levels.take_uploaded()
    };
    for tolerance in [
        CutTolerance::Uniform(0.0),
        CutTolerance::Uniform(0.05),
        view(1.0),
        CutTolerance::Faces(900),
    ] {
        ask(&mut walked, tolerance.clone());
    }
    let few = ask(&mut walked, view(1.05));
    let Subject::Levels(levels) = &walked else { panic!("no levels") };
    assert!(few < levels.cut().bytes() / 4, "{few} bytes");
    ask(&mut fresh, view(1.05));
    let display = Display::default();
    assert!(drawn(gpu, &walked, &camera, &display) == drawn(gpu, &fresh, &camera, &display));
    // Every place is seen within the pixels that were asked for: the picture is nearly the finest.
    let Subject::Levels(levels) = &fresh else { panic!("no levels") };
    let faces = levels.cut().faces();
    ask(&mut fresh, CutTolerance::Uniform(0.0));
    let Subject::Levels(levels) = &fresh else { panic!("no levels") };
    assert!(faces < levels.cut().faces(), "{faces}");
    let (far, _) = difference(
        &drawn(gpu, &walked, &camera, &display),
        &drawn(gpu, &fresh, &camera, &display),
        60,
    );
    assert!(far < 0.03, "{far}");
}

#[test]
fn vertices_that_move_are_drawn_where_multires_has_them() {
    let Some(gpu) = gpu() else { return };
    let mesh = samples::fish(3_000);
    let forest = Forest::lossless(&mesh, &Default::default()).unwrap();
    let mt = Implicit::new(&forest).unwrap();
    let motion = Duration::from_millis(100);
    let paint = Arc::new(OwnedPaint::Checker { squares: 12 });
    let model = CutModel::new(mt.into(), &SceneLayout::default()).unwrap();
    let model = Arc::new(model.with_paint(paint, Arc::default()));
    let meshlod::multires::Hierarchy::Contractions(levels) = model.levels() else {
        panic!("contractions")
    };
    let mut expected = Geomorph::new(levels, motion).unwrap();
    let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
    let mut cut = GpuCut::new(&renderer, &model).unwrap();
    let options = FollowOptions { changes: None, motion: Some(motion) };
    let mut follower = CutFollower::start(model.clone(), options);
    let camera = Camera::fit_mesh(&mesh, &View { aspect: 4.0 / 3.0, ..View::default() });
    let canvas = Canvas::new(gpu, SIZE).unwrap();
    let style = Style {
        size: SIZE,
        paint: Paint::Checker { squares: 12 },
        normals: Normals::FromMesh,
        background: Background::Transparent,
        ..Style::default()
    };
    let (mut pictures, mut between) = (Vec::new(), 0);
    for (step, error) in [0.1, 0.004, 0.03].into_iter().enumerate() {
        follower
            .ask(CutQuery { focus: Focus::Everything, tolerance: CutTolerance::Uniform(error) });
        expected.update(&Query::uniform(error), &UpdateLimits::default()).unwrap();
        for elapsed in [0, 30, 40, 50].map(Duration::from_millis) {
            if elapsed > Duration::ZERO {
                follower.advance(elapsed);
                expected.advance(elapsed);
            }
            while let Some(step) = follower.wait() {
                cut.apply(&step.unwrap(), Transition::Dithered);
                cut.finish_fade();
            }
            let placement = renderer.placement();
            placement.set(&camera, SIZE, cut.origin(), &Shade::default());
            canvas.draw(|pass| cut.draw(&renderer, pass, &placement));
            let picture = canvas.read().unwrap();
            let mesh = render(gpu, &expected.mesh(), &camera, &style).unwrap();
            save(
                &format!("moving-{step}-{}", elapsed.as_millis()),
                &[("cut", &picture), ("mesh", &mesh)],
            );
            let (far, mean) = difference(&picture, &mesh, 24);
            assert!(far < 0.005 && mean < 0.5, "{step} {elapsed:?}: {far} {mean}");
            between += usize::from(pictures.last().is_some_and(|last| *last != picture));
            pictures.push(picture);
        }
    }
    assert!(between >= 8, "{between} pictures differ from the one before");
}

#[test]
fn motion_can_be_switched_on_and_off() {
    let Some(gpu) = gpu() else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mlod");
    std::fs::write(&path, levels_of(&scene())).unwrap();
    let loaded = Loaded::read(&path, &ReadOptions::default()).unwrap();
    let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
    let mut subject = Subject::new(&renderer, &loaded).unwrap();
    let camera = Camera::fit_mesh(&loaded.mesh, &View::default());
    let display = Display::default();
    let mut pictures = Vec::new();
    for motion in [None, Some(Duration::from_millis(80)), None] {
        let Subject::Levels(levels) = &mut subject else { panic!("no levels") };
        levels.set_motion(motion);
        for error in [0.05, 0.0, 0.02] {
            let tolerance = CutTolerance::Uniform(error);
            levels.ask(CutQuery { focus: Focus::Everything, tolerance });
            // As frames do, and on to the end of the motion.
            while levels.is_changing() {
                levels.poll(0.03).unwrap();
                std::thread::yield_now();
            }
        }
        levels.set_motion(None);
        levels.finish().unwrap();
        pictures.push(drawn(gpu, &subject, &camera, &display));
    }
    assert!(pictures[0] == pictures[1] && pictures[1] == pictures[2]);
}
