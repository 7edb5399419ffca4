//! The finest level of a multiresolution file: what an error of 0 asks for, and what reading the
//! file as a mesh gives.

use crate::models::{CAMERA, extract, number, write};
use crate::run::Run;

/// Number of squares along each side of a plane.
const SIDE: usize = 12;
const FACES: u64 = 2 * (SIDE * SIDE) as u64;

/// Builds a textured plane, whose levels all are exact.
fn plane(run: &Run) {
    let mut text = String::new();
    let at = |i: usize| i as f64 / SIDE as f64;
    for (x, y) in (0..=SIDE).flat_map(|y| (0..=SIDE).map(move |x| (x, y))) {
        // Textures are stretched differently everywhere.
        let [u, v] = [at(x).powi(2), at(y).sqrt()];
        text += &format!("v {} {} 0\nvt {u} {v}\n", at(x), at(y));
    }
    for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))) {
        let a = y * (SIDE + 1) + x + 1;
        let [b, c, d] = [a + 1, a + SIDE + 2, a + SIDE + 1];
        text += &format!("f {a}/{a} {b}/{b} {c}/{c}\nf {a}/{a} {c}/{c} {d}/{d}\n");
    }
    write(run, "plane.obj", text.as_bytes());
    run.json(&["build", "plane.obj", "plane.mlod", "--in-chunk", "16"]);
}

#[test]
fn an_error_of_zero_is_the_finest_level_for_every_verb() {
    let run = Run::new();
    plane(&run);
    let taken = |ask: &[&str]| number(&extract(&run, "plane.mlod", "cut.obj", ask)["faces"]);
    assert!(taken(&["--error", "0.1%"]) < FACES / 8, "the plane needs few faces");
    let pixels = ["--error", "0px", "--camera", CAMERA];
    for ask in [&["--error", "0"][..], &["--error", "0%"], &pixels, &["--faces", "1000"]] {
        assert_eq!(taken(ask), FACES, "{ask:?}");
        assert_eq!(taken(&[ask, &["--unverified"]].concat()), FACES, "{ask:?} --unverified");
    }
    let strips = run.json(&["strip", "plane.mlod", "--error", "0"]);
    assert_eq!(number(&strips["input_faces"]), FACES);
    let walk = run.json(&["strip", "plane.mlod", "--follow", "1%,0,1%"]);
    let triangles: Vec<u64> =
        walk["cuts"].as_array().unwrap().iter().map(|cut| number(&cut["triangles"])).collect();
    assert!(triangles[0] < FACES / 8 && triangles[1] == FACES, "{triangles:?}");
    assert_eq!(triangles[0], triangles[2]);
}

#[test]
fn a_multiresolution_file_is_read_as_its_finest_mesh() {
    let run = Run::new();
    plane(&run);
    assert_eq!(number(&run.json(&["info", "plane.mlod"])["faces"]), FACES);
    assert_eq!(number(&run.json(&["convert", "plane.mlod", "back.obj"])["faces"]), FACES);
    let packed = run.json(&["compress", "plane.mlod", "plane.mlq", "--bits", "12"]);
    assert_eq!(number(&packed["faces"]), FACES);
    let half = run.json(&["simplify", "plane.mlod", "half.obj", "--ratio", "50%"]);
    assert_eq!(number(&half["input_faces"]), FACES, "{half}");
}
