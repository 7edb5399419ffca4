//! Meshes through pipes, and pipes that close early.

use std::process::{Command, Stdio};

use crate::run::Run;

#[test]
fn a_sample_goes_through_a_pipe() {
    let run = Run::new();
    let sample = run.run(&["sample", "torus", "-", "--format", "ply", "--faces", "2000"]);
    assert!(sample.code == 0 && sample.out.starts_with(b"ply\n"), "{}", sample.err);
    assert!(sample.err.contains("faces"), "what there is to say is not in the mesh");
    let arguments = ["simplify", "-", "-", "--format", "ply", "--ratio", "10%"];
    let level = run.run_with(&arguments, &sample.out);
    assert_eq!(level.code, 0, "{}", level.err);
    let info = run.run_with(&["info", "-", "--format", "ply", "--json"], &level.out).json();
    assert!(info["faces"].as_u64().is_some_and(|faces| (190..=200).contains(&faces)), "{info}");
    assert_eq!(info["closed"], true);
}

#[test]
fn every_format_but_gltf_goes_through_a_pipe() {
    let run = Run::new();
    for format in ["ply", "obj", "stl", "off", "smf", "glb"] {
        let sample = run.run(&["sample", "sphere", "-", "--format", format, "--faces", "500"]);
        let info = run.run_with(&["info", "-", "--format", format, "--json"], &sample.out).json();
        assert_eq!(
            (&info["closed"], info["components"].as_u64()),
            (&true.into(), Some(1)),
            "{format}"
        );
    }
}

#[test]
fn what_belongs_beside_a_file_is_noted_where_there_is_no_place_beside() {
    let run = Run::new();
    let object = "mtllib in.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl red\nf 1/1 2/1 3/1\n";
    std::fs::write(run.path("in.obj"), object).unwrap();
    std::fs::write(run.path("in.mtl"), "newmtl red\nKd 1 0 0\nmap_Kd t.png\n").unwrap();
    std::fs::write(run.path("t.png"), b"\x89PNG\r\n\x1a\n").unwrap();
    for (format, expected) in [
        ("obj", "left out: 1 material's look (red), 1 texture (t.png)"),
        ("ply", "1 texture (t.png)"),
    ] {
        let arguments = ["convert", "in.obj", "-", "--format", format];
        let done = run.run(&arguments);
        assert!(done.code == 0 && done.err.contains(expected), "{done:?}");
        let strict = run.run(&[&arguments[..], &["--strict"]].concat());
        assert!(strict.code == 1 && strict.out.is_empty(), "{strict:?}");
    }
    let glb = run.run(&["convert", "in.obj", "-", "--format", "glb", "--strict"]);
    assert!(glb.code == 0 && !glb.err.contains("left out"), "an image is embedded: {glb:?}");
}

#[test]
fn a_picture_goes_through_a_pipe() {
    let run = Run::new();
    run.sample("sphere", 100, "in.ply");
    let done = run.run(&["render", "in.ply", "-", "--size", "16x16"]);
    assert_eq!(done.code, 0, "{}", done.err);
    assert!(done.out.starts_with(b"\x89PNG") && done.out.ends_with(b"IEND\xaeB`\x82"));
    assert_eq!((done.err.as_str(), run.files()), ("-: 16 x 16\n", vec!["in.ply".into()]));
}

#[test]
fn errors_of_a_pipe_name_it() {
    let run = Run::new();
    let done = run.run_with(&["info", "-", "--format", "off"], b"OFF\n3 x 0\n");
    assert_eq!(done.code, 1);
    assert!(done.only_line().starts_with("meshlod: -: line 2: "), "{done:?}");
}

#[test]
fn a_pipe_that_closes_is_no_panic() {
    let run = Run::new();
    run.sample("knot", 50_000, "in.ply");
    for arguments in [
        &["info", "in.ply"][..],
        &["info", "in.ply", "--json"],
        &["--help"],
        &["sample", "knot", "-", "--format", "obj", "--faces", "50000"],
    ] {
        let mut child =
            run.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let done = child.wait_with_output().unwrap();
        let err = String::from_utf8(done.stderr).unwrap();
        assert!(!err.contains("panicked") && done.status.code().is_some(), "{arguments:?}: {err}");
    }
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_leaves_nothing() {
    let run = Run::new();
    run.sample("knot", 400_000, "in.ply");
    for signal in ["-INT", "-TERM", "-HUP"] {
        let mut child =
            run.command(&["simplify", "in.ply", "out.ply", "--ratio", "1%"]).spawn().unwrap();
        std::thread::sleep(std::time::Duration::from_millis(50));
        let killed = Command::new("kill").args([signal, &child.id().to_string()]).status();
        assert!(killed.is_ok_and(|status| status.success()));
        // The run may have finished first; then the file is there and complete.
        if child.wait().unwrap().code() == Some(0) {
            assert_eq!(run.json(&["info", "out.ply"])["closed"], true);
            std::fs::remove_file(run.path("out.ply")).unwrap();
        } else {
            assert_eq!(run.files(), ["in.ply"], "{signal}");
        }
    }
}

#[test]
fn a_tile_is_read_from_a_pipe_and_not_written_to_one() {
    let run = Run::new();
    run.sample("sphere", 100, "in.glb");
    let glb = std::fs::read(run.path("in.glb")).unwrap();
    let tile = [&b"b3dm\x01\0\0\0"[..], &[0; 20], &glb].concat();
    let read = run.run_with(&["convert", "-", "out.ply", "--format", "b3dm"], &tile);
    assert_eq!(read.code, 0, "{}", read.err);
    for arguments in [
        &["simplify", "in.glb", "-", "--ratio", "50%"][..],
        &["convert", "in.glb", "-"],
        &["lods", "in.glb", "levels/", "--levels", "50%"],
    ] {
        let done = run.run(&[arguments, &["--format", "b3dm"]].concat());
        let expected = "meshlod: --format b3dm: b3dm is read only; use --format glb";
        assert_eq!(done.only_line(), expected);
        assert!(done.code == 2 && done.out.is_empty(), "{done:?}");
    }
}
