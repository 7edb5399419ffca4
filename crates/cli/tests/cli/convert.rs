//! The verb `convert`: what arrives in each format, and what is named.

use crate::run::Run;

const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
    f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n";

#[test]
fn a_mesh_goes_through_every_format() {
    let run = Run::new();
    std::fs::write(run.path("a.obj"), QUAD).unwrap();
    let mut from = "a.obj".to_owned();
    for to in ["b.glb", "c.ply", "d.gltf", "e.off", "f.smf", "g.stl", "h.obj"] {
        let json = run.json(&["convert", &from, to]);
        assert_eq!((&json["faces"], &json["vertices"]), (&2.into(), &4.into()), "{to}");
        let uvs_lost = json["notes"].as_array().unwrap().iter().any(|note| {
            note["what"] == "vertex attribute" && note["names"][0] == "texture coordinates"
        });
        assert_eq!(uvs_lost, to == "g.stl", "{json}");
        from = to.to_owned();
    }
    assert_eq!(run.json(&["info", "h.obj"])["area"], 1.0);
}

#[test]
fn strictly_nothing_is_written_where_something_is_lost() {
    let run = Run::new();
    std::fs::write(run.path("a.obj"), QUAD).unwrap();
    let done = run.run(&["convert", "a.obj", "b.stl", "--strict"]);
    assert!(done.code == 1 && done.only_line().contains("b.stl: left out: "), "{done:?}");
    assert_eq!(run.files(), ["a.obj"]);
    assert!(done.only_line().ends_with("; .glb keeps everything"), "{done:?}");
    assert_eq!(run.run(&["convert", "a.obj", "b.glb", "--strict"]).code, 0);
}

#[test]
fn solids_of_a_text_file_keep_their_names_and_bits() {
    let run = Run::new();
    let mut solids = String::new();
    for (name, x) in [("left part", "0.1"), ("right", "1000000.1")] {
        solids += &format!("solid {name}\nfacet normal 0 0 1\nouter loop\nvertex {x} 0 0\n");
        solids += &format!("vertex 1000000.3 0 0\nvertex {x} 1 0\nendloop\nendfacet\n");
        solids += &format!("endsolid {name}\n");
    }
    std::fs::write(run.path("in.stl"), &solids).unwrap();
    assert_eq!(run.run(&["convert", "in.stl", "out.stl", "--strict"]).code, 0);
    assert_eq!(std::fs::read_to_string(run.path("out.stl")).unwrap(), solids);
    let done = run.run(&["convert", "in.stl", "-", "--format", "stl", "--strict"]);
    assert_eq!((done.code, done.out), (0, solids.clone().into_bytes()));
    assert_eq!(run.run(&["convert", "in.stl", "out.obj"]).code, 0);
    let done = run.run(&["convert", "out.obj", "out.stl"]);
    assert!(done.err.contains("left out: 2 names of objects (left part, right)"), "{done:?}");
}

#[test]
fn unused_points_are_noted_where_they_go_and_not_counted() {
    let run = Run::new();
    std::fs::write(run.path("a.obj"), format!("v 7 7 7\n{}", QUAD.replace("f 1", "f 5"))).unwrap();
    for (to, vertices) in [("b.ply", 5), ("c.glb", 4), ("d.stl", 4)] {
        let done = run.run(&["convert", "a.obj", to, "--json"]);
        assert_eq!(done.json()["vertices"], vertices, "{to}");
        assert_eq!(done.err.contains("1 unused vertex"), vertices == 4, "{to}: {done:?}");
    }
}

#[test]
fn a_strict_conversion_of_a_plain_scan_goes_through() {
    let run = Run::new();
    let text = "ply\nformat ascii 1.0\ncomment a scan\nelement vertex 3\nproperty float x\n\
        property float y\nproperty float z\nelement face 1\n\
        property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    std::fs::write(run.path("a.ply"), text).unwrap();
    for to in ["b.glb", "b.gltf", "b.obj", "b.off", "b.smf", "b.ply"] {
        let done = run.run(&["convert", "a.ply", to, "--strict"]);
        assert!(done.code == 0 && done.err.is_empty(), "{to}: {done:?}");
    }
}

#[test]
fn what_a_scan_has_beyond_its_numbers_is_counted() {
    let run = Run::new();
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nproperty float nx\nproperty float ny\nproperty float nz\n\
        property float scalar_a\nproperty int64 lab\nelement face 2\n\
        property list uchar int vertex_indices\nend_header\n\
        0 0 0 0 nan 1 nan 1\n1 0 0 0 0 1 inf 2\n0 1 0 0 0 1 5 9007199254740993\n3 0 1 2\n2 0 1\n";
    std::fs::write(run.path("a.ply"), text).unwrap();
    let done = run.run(&["convert", "a.ply", "b.ply"]);
    assert_eq!(done.code, 0, "{done:?}");
    for note in [
        "1 face of fewer than three corners",
        "2 values of attributes that are not finite read as 0",
        "1 normal without a length computed from the faces around it",
        "1 value rounded to 32 bits",
    ] {
        assert!(done.err.contains(note), "{note}: {done:?}");
    }
    let mesh = meshlod::read(run.path("b.ply"), &meshlod::ReadOptions::default()).unwrap();
    let layers = mesh.into_mesh().attributes.unwrap().layers;
    let of = |name: &str| &layers.iter().find(|layer| layer.name == name).unwrap().values[..];
    assert_eq!(of("scalar_a"), [0.0, 0.0, 5.0]);
    assert_eq!(of("nx ny nz")[..3], [0.0, 0.0, 1.0]);
    assert_eq!(of("lab")[..2], [1.0, 2.0]);
    let header = String::from_utf8_lossy(&std::fs::read(run.path("b.ply")).unwrap()).into_owned();
    assert!(header.contains("property int64 lab\n"), "{header}");
}
