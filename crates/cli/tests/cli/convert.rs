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
