//! Wrong usage: exit code 2, a reason on standard error, nothing written.

use crate::run::Run;

#[test]
fn wrong_usage_is_2_and_writes_nothing() {
    let run = Run::new();
    run.sample("sphere", 100, "in.ply");
    let cases: &[&[&str]] = &[
        &[],
        &["frobnicate"],
        &["info"],
        &["simplify", "in.ply", "out.ply"],
        &["simplify", "in.ply", "out.ply", "--faces", "10", "--ratio", "10%"],
        &["simplify", "in.ply", "out.ply", "--ratio", "10"],
        &["simplify", "in.ply", "out.ply", "--error", "-1"],
        &["simplify", "in.ply", "out.ply", "--faces", "10", "--method", "magic"],
        &["simplify", "in.ply", "out.ply", "--faces", "10", "--weight-uv", "-1"],
        &["lods", "in.ply", "out.glb", "--weight-normal", "much"],
        &["simplify", "in.ply", "out.ply", "--faces", "10", "--boundary", "-1"],
        &["simplify", "in.ply", "out.ply", "--faces", "10", "--boundary", "inf"],
        &["simplify", "in.ply", "out.ply", "--faces", "10", "--no-weld", "--weld", "1"],
        &["simplify", "in.ply", "out.ply", "--faces", "10", "--threads", "0"],
        &["simplify", "in.ply", "out.ply", "--faces", "10", "--threads", "257"],
        &["repair", "in.ply"],
        &["repair", "in.ply", "out.ply", "--stitch", "0.1", "--no-stitch"],
        &["repair", "in.ply", "out.ply", "--hole-length", "1"],
        &["repair", "in.ply", "out.ply", "--weld", "-1"],
        &["simplify", "-", "out.ply", "--faces", "10"],
        &["simplify", "in.ply", "-", "--faces", "10"],
        &["simplify", "in.ply", "-", "--faces", "10", "--format", "ply", "--json"],
        &["simplify", "in.ply", "-", "--faces", "10", "--format", "gltf"],
        &["lods", "in.ply", "-", "--format", "glb"],
        &["lods", "in.ply", "out.glb", "--levels", "50%,x"],
        &["lods", "in.ply", "out.glb", "--levels", "50%,10%,20"],
        &["simplify", "none.ply", "out.xyz", "--faces", "9"],
        &["lods", "none.ply", "out"],
        &["sample", "sphere", "out.fbx"],
        &["measure", "-", "-", "--format", "ply"],
        &["measure", "in.ply", "in.ply", "--samples", "0"],
        &["measure", "in.ply", "in.ply", "--samples", "100000001"],
        &["sample", "teapot", "out.ply"],
        &["sample", "fish", "out.ply", "--faces", "9999999999"],
        &["render", "in.ply", "out.png", "--size", "0x9"],
        &["render", "in.ply", "out.jpg"],
        &["render", "in.ply", "out"],
        &["render", "in.ply", "-", "--json"],
        &["render", "in.ply", "out.png", "--view", "sideways"],
    ];
    for arguments in cases {
        let done = run.run(arguments);
        let is_silent = done.out.is_empty() != arguments.contains(&"--json");
        assert!(done.code == 2 && is_silent, "{arguments:?}: {done:?}");
        assert!(!done.err.is_empty() && !done.err.contains("panicked"), "{done:?}");
        assert_eq!(run.files(), ["in.ply"], "{arguments:?}");
    }
}

#[test]
fn amounts_below_zero_get_the_reason_of_their_option() {
    let run = Run::new();
    let cases: [(&[&str], &str); 7] = [
        (&["simplify", "a.ply", "b.ply", "--error", "-1"], "at least 0"),
        (&["simplify", "a.ply", "b.ply", "--error", "-1%"], "at least 0"),
        (&["simplify", "a.ply", "b.ply", "--ratio", "-10%"], "between 0% and 100%"),
        (&["simplify", "a.ply", "b.ply", "--faces", "-1"], "a whole number"),
        (&["lods", "a.ply", "b.glb", "--levels", "-50%"], "between 0% and 100%"),
        (&["measure", "a.ply", "b.ply", "--samples", "-5"], "at least 1"),
        (&["info", "a.ply", "--threads", "-2"], "at least 1"),
    ];
    for (arguments, reason) in cases {
        let done = run.run(arguments);
        assert!(done.code == 2 && done.err.contains(reason), "{arguments:?}: {done:?}");
        assert!(!done.err.contains("unexpected argument"), "{done:?}");
    }
}

#[test]
fn help_and_version_are_answers() {
    let run = Run::new();
    for arguments in [&["--help"][..], &["--version"], &["simplify", "--help"]] {
        let done = run.run(arguments);
        assert_eq!((done.code, &done.err[..]), (0, ""), "{arguments:?}");
        assert!(done.text().contains("meshlod"), "{done:?}");
    }
}

#[test]
fn what_could_not_be_done_is_1_and_one_line() {
    let run = Run::new();
    run.sample("sphere", 100, "in.ply");
    let folders = ["folder.glb", "folder.ply", "l_LOD2.off"];
    folders.iter().for_each(|name| std::fs::create_dir(run.path(name)).unwrap());
    let cases: [(&[&str], &str); 10] = [
        (&["info", "none.ply"], "none.ply: "),
        (&["info", "in.abc"], "in.abc: unknown suffix"),
        (&["simplify", "none.ply", "in.ply/no/a.ply", "--faces", "9"], "in.ply/no/a.ply: "),
        (&["simplify", "none.ply", "in.ply/out.ply", "--faces", "9"], "in.ply/out.ply: "),
        (&["lods", "none.ply", "in.ply/out.off"], "in.ply/out.off: "),
        (&["sample", "sphere", "folder.ply"], "folder.ply: is a folder"),
        (&["lods", "none.ply", "folder.glb"], "folder.glb: is a folder"),
        (&["lods", "none.ply", "l.off"], "l_LOD2.off: is a folder"),
        (&["measure", "in.ply", "none.obj"], "none.obj: "),
        (&["render", "none.ply", "in.ply/out.png"], "in.ply/out.png: "),
    ];
    for (arguments, beginning) in cases {
        let done = run.run(arguments);
        assert_eq!((done.code, &done.out[..]), (1, &b""[..]), "{arguments:?}: {done:?}");
        assert!(done.only_line().starts_with(&format!("meshlod: {beginning}")), "{done:?}");
        let json = run.run(&[arguments, &["--json"]].concat());
        assert_eq!((json.code, json.only_line()), (1, done.only_line()), "{arguments:?}");
        let failure = &json.json()["failure"];
        let message = format!("meshlod: {}", failure["message"].as_str().unwrap());
        assert_eq!(message, done.only_line());
        assert!(message[9..].starts_with(failure["file"].as_str().unwrap()), "{failure}");
    }
    assert_eq!(run.files(), ["folder.glb", "folder.ply", "in.ply", "l_LOD2.off"]);
}

#[test]
fn an_output_of_another_verb_is_told_which() {
    let run = Run::new();
    run.sample("sphere", 100, "in.ply");
    for (out, verb) in [("out.mlod", "build"), ("out.MLQ", "compress"), ("out.mlz", "compress")] {
        let done = run.run(&["convert", "in.ply", out]);
        let line = format!("meshlod: {out}: only `meshlod {verb}` writes such files");
        assert_eq!((done.code, done.only_line()), (2, &*line));
    }
    assert_eq!(run.files(), ["in.ply"]);
}

#[test]
fn an_input_of_no_known_kind_is_told_all_kinds() {
    let run = Run::new();
    std::fs::create_dir(run.path("folder")).unwrap();
    let done = run.run(&["info", "in.abc"]);
    for suffix in [".ply", ".glb", ".mlod", ".mlq", ".mlz"] {
        assert!(done.only_line().contains(suffix), "{done:?}");
    }
    let folder = run.run(&["info", "folder"]);
    assert_eq!(folder.only_line(), "meshlod: folder: is a folder; name a file to read");
}
