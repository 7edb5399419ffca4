//! The stage: files of every kind are read, uploaded and shown, without a window.

mod common;

use std::path::Path;
use std::sync::Arc;

use meshlod::jobs::{BuildRequest, CompressRequest, Packing, build, compress};
use meshlod::mesh::{Bounds, Labels};
use meshlod::multires::{Focus, HeightField, HeightPrecision, Hierarchy};
use meshlod::scene::OwnedPaint;
use meshlod::{FileKind, ReadOptions, Scene, WriteOptions, samples, write};
use meshlod_view::stage::{Coloring, Display, Loaded, LoadedContent, Stage, Subject, SubjectId};
use meshlod_view::{Canvas, CutQuery, CutTolerance, Gpu, Renderer, TargetFormat};

fn read(path: &Path) -> Loaded {
    Loaded::read(path, &ReadOptions::default()).unwrap()
}

/// Draws a stage and returns the share of pixels that differ from an empty one, by halves.
fn covered(gpu: &Gpu, renderer: &Renderer, stage: &mut Stage) -> [f64; 2] {
    let size = [200, 100];
    let shot = |stage: &mut Stage| {
        let canvas = Canvas::new(gpu, size).unwrap();
        canvas.draw(|pass| stage.draw(renderer, pass, size));
        canvas.read().unwrap()
    };
    let mut empty = Stage::default();
    empty.display = stage.display;
    let (drawn, bare) = (shot(stage), shot(&mut empty));
    [0, 1].map(|half| {
        let pixels = (0..100 * 100).map(|i| (i / 100) * 200 + i % 100 + half * 100);
        let differs = |i: &usize| drawn.rgba()[4 * i..4 * i + 4] != bare.rgba()[4 * i..4 * i + 4];
        pixels.filter(differs).count() as f64 / 1e4
    })
}

fn show(renderer: &Renderer, stage: &mut Stage, loaded: &Loaded) -> SubjectId {
    let id = stage.add(Subject::new(renderer, loaded).unwrap());
    stage.show(&[id]);
    stage.rig.frame(&loaded.bounds, stage.aspect([200, 100]));
    id
}

#[test]
fn files_of_every_kind_are_shown() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let knot = samples::knot(2_000);
    let scene = Scene::from_mesh("knot", knot.clone());
    write(path("a.ply"), &scene, &WriteOptions::default()).unwrap();
    let (levels, _) = build(scene.clone(), &BuildRequest::default(), &()).unwrap();
    std::fs::write(path("b.mlod"), levels).unwrap();
    for (name, kind) in [("c.mlq", FileKind::Resident), ("d.mlz", FileKind::Sent)] {
        let packing = Packing::of(kind).unwrap();
        let request = CompressRequest { packing, ..CompressRequest::default() };
        let (bytes, _) = compress(scene.clone(), &request, &()).unwrap();
        std::fs::write(path(name), bytes).unwrap();
    }
    let loaded: Vec<_> = ["a.ply", "b.mlod", "c.mlq", "d.mlz"].map(|name| read(&path(name))).into();
    for loaded in &loaded {
        assert_eq!(loaded.mesh.faces.len(), knot.faces.len(), "{}", loaded.name());
        assert!(loaded.file_bytes > 0);
    }

    let Some(gpu) = common::gpu() else { return };
    let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
    let mut stage = Stage::default();
    for loaded in &loaded {
        show(&renderer, &mut stage, loaded);
        let [left, right] = covered(gpu, &renderer, &mut stage);
        assert!(left > 0.1 && right > 0.1, "{}: {left} {right}", loaded.name());
    }
}

#[test]
fn a_height_field_is_shown_by_levels() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("terrain.mlod");
    let terrain = samples::terrain(2_000);
    let field = HeightField::from_mesh(&terrain).unwrap();
    std::fs::write(&path, field.to_file(HeightPrecision::Exact).unwrap().0).unwrap();
    let loaded = read(&path);
    assert!(loaded.mesh.faces.len() <= terrain.faces.len());
    let LoadedContent::Levels(levels) = &loaded.content else { panic!("{loaded:?}") };
    assert!(matches!(levels.levels(), Hierarchy::RightTriangles(_)));
    let Some(gpu) = common::gpu() else { return };
    let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
    let mut stage = Stage::default();
    let id = show(&renderer, &mut stage, &loaded);
    assert!(covered(gpu, &renderer, &mut stage)[0] > 0.1);
    let Some(Subject::Levels(subject)) = stage.subject_mut(id) else { unreachable!() };
    let finest = subject.cut().faces();
    subject.ask(CutQuery { focus: Focus::Everything, tolerance: CutTolerance::Faces(500) });
    subject.finish().unwrap();
    assert!(subject.cut().faces() <= 500 && finest > 500);
    assert!(covered(gpu, &renderer, &mut stage)[0] > 0.1);
}

#[test]
fn what_cannot_be_read_is_one_line_with_the_name_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.ply", "b.mlod", "c.mlq", "d.mlz", "e.xyz"] {
        let path = folder.path().join(name);
        std::fs::write(&path, b"something else entirely, and long enough").unwrap();
        let line = Loaded::read(&path, &ReadOptions::default()).unwrap_err().to_string();
        assert!(line.contains(name) && !line.contains('\n'), "{line}");
    }
}

#[test]
fn two_slots_show_their_subjects_side_by_side() {
    let Some(gpu) = common::gpu() else { return };
    let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
    let mut stage = Stage::default();
    let paint = Arc::new(OwnedPaint::CLAY);
    let sphere = Loaded::from_mesh("sphere", samples::sphere(500), Arc::clone(&paint));
    let id = show(&renderer, &mut stage, &sphere);
    stage.show(&[id, id]);
    stage.rig.frame(&stage.bounds(), stage.aspect([200, 100]));
    let [left, right] = covered(gpu, &renderer, &mut stage);
    assert!(left > 0.2 && (left - right).abs() < 0.02, "{left} {right}");

    stage.remove(id);
    assert_eq!((stage.shown().count(), stage.bounds()), (0, Bounds::EMPTY));
    assert_eq!(covered(gpu, &renderer, &mut stage), [0.0; 2]);
}

#[test]
fn faces_are_coloured_by_object_in_the_order_of_the_mesh() {
    let Some(gpu) = common::gpu() else { return };
    let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
    let mut mesh = samples::sphere(500);
    let of_face = (0..mesh.faces.len() as u32).map(|face| face % 2).collect();
    mesh.objects = Some(Labels { names: vec!["a".into(), "b".into()], of_face });
    let loaded = Loaded::from_mesh("sphere", mesh, Arc::new(OwnedPaint::CLAY));
    let mut stage = Stage::default();
    let id = show(&renderer, &mut stage, &loaded);
    stage.display = Display { coloring: Coloring::Objects, ..Display::default() };
    assert!(!stage.subject(id).unwrap().has(Coloring::Objects), "before its colours are there");
    let Some(Subject::Mesh(subject)) = stage.subject_mut(id) else { unreachable!() };
    subject.color_faces(&renderer, &loaded.mesh, Coloring::Objects).unwrap();
    assert!(stage.subject(id).unwrap().has(Coloring::Objects));
    assert!(covered(gpu, &renderer, &mut stage)[0] > 0.1);
}
