//! Pictures of the GPU against those of `picture`, which are the same on every machine.

mod common;

use common::{difference, gpu};
use meshlod::Mesh;
use meshlod::picture::{
    BackFaces, Background, Camera, ColorMap, Lighting, Materials, Normals, Paint, PaintMaterial,
    Style, Texture, Values, View, Wireframe, render,
};
use meshlod::samples;

/// Asserts that the GPU draws a mesh as `picture` does: pixels at edges may differ, since their
/// samples do, but not surfaces.
fn assert_like_picture(name: &str, mesh: &Mesh, style: &Style<'_>) {
    let Some(gpu) = gpu() else { return };
    let style = Style { size: [320, 240], ..style.clone() };
    let view = View { aspect: 4.0 / 3.0, ..View::default() };
    let camera = Camera::fit_mesh(mesh, &view);
    let drawn = meshlod_view::render(gpu, mesh, &camera, &style).unwrap();
    let expected = render(mesh, &camera, &style).unwrap();
    let (far, mean) = difference(&drawn, &expected, 24);
    if let Some(folder) = std::env::var_os("MESHLOD_PICTURES") {
        let folder = std::path::PathBuf::from(folder);
        std::fs::write(folder.join(format!("{name}-gpu.png")), drawn.png()).unwrap();
        std::fs::write(folder.join(format!("{name}-cpu.png")), expected.png()).unwrap();
    }
    println!("{name}: {:.3} % far, mean {mean:.3} levels", 100.0 * far);
    assert!(far < 0.015 && mean < 2.0, "{name}: {far} {mean}");
}

#[test]
fn every_lighting_is_the_same() {
    let knot = samples::knot(8_000);
    for lighting in [Lighting::Studio, Lighting::Headlight, Lighting::Soft, Lighting::Unlit] {
        let style = Style { lighting, ..Style::default() };
        assert_like_picture(&format!("{lighting:?}"), &knot, &style);
    }
}

#[test]
fn flat_creased_and_smooth_normals_are_the_same() {
    let gyroid = samples::gyroid(3_000);
    let all = [Normals::Flat, Normals::Smooth, Normals::Creased { crease_rad: 0.5 }];
    for (name, normals) in ["flat", "smooth", "creased"].into_iter().zip(all) {
        assert_like_picture(name, &gyroid, &Style { normals, ..Style::default() });
    }
}

#[test]
fn materials_and_textures_are_the_same() {
    let mut fish = samples::fish(4_000);
    let checker = Style { paint: Paint::Checker { squares: 16 }, ..Style::default() };
    assert_like_picture("checker", &fish, &checker);
    let faces = fish.faces.len();
    fish.materials = Some(meshlod::mesh::Labels {
        names: vec!["red".into(), "textured".into()],
        of_face: (0..faces).map(|face| (face % 2) as u32).collect(),
    });
    let red = PaintMaterial { base_color: [0.8, 0.1, 0.1], texture: None };
    let textured = PaintMaterial { base_color: [1.0; 3], texture: Some(0) };
    let materials =
        Materials { materials: vec![red, textured], textures: vec![Texture::checker(8)] };
    let style = Style { paint: Paint::Materials(&materials), ..Style::default() };
    assert_like_picture("materials", &fish, &style);
}

#[test]
fn values_are_shown_by_the_same_colours() {
    let ball = samples::sphere(2_000);
    let vertices: Vec<f32> = ball.positions.iter().map(|p| p[1] as f32).collect();
    let faces: Vec<f32> = (0..ball.faces.len()).map(|face| (face % 10) as f32).collect();
    let map = ColorMap::Heat;
    let values = Values { values: &vertices, map, range: [-1.0, 1.0] };
    assert_like_picture(
        "heat",
        &ball,
        &Style { paint: Paint::VertexValues(values), lighting: Lighting::Soft, ..Style::default() },
    );
    let values = Values { values: &faces, map, range: [0.0, 9.0] };
    let paint = Paint::FaceValues(values);
    assert_like_picture(
        "faces",
        &ball,
        &Style { paint, normals: Normals::Flat, ..Style::default() },
    );
}

#[test]
fn wireframes_are_the_same() {
    for faces in [200, 3_000] {
        let ball = samples::sphere(faces);
        let wireframe = Some(Wireframe::default());
        let style = Style { wireframe, normals: Normals::Flat, ..Style::default() };
        assert_like_picture(&format!("wire-{faces}"), &ball, &style);
    }
}

/// The lower half of a ball, whose inner side is seen too.
fn bowl() -> Mesh {
    let mut bowl = samples::sphere(2_000);
    let height = |face: &[meshlod::mesh::VertexId; 3]| bowl.positions[face[0].index()][1];
    let kept: Vec<_> = bowl.faces.iter().copied().filter(|face| height(face) < 0.0).collect();
    bowl.faces = kept;
    bowl.attributes = None;
    bowl
}

#[test]
fn single_sided_faces_from_behind_are_not_drawn() {
    let mut bowl = bowl();
    let left = |face: &[meshlod::mesh::VertexId; 3]| bowl.positions[face[0].index()][0] < 0.0;
    let of_face = bowl.faces.iter().map(|face| u32::from(left(face))).collect();
    let names = vec!["right".into(), "left".into()];
    bowl.materials = Some(meshlod::mesh::Labels { names, of_face });
    let red = PaintMaterial { base_color: [0.8, 0.1, 0.1], texture: None };
    let materials = Materials { materials: vec![red; 2], textures: Vec::new() };
    for (name, paint, wireframe) in [
        ("sides", Paint::Materials(&materials), None),
        ("sides-plain", Paint::default(), None),
        ("sides-lines", Paint::default(), Some(Wireframe::default())),
    ] {
        let style = Style { paint, wireframe, normals: Normals::Flat, ..Style::default() };
        assert_like_picture(name, &bowl, &Style { single_sided: &[false, true], ..style });
    }
}

#[test]
fn faces_from_behind_are_tinted() {
    let bowl = bowl();
    let style = Style {
        back_faces: BackFaces::RED,
        background: Background::Plain([128; 3]),
        ..Style::default()
    };
    assert_like_picture("bowl", &bowl, &style);
}

#[test]
fn coordinates_in_the_millions_lose_nothing() {
    let mut knot = samples::knot(8_000);
    knot.attributes = None;
    for position in &mut knot.positions {
        *position = [position[0] + 4.5e6, position[1] - 3.2e6, position[2] + 1e6];
    }
    assert_like_picture("far", &knot, &Style::default());
}

#[test]
fn strips_draw_the_faces_that_they_came_from() {
    use meshlod::strip::{StripOptions, stripify};
    use meshlod_view::{Canvas, GpuStrips, Renderer, Shade, TargetFormat};
    let Some(gpu) = gpu() else { return };
    let mut knot = samples::knot(8_000);
    knot.attributes = None;
    let strips = stripify(&knot.faces, &StripOptions::default());
    let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
    let drawn = GpuStrips::new(&renderer, &knot, &strips).unwrap();
    assert!(drawn.entries() < 2 * knot.faces.len());
    let style = Style { size: [320, 240], ..Style::default() };
    let camera = Camera::fit_mesh(&knot, &View { aspect: 4.0 / 3.0, ..View::default() });
    let canvas = Canvas::new(gpu, style.size).unwrap();
    let placement = renderer.placement();
    placement.set(&camera, style.size, drawn.origin(), &Shade::default());
    let backdrop = renderer.backdrop(style.background).unwrap();
    canvas.draw(|pass| {
        drawn.draw(&renderer, pass, &placement);
        renderer.draw_backdrop(pass, &backdrop);
    });
    let (far, mean) =
        difference(&canvas.read().unwrap(), &render(&knot, &camera, &style).unwrap(), 24);
    assert!(far < 0.015 && mean < 2.0, "{far} {mean}");
}

#[test]
fn a_shadow_lies_under_the_thing_and_fades_outwards() {
    use meshlod::mesh::Bounds;
    use meshlod::picture::UpAxis;
    use meshlod_view::{Canvas, GpuMesh, Ground, Renderer, Shade, TargetFormat};
    let Some(gpu) = gpu() else { return };
    let knot = samples::knot(8_000);
    let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
    let drawn = GpuMesh::new(&renderer, &knot, &Paint::default(), Normals::Smooth).unwrap();
    let bounds = Bounds::of(&knot.positions);
    let ground = Ground::new(&renderer, &bounds, UpAxis::Y, drawn.origin(), |pass, placement| {
        drawn.draw(&renderer, pass, placement);
    })
    .unwrap();
    let size = [480, 360];
    let camera = Camera::fit_mesh(&knot, &View { aspect: 4.0 / 3.0, fill: 0.6, ..View::default() });
    let canvas = Canvas::new(gpu, size).unwrap();
    let placement = renderer.placement();
    placement.set(&camera, size, drawn.origin(), &Shade::default());
    let backdrop = renderer.backdrop(Background::default()).unwrap();
    let picture = |is_shown: bool| {
        canvas.draw(|pass| {
            drawn.draw(&renderer, pass, &placement);
            renderer.draw_backdrop(pass, &backdrop);
            if is_shown {
                ground.draw(&renderer, pass, &camera, size);
            }
        });
        canvas.read().unwrap()
    };
    let [with, without] = [true, false].map(picture);
    if let Some(folder) = std::env::var_os("MESHLOD_PICTURES") {
        std::fs::write(std::path::PathBuf::from(folder).join("ground.png"), with.png()).unwrap();
    }
    let darker = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
    let darker: Vec<_> = darker
        .filter(|&(x, y)| with.pixel(x, y)[1].saturating_add(8) < without.pixel(x, y)[1])
        .collect();
    assert!(darker.len() > 2_000, "{}", darker.len());
    assert!(darker.iter().all(|&(x, y)| y > 80 && x > 3 && x < 476), "not at the rims");
}

#[test]
fn a_mesh_that_is_one_point_is_drawn_and_casts_a_shadow() {
    use meshlod::picture::UpAxis;
    use meshlod_view::stage::{Loaded, Stage, Subject};
    use meshlod_view::{Canvas, Renderer, TargetFormat};
    let Some(gpu) = gpu() else { return };
    let mut ball = samples::sphere(20);
    ball.attributes = None;
    ball.positions.iter_mut().for_each(|p| *p = [1.0, 2.0, 3.0]);
    let clay = std::sync::Arc::new(meshlod::scene::OwnedPaint::CLAY);
    let loaded = Loaded::from_mesh("point", ball, clay);
    let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
    let mut stage = Stage::default();
    let id = stage.add(Subject::new(&renderer, &loaded).unwrap());
    stage.show(&[id]);
    stage.rig.set_up(UpAxis::Z);
    stage.rig.frame(&loaded.bounds, 1.0);
    stage.prepare(&renderer).unwrap();
    let canvas = Canvas::new(gpu, [32, 32]).unwrap();
    canvas.draw(|pass| stage.draw(&renderer, pass, [32, 32]));
    assert!(canvas.read().unwrap().rgba().iter().skip(3).step_by(4).all(|&alpha| alpha == 255));
}
