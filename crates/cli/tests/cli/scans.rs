//! Files of scanners and surveys: PLY with textures at faces, coordinates far from the origin.

use meshlod_fixtures::file;

use crate::run::Run;

fn numbers(value: &serde_json::Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

#[test]
fn a_ply_with_textures_at_faces_keeps_them() {
    let run = Run::new();
    let input = file("knot.ply");
    let report =
        run.json(&["simplify", input.to_str().unwrap(), "out.ply", "--ratio", "25%", "--strict"]);
    assert_eq!(report["notes"].as_array().map_or(0, Vec::len), 0, "{report}");
    assert_eq!(run.files(), ["knot.png", "out.ply"]);
    let bytes = std::fs::read(run.path("out.ply")).unwrap();
    let header = String::from_utf8_lossy(&bytes[..400]).into_owned();
    for line in ["comment TextureFile knot.png\n", "property list uchar float texcoord\n"] {
        assert!(header.contains(line), "{header}");
    }
    // Seams tear nothing: a closed surface of one component stays one.
    let info = run.json(&["info", "out.ply"]);
    assert_eq!(info["components"], 1, "{info}");
    assert_eq!(info["boundary_edges"], 0, "{info}");
}

/// A terrain of centimetres in metres of a national grid.
fn survey(run: &Run) {
    let point = |i: u32, j: u32| {
        let [x, y] = [i, j].map(|i| 0.07 * f64::from(i));
        format!("v {} {} {}\n", 500_000.11 + x, 5_400_000.23 + y, 100.0 + 0.03 * (x * y).sin())
    };
    let mut text = String::new();
    (0..100).for_each(|k| text += &point(k % 10, k / 10));
    for k in (0..89).filter(|k| k % 10 != 9) {
        let [a, b, c, d] = [k + 1, k + 2, k + 12, k + 11];
        text += &format!("f {a} {b} {c}\nf {a} {c} {d}\n");
    }
    std::fs::write(run.path("in.obj"), text).unwrap();
}

#[test]
fn a_survey_keeps_its_centimetres() {
    let run = Run::new();
    survey(&run);
    let bounds = |name: &str| {
        let info = run.json(&["info", name]);
        [numbers(&info["bounds"]["min"]), numbers(&info["bounds"]["max"])].concat()
    };
    let before = bounds("in.obj");
    for name in ["out.ply", "out.obj", "out.off", "out.glb", "out.gltf"] {
        run.json(&["simplify", "in.obj", name, "--ratio", "100%", "--strict"]);
        let most = before.iter().zip(bounds(name)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(most < 1e-5, "{name}: {most}");
    }
}

#[test]
fn stl_warns_of_the_step_of_its_coordinates() {
    let run = Run::new();
    survey(&run);
    let done = run.run(&["simplify", "in.obj", "out.stl", "--ratio", "100%"]);
    assert!(done.err.contains("rounded by up to 2."), "{}", done.err);
}

#[test]
fn rounding_that_was_asked_for_is_noted() {
    let run = Run::new();
    survey(&run);
    let done = run.run(&["convert", "in.obj", "out.ply", "--precision", "f32"]);
    assert!(done.err.contains("rounded by up to 2."), "{}", done.err);
    let done = run.run(&["convert", "in.obj", "out.ply"]);
    assert!(done.err.is_empty(), "{}", done.err);
}
