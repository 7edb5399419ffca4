//! Typical mistakes at the prompt: each message names what to type instead.

use std::fs;

use crate::run::{Done, Run};

/// Folder with a mesh of 2,000 faces and a diagonal of 3.46, as PLY and as glTF.
fn folder() -> Run {
    let run = Run::new();
    run.sample("sphere", 2000, "in.ply");
    run.sample("sphere", 2000, "in.glb");
    run
}

/// Splits a line into arguments at spaces.
fn line(run: &Run, line: &str) -> Done {
    run.run(&line.split(' ').collect::<Vec<_>>())
}

/// Asserts that each line is refused with a message that has these words, and writes nothing.
fn refused(run: &Run, code: i32, cases: &[(&str, &str)]) {
    let before = run.files();
    for (arguments, words) in cases {
        let done = line(run, arguments);
        assert!(done.code == code && done.out.is_empty(), "{arguments}: {done:?}");
        assert!(done.err.contains(words), "{arguments}: {}", done.err);
        assert_eq!(run.files(), before, "{arguments}");
    }
}

#[test]
fn numbers_that_make_no_sense_ask_back() {
    let cases = [
        ("simplify in.ply out.ply -r 10", "did you mean 10%?"),
        ("simplify in.ply out.ply -r 5000", "did you mean --faces 5000?"),
        ("simplify in.ply out.ply -r 10k", "did you mean --faces 10k?"),
        ("simplify in.ply out.ply -r 0,1", "write it with a point: 0.1"),
        ("simplify in.ply out.ply -r 1/10", "a ratio is written 10% or 0.1"),
        ("simplify in.ply out.ply -f 10%", "did you mean --ratio 10%?"),
        ("simplify in.ply out.ply -f 0.1", "did you mean --ratio 0.1?"),
        ("simplify in.ply out.ply -f 10,000", "write it without separators: 10000"),
        ("extract in.mlod out.ply -f 10,000", "write it without separators: 10000"),
        ("sample sphere out.ply --faces 10,000", "write it without separators: 10000"),
        ("lods in.ply out.glb --levels 10,000", "write 10000, not 10,000"),
        ("lods in.ply out.glb --levels 10.000", "write it without separators: 10000"),
        ("compare in.ply --out out -f 10,000", "write 10000, not 10,000"),
        ("simplify in.ply out.ply -e 2px", "give a percentage of the diagonal, such as 0.1%"),
        ("simplify in.ply out.ply -r 10% --weld 1mm", "in glTF, whose unit is the metre, 0.001"),
        ("simplify in.ply out.ply -r 10% -j all", "all cores are the default"),
    ];
    refused(&folder(), 2, &cases);
}

#[test]
fn whole_numbers_may_end_in_k_and_m() {
    let run = folder();
    for faces in ["0.5k", "500", "5e2"] {
        let json = run.json(&["simplify", "in.ply", "out.ply", "--faces", faces]);
        assert_eq!(json["output_faces"], 500, "{faces}");
    }
    let json =
        run.json(&["run", "{\"verb\": \"lods\", \"levels\": \"1k,0.2k\"}", "in.ply", "o.glb"]);
    assert_eq!(json["levels"][1]["faces"], 200);
}

#[test]
fn numbers_that_are_probably_percentages_are_doubted() {
    let run = folder();
    let built = line(&run, "build in.ply in.mlod");
    assert_eq!(built.code, 0, "{built:?}");
    let cases = [
        (
            "lods in.ply out.glb --levels 50,25,10",
            "2,000 faces; percentages are written 50%,25%,10%",
        ),
        ("lods in.ply out.glb --levels 4", "percentages are written 50%,25%,10%"),
        ("strip in.ply --levels 10", "percentages are written 10%"),
        (
            "simplify in.ply out.ply --error 1",
            "the diagonal of the model is 3.4641; did you mean 1%?",
        ),
        ("simplify in.ply out.ply --error 50%", "a ratio of the faces is written --ratio 50%"),
        ("compress in.ply out.mlq --error 1", "did you mean 1%?"),
        ("build in.ply out.mlod --rounding 1", "did you mean 1%?"),
        ("extract in.mlod out.ply --error 1", "did you mean 1%?"),
        ("strip in.mlod --error 1", "did you mean 1%?"),
        ("simplify in.ply out.ply -r 50% --weld 1", "--weld 1 is a length in model units"),
        ("repair in.ply out.ply --stitch 1", "--stitch 1 is a length in model units"),
        ("batch in.ply out --error 1", "did you mean 1%?"),
    ];
    for (arguments, words) in cases {
        let done = line(&run, arguments);
        assert_eq!(done.code, 0, "{arguments}: {done:?}");
        let doubt = done.err.lines().find(|line| line.contains("warning: in.")).unwrap_or_default();
        assert!(doubt.contains(words), "{arguments}: {}", done.err);
    }
    let recipe = "{\"verb\": \"lods\", \"levels\": \"50,25\"}";
    let done = run.run(&["run", recipe, "in.ply", "out.glb"]);
    assert!(done.err.contains("50%,25%"), "{done:?}");
    for arguments in ["lods in.ply out.glb --levels 1000,100", "simplify in.ply out.ply -e 0.2"] {
        assert_eq!(line(&run, arguments).err, "", "{arguments}");
    }
}

#[test]
fn lengths_with_units_are_read_where_the_file_has_one() {
    let run = folder();
    let asked =
        |arguments: &[&str]| run.json(&[&["simplify"], arguments].concat())["error_asked"].clone();
    assert_eq!(asked(&["in.glb", "out.glb", "--error", "5mm"]), 0.005);
    assert_eq!(asked(&["in.glb", "out.glb", "--error", "1cm"]), 0.01);
    let piped = fs::read(run.path("in.glb")).unwrap();
    let done = run.run_with(&["simplify", "-", "p.ply", "-e", "5mm", "--format", "glb"], &piped);
    assert_eq!(done.code, 0, "{done:?}");
    let cases = [
        ("simplify in.ply x.ply -e 1mm", "in.ply has no unit; give 0.001 if it is in metres, 1 if"),
        ("compress in.ply x.mlq -e 1mm", "or a percentage of its diagonal, such as 0.1%"),
        ("build in.ply x.mlod --rounding 1mm", "in.ply has no unit"),
        ("extract x.mlod x.ply -e 1mm", "whose unit is the metre, 0.001"),
    ];
    refused(&run, 2, &cases);
}
