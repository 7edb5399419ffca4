//! Losses on the way from file to file: named once, by every verb, and strictly refused.

use crate::run::Run;

/// Writes a knot in two smoothing groups, which nothing but OBJ holds.
fn in_groups(run: &Run) {
    run.sample("knot", 600, "in.obj");
    let text = std::fs::read_to_string(run.path("in.obj")).unwrap();
    let (vertices, faces) = text.split_at(text.find("\nf ").unwrap() + 1);
    let middle = faces.match_indices('\n').nth(300).unwrap().0 + 1;
    let (first, second) = faces.split_at(middle);
    std::fs::write(run.path("in.obj"), format!("{vertices}s 1\n{first}s 2\n{second}")).unwrap();
}

#[test]
fn every_verb_that_writes_names_what_is_lost_and_strictly_writes_nothing() {
    let run = Run::new();
    in_groups(&run);
    for arguments in [
        "convert in.obj out.ply",
        "simplify in.obj out.off --ratio 50%",
        "lods in.obj out.glb",
        "lods in.obj out.gltf --layout scene",
        "lods in.obj out.ply",
        "strip in.obj --levels 50%,100% --out out.glb",
        "compress in.obj out.glb",
        "compress in.obj out.glb --scheme parts",
        "compress in.obj out.mlq",
        "compress in.obj out.mlz",
        "build in.obj out.mlod",
        "repair in.obj out.stl",
    ] {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        let strict = run.run(&[&arguments[..], &["--strict"]].concat());
        assert_eq!(strict.code, 1, "{arguments:?}: {strict:?}");
        let reason = strict.err.lines().last().unwrap();
        assert!(reason.contains(": left out: 2 smoothing groups (1, 2)"), "{strict:?}");
        assert_eq!(run.files(), ["in.obj"], "{arguments:?}");
        let done = run.run(&[&arguments[..], &["--json"]].concat());
        assert_eq!(done.code, 0, "{done:?}");
        assert_eq!(done.err.matches("2 smoothing groups (1, 2)").count(), 1, "{done:?}");
        let notes = done.json()["notes"].to_string();
        assert_eq!(notes.matches("smoothing groups").count(), 1, "{arguments:?}: {notes}");
        for file in run.files().iter().filter(|file| *file != "in.obj") {
            std::fs::remove_file(run.path(file)).unwrap();
        }
    }
}

#[test]
fn smoothing_groups_stay_with_their_faces() {
    let run = Run::new();
    in_groups(&run);
    let done = run.run(&["simplify", "in.obj", "out.obj", "--ratio", "30%", "--strict"]);
    assert!(done.code == 0 && done.err.is_empty(), "{done:?}");
    let text = std::fs::read_to_string(run.path("out.obj")).unwrap();
    let groups: Vec<&str> = text.lines().filter(|line| line.starts_with("s ")).collect();
    assert_eq!(groups, ["s 1", "s 2"], "faces keep their order");
}

/// Writes a bumpy grid with one of two labels at each vertex.
fn labelled(run: &Run) {
    let side = 21;
    let mut text = format!(
        "ply\nformat ascii 1.0\ncomment by hand\nobj_info scan 7\nelement vertex {}\n\
         property float x\nproperty float y\nproperty float z\nproperty uchar label\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        side * side,
        2 * (side - 1) * (side - 1)
    );
    for (y, x) in (0..side * side).map(|i| (i / side, i % side)) {
        let label = if (x - 10) * (x - 10) + (y - 10) * (y - 10) < 40 { 200 } else { 3 };
        text += &format!("{x} {y} {} {label}\n", ((x * y) % 7) as f32 * 0.1);
    }
    for (y, x) in (0..(side - 1) * (side - 1)).map(|i| (i / (side - 1), i % (side - 1))) {
        let at = y * side + x;
        let [right, up, both] = [at + 1, at + side, at + side + 1];
        text += &format!("3 {at} {right} {both}\n3 {at} {both} {up}\n");
    }
    std::fs::write(run.path("in.ply"), text).unwrap();
}

/// Returns the distinct labels of the vertices of a PLY file.
fn labels(run: &Run, file: &str) -> Vec<f32> {
    let scene = meshlod::read(run.path(file), &meshlod::ReadOptions::default()).unwrap();
    let mesh = scene.into_mesh();
    let layers = mesh.attributes.unwrap().layers;
    let layer = layers.iter().find(|layer| layer.name == "label").expect("a layer of labels");
    let mut values = layer.values.clone();
    values.sort_by(f32::total_cmp);
    values.dedup();
    values
}

#[test]
fn labels_are_never_averaged() {
    let run = Run::new();
    labelled(&run);
    for file in ["out.mlod", "out.mlq", "out.mlz"] {
        let verb = if file == "out.mlod" { "build" } else { "compress" };
        assert_eq!(run.run(&[verb, "in.ply", file]).code, 0);
    }
    for arguments in [
        "simplify in.ply a.ply --ratio 15%",
        "simplify in.ply a.ply --ratio 15% --method wu",
        "extract out.mlod a.ply --faces 120",
        "decompress out.mlq a.ply",
        "decompress out.mlz a.ply",
    ] {
        let done = run.run(&arguments.split(' ').collect::<Vec<_>>());
        assert_eq!(done.code, 0, "{arguments}: {done:?}");
        assert_eq!(labels(&run, "a.ply"), [3.0, 200.0], "{arguments}");
    }
}

/// Gives each face of `in.ply` two numbers: the first is its own, the second a tenth of it.
fn numbered(run: &Run) {
    labelled(run);
    let text = std::fs::read_to_string(run.path("in.ply")).unwrap();
    let (vertices, faces) = text.split_at(text.find("\n3 0 1 ").unwrap() + 1);
    let scalars = "vertex_indices\nproperty ushort number\nproperty double quality\n";
    let mut text = vertices.replace("vertex_indices\n", scalars);
    for (i, face) in faces.lines().enumerate() {
        text += &format!("{face} {i} {}\n", i as f64 / 10.0);
    }
    std::fs::write(run.path("in.ply"), text).unwrap();
}

#[test]
fn scalars_of_faces_stay_with_their_faces_or_are_named() {
    let run = Run::new();
    numbered(&run);
    for (arguments, part) in [
        ("convert in.ply out.ply", 1.0),
        ("simplify in.ply out.ply --ratio 10%", 0.1),
        ("simplify in.ply out.ply --ratio 10% --method wu", 0.1),
        ("simplify in.ply out.ply --error 1%", 1.0),
        ("repair in.ply out.ply", 1.0),
    ] {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        let done = run.run(&[&arguments[..], &["--strict"]].concat());
        assert!(done.code == 0 && done.err.is_empty(), "{arguments:?}: {done:?}");
        let path = run.path("out.ply");
        let header = String::from_utf8_lossy(&std::fs::read(&path).unwrap()[..600]).into_owned();
        assert!(header.contains("property ushort number\nproperty double quality\n"), "{header}");
        let mesh = meshlod::read(&path, &meshlod::ReadOptions::default()).unwrap().into_mesh();
        let [numbers, quality] = &mesh.face_layers[..] else { panic!("{:?}", mesh.face_layers) };
        assert!(mesh.faces.len() as f64 <= 800.0 * part * 1.1, "{}", mesh.faces.len());
        // Faces keep their order, so that the numbers show that none came twice.
        assert!(numbers.values.windows(2).all(|pair| pair[0] < pair[1]), "{arguments:?}");
        assert!(numbers.values.iter().all(|&number| number < 800.0), "{arguments:?}");
        assert!(arguments[0] == "simplify" || mesh.faces.len() == 800, "{arguments:?}");
        let tenths: Vec<f64> = numbers.values.iter().map(|number| number / 10.0).collect();
        assert_eq!(quality.values, tenths, "{arguments:?}");
    }
    let scalars = "left out: 2 properties of faces (number, quality)";
    let all = "left out: 1 comment, 1 line obj_info, 2 properties of faces (number, quality)";
    for (arguments, reason) in [
        ("convert in.ply a.obj", scalars),
        ("simplify in.ply a.glb --ratio 10%", scalars),
        ("build in.ply a.mlod", all),
        ("compress in.ply a.mlz", all),
        ("compress in.ply a.glb", scalars),
    ] {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        let done = run.run(&[&arguments[..], &["--strict"]].concat());
        assert!(done.code == 1 && done.err.contains(reason), "{arguments:?}: {done:?}");
        assert!(!run.files().iter().any(|file| file.starts_with("a.")), "{arguments:?}");
    }
}

#[test]
fn remarks_of_ply_come_back_or_are_named() {
    let run = Run::new();
    labelled(&run);
    let done = run.run(&["convert", "in.ply", "out.ply"]);
    assert!(done.code == 0 && done.err.is_empty(), "{done:?}");
    let header = std::fs::read(run.path("out.ply")).unwrap();
    let header = String::from_utf8_lossy(&header[..200]).into_owned();
    assert!(header.contains("comment by hand\nobj_info scan 7\n"), "{header}");
    assert!(header.contains("property uchar label\n"), "{header}");
    for file in ["out.obj", "out.glb", "out.gltf", "out.off", "out.smf"] {
        let done = run.run(&["convert", "in.ply", file]);
        assert!(!done.err.contains("comment"), "{file}: {done:?}");
        // Labels do not fit everywhere, but comments do.
        run.json(&["convert", file, "back.ply"]);
        let header = std::fs::read(run.path("back.ply")).unwrap();
        let header = String::from_utf8_lossy(&header[..200]).into_owned();
        assert!(header.contains("comment by hand\nobj_info scan 7\n"), "{file}: {header}");
    }
    for file in ["out.stl", "out.mlod", "out.mlz"] {
        let verb = match file {
            "out.mlod" => "build",
            "out.mlz" => "compress",
            _ => "convert",
        };
        let done = run.run(&[verb, "in.ply", file]);
        assert!(done.only_line().contains("1 comment, 1 line obj_info"), "{file}: {done:?}");
        assert_eq!(run.run(&[verb, "in.ply", file, "--strict"]).code, 1, "{file}");
    }
}

#[test]
fn seams_that_were_split_before_are_not_told_again() {
    let run = Run::new();
    // Two squares at a right angle, with normals of their own at the edge that they share.
    let text = "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\n\
        property float z\nproperty float nx\nproperty float ny\nproperty float nz\nelement face 4\n\
        property list uchar int vertex_indices\nend_header\n\
        0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 0 0 0 1\n0 1 0 0 0 1\n\
        1 0 0 1 0 0\n1 0 -1 1 0 0\n1 1 -1 1 0 0\n1 1 0 1 0 0\n\
        3 0 1 2\n3 0 2 3\n3 4 5 6\n3 4 6 7\n";
    std::fs::write(run.path("in.ply"), text).unwrap();
    for weld in [&[][..], &["--weld", "0.001"]] {
        let simplify = ["simplify", "in.ply", "out.ply", "--ratio", "100%"];
        let done = run.run(&[&simplify[..], weld].concat());
        assert!(done.code == 0 && done.err.is_empty(), "{done:?}");
    }
    assert_eq!(run.json(&["info", "out.ply"])["vertices"], 8);
    let obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvn 0 1 0\n\
        f 1//1 2//1 3//1\nf 1//2 3//2 4//2\n";
    std::fs::write(run.path("in.obj"), obj).unwrap();
    let done = run.run(&["convert", "in.obj", "out.ply"]);
    assert!(done.only_line().contains("changed: 2 vertices split at seams"), "{done:?}");
}

#[test]
fn a_truncated_file_says_once_how_far_it_goes() {
    let run = Run::new();
    run.sample("knot", 3000, "in.ply");
    run.json(&["build", "in.ply", "a.mlod", "--in-chunk", "100"]);
    let whole = std::fs::read(run.path("a.mlod")).unwrap();
    std::fs::write(run.path("a.mlod"), &whole[..whole.len() / 2]).unwrap();
    for verb in [&["convert"][..], &["extract", "--error", "0"]] {
        let done = run.run(&[verb, &["a.mlod", "b.ply"]].concat());
        assert!(done.code == 0 && done.only_line().contains("the file is truncated"), "{done:?}");
        let strict = run.run(&[verb, &["a.mlod", "c.ply", "--strict"]].concat());
        assert_eq!((strict.code, run.path("c.ply").exists()), (1, false), "{strict:?}");
    }
}

#[test]
fn what_stl_and_off_have_beside_their_surface_is_named() {
    let run = Run::new();
    let off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 0 0\n";
    std::fs::write(run.path("in.off"), off).unwrap();
    let mut stl = vec![b' '; 80];
    stl.extend(1u32.to_le_bytes());
    let corners = [0.0f32, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    stl.extend(corners.iter().flat_map(|x| x.to_le_bytes()));
    stl.extend([0xff, 0x83, 7]);
    std::fs::write(run.path("in.stl"), stl).unwrap();
    for (file, expected) in [
        ("in.off", "left out: 1 colour of a face; colours of vertices (COFF) stay"),
        ("in.stl", "left out: 1 attribute of a facet, such as its colour, 1 byte behind the last"),
        ("in.stl", "facet; export colours as .ply, .obj or .glb; if they are facets, correct the"),
    ] {
        let done = run.run(&["convert", file, "out.ply"]);
        assert!(done.only_line().contains(expected), "{done:?}");
        assert_eq!(run.run(&["convert", file, "out.ply", "--strict"]).code, 1);
    }
}

#[test]
fn meshes_that_become_one_are_noted_by_every_way() {
    let run = Run::new();
    run.sample("torus", 100, "one.ply");
    let mut scene = meshlod::read(run.path("one.ply"), &meshlod::ReadOptions::default()).unwrap();
    scene.meshes.push(scene.meshes[0].clone());
    let node = meshlod::io::Node { mesh: Some(1), ..scene.nodes[0].clone() };
    scene.nodes.push(node);
    scene.roots.push(1);
    scene.meshes[1].mesh.positions.iter_mut().for_each(|position| position[0] += 9.0);
    meshlod::write(run.path("in.glb"), &scene, &meshlod::WriteOptions::default()).unwrap();
    run.json(&["build", "in.glb", "in.mlod"]);
    run.json(&["compress", "in.glb", "in.mlz"]);
    for way in [
        &["convert", "in.glb"][..],
        &["extract", "in.mlod", "--error", "1%"],
        &["decompress", "in.mlz"],
    ] {
        let done = run.run(&[way, &["out.ply"]].concat());
        let note = "out.ply: changed: 2 instances of meshes merged into one mesh; .glb keeps";
        assert_eq!(done.err.matches(note).count(), 1, "{way:?}: {done:?}");
        let done = run.run(&[way, &["out.glb"]].concat());
        assert!(!done.err.contains("merged"), "{way:?}: {done:?}");
    }
}

#[test]
fn what_a_document_has_beside_its_surface_is_named_when_it_comes_back_without() {
    let run = Run::new();
    std::fs::write(run.path("in.glb"), meshlod_fixtures::folding_strip(8)).unwrap();
    run.json(&["build", "in.glb", "in.mlod"]);
    run.json(&["compress", "in.glb", "in.mlq"]);
    let before = run.files();
    for way in [
        &["extract", "in.mlod", "out.obj", "--error", "0.1%"][..],
        &["decompress", "in.mlq", "out.obj"],
        &["convert", "in.mlq", "out.obj"],
        &["convert", "in.glb", "out.obj"],
    ] {
        let strict = run.run(&[way, &["--strict"]].concat());
        assert!(
            strict.err.contains("out.obj: left out: 1 skin, 1 animation"),
            "{way:?}: {strict:?}"
        );
        assert_eq!((strict.code, run.files()), (1, before.clone()), "{way:?}");
    }
}
