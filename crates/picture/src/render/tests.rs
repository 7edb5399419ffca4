use meshlod_mesh::Labels;

use super::*;
use crate::scenes::{ball, from_front, roof, sheet, sheet_with_uv, stack};
use crate::{
    Antialiasing, ColorMap, Lighting, Materials, Normals, Paint, PaintMaterial, Texture, Values,
    View, Wireframe,
};

/// Unlit style with one sample per pixel, on black.
fn bare(side: u32) -> Style<'static> {
    Style {
        size: [side, side],
        lighting: Lighting::Unlit,
        background: Background::Plain([0; 3]),
        antialiasing: Antialiasing::Off,
        ..Style::default()
    }
}

/// The default paint.
const PLAIN: [u8; 3] = [226, 208, 186];

fn rgb(picture: &Picture, x: u32, y: u32) -> [u8; 3] {
    let [r, g, b, _] = picture.pixel(x, y);
    [r, g, b]
}

/// FNV-1a.
fn hash(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// Styles that cover smooth and flat shading, textures, wireframe and transparency.
fn everything() -> Vec<Picture> {
    let (ball, mut bent) = (ball(2), sheet_with_uv(9));
    bent.positions.iter_mut().for_each(|p| p[2] = 0.4 * p[0] * p[0] - 0.3 * p[1]);
    let heights: Vec<f32> = ball.positions.iter().map(|p| p[1] as f32).collect();
    let values = Values { values: &heights, map: ColorMap::Sequential, range: [-0.5, 0.5] };
    let small = Style { size: [150, 100], ..Style::default() };
    let styles = [
        Style { normals: Normals::Creased { crease_rad: 0.6 }, ..small.clone() },
        Style { paint: Paint::VertexValues(values), background: Background::Transparent, ..small },
    ];
    let checker = Style {
        paint: Paint::Checker { squares: 8 },
        wireframe: Some(Wireframe::default()),
        size: [100, 130],
        normals: Normals::Flat,
        ..Style::comparison()
    };
    let view = View { fov_rad: 0.5, aspect: 1.5, ..View::default() };
    let mut pictures: Vec<_> =
        styles.iter().map(|s| render(&ball, &Camera::fit_mesh(&ball, &view), s).unwrap()).collect();
    pictures.push(render(&bent, &Camera::icosahedron_views(&bent)[4], &checker).unwrap());
    pictures
}

#[test]
fn pixels_are_the_same_everywhere() {
    let with_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(everything)
    };
    let one = with_threads(1);
    assert!(one == with_threads(2) && one == with_threads(5), "threads leave a trace");
    // Update these hashes only when a picture is meant to change, and look at it first.
    let hashes: Vec<_> = one.iter().map(|p| format!("{:016x}", hash(p.rgba()))).collect();
    assert_eq!(hashes, ["02861914000fa511", "9ab5cb4f606ba87f", "be24cebba9cb8013"]);
}

#[test]
fn each_face_has_its_colour_and_the_nearer_one_hides_the_other() {
    let colors = [[200, 10, 10], [10, 10, 200]];
    let style = Style { paint: Paint::FaceColors(&colors), ..bare(9) };
    for (heights, seen) in [([0.0, 0.5], colors[1]), ([0.5, 0.0], colors[0])] {
        let picture = render(&stack(&heights), &from_front(3.0), &style).unwrap();
        assert_eq!(rgb(&picture, 4, 4), seen);
        assert_eq!(rgb(&picture, 0, 0), [0; 3]);
    }
}

#[test]
fn a_texture_is_seen_upright() {
    let texels = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255; 4]].concat();
    let texture = Texture::new(2, 2, &texels).unwrap();
    let material = PaintMaterial { base_color: [1.0; 3], texture: Some(0) };
    let materials = Materials { materials: vec![material], textures: vec![texture] };
    let style = Style { paint: Paint::Materials(&materials), ..bare(100) };
    // The sheet spans ±1 and the view ±1.04 at this distance.
    let picture = render(&sheet_with_uv(3), &from_front(2.5), &style).unwrap();
    let quarters = [(26, 26), (74, 26), (26, 74), (74, 74)].map(|(x, y)| rgb(&picture, x, y));
    let expected: [[i32; 3]; 4] = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [255; 3]];
    for (seen, wanted) in quarters.iter().zip(expected) {
        for (seen, wanted) in seen.iter().zip(wanted) {
            // A hundredth of the neighbour in linear light is 25 of 255 in sRGB.
            assert!((i32::from(*seen) - wanted).abs() < 40, "{quarters:?}");
        }
    }
}

#[test]
fn texture_coordinates_are_right_in_perspective() {
    // Leaning far back: the middle of the sheet is seen well below the middle of its picture's
    // extent, and there u and v are one half.
    let mut mesh = sheet_with_uv(1);
    mesh.positions.iter_mut().for_each(|p| (p[1], p[2]) = (p[1] * 0.3, -p[1] * 1.5));
    let rgba: Vec<u8> =
        (0..256u32 * 256).flat_map(|i| [0, (255 - i / 256) as u8, 0, 255]).collect();
    let texture = Texture::new(256, 256, &rgba).unwrap();
    let material = PaintMaterial { base_color: [1.0; 3], texture: Some(0) };
    let materials = Materials { materials: vec![material], textures: vec![texture] };
    let style = Style { paint: Paint::Materials(&materials), ..bare(201) };
    let picture = render(&mesh, &from_front(3.0), &style).unwrap();
    let level = i32::from(rgb(&picture, 100, 100)[1]);
    assert!((level - 128).abs() <= 2, "v is one half at the centre: {level}");
}

#[test]
fn materials_go_by_label() {
    let mut mesh = sheet(1);
    mesh.materials = Some(Labels { names: vec!["a".into(), "b".into()], of_face: vec![1, 0] });
    let plain = |base_color| PaintMaterial { base_color, texture: None };
    let materials = vec![plain([1.0, 0.0, 0.0]), plain([0.0, 0.0, 1.0])];
    let materials = Materials { materials, textures: Vec::new() };
    let picture =
        render(&mesh, &from_front(2.5), &Style { paint: Paint::Materials(&materials), ..bare(50) })
            .unwrap();
    assert_eq!([rgb(&picture, 35, 38), rgb(&picture, 12, 15)], [[0, 0, 255], [255, 0, 0]]);
}

#[test]
fn values_are_blended_over_faces() {
    let mesh = sheet(1);
    let values: Vec<f32> = mesh.positions.iter().map(|p| p[0] as f32).collect();
    let values = Values { values: &values, map: ColorMap::Diverging, range: [-1.0, 1.0] };
    let style = Style { paint: Paint::VertexValues(values), ..bare(101) };
    let picture = render(&mesh, &from_front(2.5), &style).unwrap();
    let [left, middle, right] = [4, 50, 96].map(|x| rgb(&picture, x, 50));
    assert!(left[2] > left[0] + 50 && right[0] > right[2] + 50, "{left:?} {right:?}");
    assert!(middle.iter().all(|&level| level > 220), "{middle:?}");
}

#[test]
fn inner_sides_take_the_tint() {
    let behind = Camera::look_at([0.0, 0.0, -3.0], [0.0; 3], [0.0, 1.0, 0.0], 0.8);
    let tinted = Style { back_faces: BackFaces::Tint([9, 8, 7]), ..bare(9) };
    for (camera, color) in [(behind, [9, 8, 7]), (from_front(3.0), PLAIN)] {
        assert_eq!(rgb(&render(&roof(), &camera, &bare(9)).unwrap(), 0, 0), [0; 3]);
        assert_eq!(rgb(&render(&stack(&[0.0]), &camera, &tinted).unwrap(), 4, 4), color);
    }
}

#[test]
fn single_sided_materials_are_seen_from_the_front_only() {
    let mut mesh = stack(&[0.0]);
    mesh.materials = Some(Labels { names: vec!["a".into()], of_face: vec![0; mesh.faces.len()] });
    let unlabelled = Mesh { materials: None, ..mesh.clone() };
    let behind = Camera::look_at([0.0, 0.0, -3.0], [0.0; 3], [0.0, 1.0, 0.0], 0.8);
    let seen = |mesh: &Mesh, camera, single_sided: &[bool]| {
        rgb(&render(mesh, &camera, &Style { single_sided, ..bare(9) }).unwrap(), 4, 4)
    };
    assert_eq!(seen(&mesh, from_front(3.0), &[true]), PLAIN);
    assert_eq!(seen(&mesh, behind, &[true]), [0; 3]);
    for both_sides in [&[false][..], &[false, true], &[]] {
        assert_eq!(seen(&mesh, behind, both_sides), PLAIN, "{both_sides:?}");
    }
    assert_eq!(seen(&unlabelled, behind, &[true]), PLAIN, "no label, no material");
    let back_faces = BackFaces::Tint([9, 8, 7]);
    let tinted = Style { single_sided: &[true], back_faces, ..bare(9) };
    assert_eq!(rgb(&render(&mesh, &behind, &tinted).unwrap(), 4, 4), [9, 8, 7]);
}

#[test]
fn faces_through_the_eye_are_culled_by_their_side_too() {
    // A floor below the eye, much of it behind the eye: every face is clipped.
    let mut floor = sheet(1);
    floor.positions.iter_mut().for_each(|p| *p = [9.0 * p[0], -1.0, -9.0 * p[1]]);
    let labels = Labels { names: vec!["a".into()], of_face: vec![0; floor.faces.len()] };
    floor.materials = Some(labels);
    let mut ceiling = floor.clone();
    ceiling.positions.iter_mut().for_each(|p| p[1] = 1.0);
    let camera = Camera::look_at([0.0; 3], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0], 1.2);
    let style = Style { single_sided: &[true], ..bare(40) };
    let covered = |mesh: &Mesh, style: &Style| {
        let picture = render(mesh, &camera, style).unwrap();
        picture.rgba().chunks_exact(4).filter(|p| p[..3] != [0; 3]).count()
    };
    assert!(covered(&floor, &style) > 300);
    assert_eq!(covered(&floor, &style), covered(&floor, &bare(40)));
    assert!(covered(&ceiling, &bare(40)) > 300);
    assert_eq!(covered(&ceiling, &style), 0, "its upper side faces away");
}

#[test]
fn the_front_half_of_a_ball_hides_all_of_it() {
    let mut ball = ball(4);
    let labels = Labels { names: vec!["a".into()], of_face: vec![0; ball.faces.len()] };
    ball.materials = Some(labels);
    let camera = Camera::fit_mesh(&ball, &View::default());
    let draw = |single_sided: &[bool]| {
        render(&ball, &camera, &Style { single_sided, ..bare(200) }).unwrap()
    };
    assert!(draw(&[]) == draw(&[true]), "culling opens no crack");
}

#[test]
fn light_falls_off_with_the_angle_and_is_the_same_on_both_sides() {
    let style = Style::comparison();
    let level = |camera: Camera| {
        let picture = render(&sheet(1), &camera, &Style { size: [9, 9], ..style.clone() }).unwrap();
        rgb(&picture, 4, 4)[1]
    };
    let from = |x, z| Camera::look_at([x, 0.0, z], [0.0; 3], [0.0, 1.0, 0.0], 0.8);
    let [straight, slant, behind] = [from(0.0, 3.0), from(3.0, 3.0), from(0.0, -3.0)].map(level);
    assert!(straight > slant + 20, "{straight} {slant}");
    assert_eq!(straight, behind);
}

#[test]
fn more_samples_smooth_the_outline() {
    let levels = |antialiasing| {
        let style = Style { antialiasing, paint: Paint::Plain([255; 3]), ..bare(60) };
        let picture = render(&stack(&[0.0]), &from_front(3.0), &style).unwrap();
        let mut levels: Vec<u8> = picture.rgba().iter().step_by(4).copied().collect();
        levels.sort_unstable();
        levels.dedup();
        levels.len()
    };
    assert_eq!(levels(Antialiasing::Off), 2);
    assert!(levels(Antialiasing::Four) > 2);
    assert!(levels(Antialiasing::Sixteen) > levels(Antialiasing::Nine));
}

#[test]
fn what_is_seen_through_is_told_by_alpha() {
    let style =
        Style { background: Background::Transparent, paint: Paint::Plain([255; 3]), ..bare(60) };
    let style = Style { antialiasing: Antialiasing::Sixteen, ..style };
    let picture = render(&stack(&[0.0]), &from_front(3.0), &style).unwrap();
    assert_eq!((picture.pixel(0, 0), picture.pixel(30, 30)), ([0; 4], [255; 4]));
    let edges = picture.rgba().chunks_exact(4).filter(|p| p[3] > 0 && p[3] < 255);
    assert!(edges.map(|p| p[0]).all(|level| level == 255), "the edge keeps the surface's colour");
}

#[test]
fn lines_lie_on_edges_and_fade_on_dense_meshes() {
    let lined = |n, side| {
        let wireframe = Wireframe { color: [255, 0, 0], width_px: 2.0, opacity: 1.0 };
        let style = Style { wireframe: Some(wireframe), ..bare(side) };
        render(&sheet(n), &from_front(2.3), &style).unwrap()
    };
    let coarse = lined(2, 101);
    assert_eq!(rgb(&coarse, 50, 20), [255, 0, 0], "the edge at x = 0");
    assert_eq!(rgb(&coarse, 65, 20), PLAIN, "within a face");
    let dense = lined(200, 101);
    assert!(rgb(&dense, 50, 20)[1] > 150, "{:?}", rgb(&dense, 50, 20));
}

#[test]
fn no_mesh_is_all_background() {
    let picture = render(&Mesh::default(), &from_front(1.0), &bare(5)).unwrap();
    assert!(picture.rgba().chunks_exact(4).all(|p| p == [0, 0, 0, 255]));
}

#[test]
fn within_and_through_a_mesh_every_style_draws() {
    let mut mesh = ball(3);
    // Slivers and points, here and there.
    for face in mesh.faces.iter_mut().step_by(7) {
        face[1] = face[0];
    }
    let values = vec![f32::NAN; mesh.faces.len()];
    let values = Values { values: &values, map: ColorMap::Heat, range: [0.0, 0.0] };
    let normals =
        [Normals::Flat, Normals::Smooth, Normals::FromMesh, Normals::Creased { crease_rad: 9.0 }];
    for (i, normals) in normals.into_iter().enumerate() {
        let center = mesh.positions[i];
        let camera = Camera::look_at(center, [0.1, 0.0, 0.2], [0.0, 1.0, 0.0], 2.0);
        let wireframe = Some(Wireframe { width_px: f32::NAN, ..Wireframe::default() });
        let paint = Paint::FaceValues(values);
        let style = Style { paint, normals, wireframe, size: [70, 40], ..Style::default() };
        render(&mesh, &camera, &style).unwrap();
    }
}

#[test]
fn what_does_not_fit_the_mesh_is_refused() {
    let camera = from_front(3.0);
    let refused =
        |mesh: &Mesh, style: Style| render(mesh, &camera, &style).unwrap_err().to_string();
    let mesh = sheet(1);
    let message = refused(&mesh, Style { paint: Paint::FaceColors(&[]), ..bare(5) });
    assert_eq!(message, "colours of faces: expected 2 entries, found 0");
    let message = refused(&mesh, bare(0));
    assert!(message.contains("0 x 0"), "{message}");
    let material = PaintMaterial { base_color: [1.0; 3], texture: Some(3) };
    let materials = Materials { materials: vec![material], textures: vec![] };
    let message = refused(&mesh, Style { paint: Paint::Materials(&materials), ..bare(5) });
    assert_eq!(message, "material 0 refers to texture 3, but there are only 0");
    let mut broken = sheet(1);
    broken.positions[2][1] = f64::NAN;
    assert!(refused(&broken, bare(5)).contains("v2"));
}
