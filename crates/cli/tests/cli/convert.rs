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
    assert_eq!((done.code, done.out), (0, solids));
    assert_eq!(run.run(&["convert", "in.stl", "out.obj"]).code, 0);
    let done = run.run(&["convert", "out.obj", "out.stl"]);
    assert!(done.err.contains("left out: 2 names of objects (left part, right)"), "{done:?}");
}
