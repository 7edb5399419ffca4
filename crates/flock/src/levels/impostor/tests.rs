use std::sync::Arc;

use glam::Vec3;
use meshlod_mesh::Labels;
use meshlod_picture::{Background, Picture};

use super::*;
use crate::camera::FlockCamera;
use crate::draw::FlockPainter;
use crate::flock::Flock;
use crate::levels::{ChainOptions, ModelAxes};
use crate::select::InstanceLevel;

fn fish() -> LevelTable {
    let options =
        ChainOptions { axes: ModelAxes::FISH, directions: 2, step: 0.2, ..ChainOptions::default() };
    LevelTable::new(&meshlod_samples::fish(1_000), &Look::default(), &options).unwrap()
}

fn small() -> ImpostorOptions {
    ImpostorOptions { views_per_side: 8, side_px: 32, ..ImpostorOptions::default() }
}

/// Mean difference of two pictures, in parts of white.
fn difference(a: &Picture, b: &Picture) -> f64 {
    let sum: u64 = a.rgba().iter().zip(b.rgba()).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    sum as f64 / (255 * a.rgba().len()) as f64
}

#[test]
fn a_quad_faces_the_eye_and_shows_its_cell() {
    let impostor = Impostor::draw(&fish(), &Look::default(), &small()).unwrap();
    assert_eq!([impostor.atlas.width(), impostor.atlas.height()], [256; 2]);
    let (position, heading) = (Vec3::new(3.0, -1.0, 2.0), Vec3::new(0.6, 0.0, -0.8));
    for cell in 0..impostor.directions.len() {
        let axis = frame_of(heading) * impostor.directions.axis(cell);
        let quad = impostor.quad(position, heading, position + axis * 50.0);
        assert_eq!(quad.cell, cell);
        let [a, b, c, d] = quad.corners;
        assert!((0.25 * (a + b + c + d) - position).length() < 1e-5);
        assert!(((b - a).cross(c - b).normalize() - axis).length() < 1e-4, "it faces the eye");
        assert!(((a - d).length() - 2.0 * impostor.half_width).abs() < 1e-5);
        assert!(a.y >= b.y - 1e-5, "it is upright");
        let [upper, lower] = quad.uv;
        let middle = [0, 1].map(|axis| 128.0 * (upper[axis] + lower[axis]));
        let [x, y] = middle.map(|x| x as u32 / 32);
        assert_eq!((y * 8 + x) as usize, cell);
        assert_eq!([0, 1].map(|axis| lower[axis] - upper[axis]), [0.125; 2]);
    }
}

#[test]
fn an_impostor_looks_like_the_model_from_its_views() {
    let table = fish();
    let options = ImpostorOptions { side_px: 128, ..small() };
    let impostor = Arc::new(Impostor::draw(&table, &Look::default(), &options).unwrap());
    let look = Look::default();
    let mut painter = FlockPainter::new(&table, &look, &[]);
    painter.background = Background::Plain([40, 90, 120]);
    let mut flock = Flock::default();
    flock.members.push([0.0; 3], [0.6, 0.0, -0.8]);
    let mut draw = |eye: Vec3, level: InstanceLevel, impostor: Option<Arc<Impostor>>| {
        painter.impostor = impostor;
        let camera = FlockCamera::look_at(eye.into(), [0.0; 3], 0.05, [40, 40]).unwrap();
        painter.draw(&flock, &[level], &camera).unwrap()
    };
    for cell in (0..impostor.directions.len()).step_by(7) {
        let eye = frame_of(flock.members.heading(0)) * impostor.directions.axis(cell) * 30.0;
        let full = draw(eye, InstanceLevel::drawn(0), None);
        let shown = draw(eye, InstanceLevel::IMPOSTOR, Some(impostor.clone()));
        let nothing = draw(eye, InstanceLevel::HIDDEN, None);
        let (error, most) = (difference(&full, &shown), difference(&full, &nothing));
        // From behind a fish is four pixels wide, nearly all of them rims.
        assert!(error < 0.25 * most, "{cell}: {error} of {most}");
        let coarsest = InstanceLevel::drawn(table.chains[0].levels.end - 1);
        let without = draw(eye, InstanceLevel::IMPOSTOR, None);
        assert_eq!(without, draw(eye, coarsest, None));
    }
}

#[test]
fn rims_are_not_darkened() {
    let impostor = Impostor::draw(&fish(), &Look::default(), &small()).unwrap();
    assert!(impostor.atlas.rgba().chunks_exact(4).all(|p| p[..3] != [0; 3]));
    let (mut seen, mut clear) = (0, 0);
    for (i, pixel) in impostor.atlas.rgba().chunks_exact(4).enumerate() {
        let [x, y] = [i % 256 % 32, i / 256 % 32];
        let at_rim = [x, y].iter().any(|&x| x == 0 || x == 31);
        assert!(!at_rim || pixel[3] == 0, "a pixel is left at each rim");
        seen += usize::from(pixel[3] == 255);
        clear += usize::from(pixel[3] == 0);
    }
    assert!(seen > 64 * 50 && clear > 64 * 300, "{seen} {clear}");
}

#[test]
fn odd_eyes_and_options_are_no_trouble() {
    let table = fish();
    let impostor = Impostor::draw(&table, &Look::default(), &small()).unwrap();
    let quad = impostor.quad(Vec3::ONE, Vec3::Y, Vec3::ONE);
    assert!(quad.corners.iter().all(|corner| corner.is_finite()));
    for (views_per_side, side_px) in [(1, 32), (33, 32), (8, 7), (8, 48), (8, 1024)] {
        let options = ImpostorOptions { views_per_side, side_px, ..small() };
        let drawn = Impostor::draw(&table, &Look::default(), &options);
        assert!(matches!(drawn, Err(TableError::Option(_))));
    }
}

#[test]
fn materials_that_the_look_does_not_have_are_no_trouble() {
    let mut mesh = meshlod_samples::fish(1_000);
    let of_face = (0..mesh.faces.len()).map(|face| face as u32 % 2).collect();
    mesh.materials = Some(Labels { names: vec!["skin".into(), "eye".into()], of_face });
    let options =
        ChainOptions { axes: ModelAxes::FISH, directions: 2, step: 0.2, ..ChainOptions::default() };
    let table = LevelTable::new(&mesh, &Look::default(), &options).unwrap();
    assert_eq!(table.materials.as_ref().unwrap().names.len(), 2);
    let impostor = Impostor::draw(&table, &Look::default(), &small()).unwrap();
    assert!(impostor.atlas.rgba().iter().skip(3).step_by(4).any(|&alpha| alpha == 255));
}
