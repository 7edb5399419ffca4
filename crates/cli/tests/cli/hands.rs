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

/// Keys of an answer that those of several files have once.
const HEAD: [&str; 3] = ["format", "version", "verb"];

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
        ("simplify in.ply out.ply -r 10% -j all", "leave it out to use all cores"),
        ("simplify in.ply out.ply -r 10% --method quadric", "did you mean qem?"),
        ("simplify in.ply out.ply -r 10% --method QEM", "did you mean qem?"),
        ("lods in.ply out.glb --layout unity", "did you mean scene?"),
        ("extract in.mlod out.ply -e 1px", "pixels need a camera: --camera \"eye=x,y,z"),
        ("extract in.mlod out.ply -e 1px --camera 0,0,3", "expected \"eye=x,y,z look=x,y,z"),
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
        ("lods in.ply out.glb --levels 100%,50%", "LOD0 is the input, so leave out 100%"),
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
    for size in ["5mm", "0.005"] {
        let done = line(&run, &format!("simplify in.glb {size}.glb -r 10% --vanish-below {size}"));
        assert_eq!(done.code, 0, "{done:?}");
    }
    let [metric, plain] = ["5mm.glb", "0.005.glb"].map(|file| fs::read(run.path(file)).unwrap());
    assert!(metric == plain);
    let cases = [
        (
            "simplify in.ply x.ply -r 10% --vanish-below 1mm",
            "--vanish-below 1mm: in.ply has no unit",
        ),
        ("simplify in.ply x.ply -e 1mm", "in.ply has no unit; give 0.001 if it is in metres, 1 if"),
        ("compress in.ply x.mlq -e 1mm", "or a percentage of its diagonal, such as 0.1%"),
        ("build in.ply x.mlod --rounding 1mm", "in.ply has no unit"),
        ("extract x.mlod x.ply -e 1mm", "whose unit is the metre, 0.001"),
    ];
    refused(&run, 2, &cases);
}

#[test]
fn unknown_options_name_the_one_that_was_meant() {
    let cases = [
        ("simplify in.ply out.ply --mode qem -r 10%", "did you mean --method?"),
        ("simplify in.ply out.ply --rato 10%", "did you mean --ratio?"),
        ("simplify in.ply out.ply --target-faces 500", "did you mean --faces?"),
        ("simplify in.ply out.ply --tolerance 1%", "did you mean --error?"),
        ("batch in.ply out --triangles 500", "did you mean --faces?"),
        ("lods in.ply out.glb --ratio 50%", "did you mean --levels?"),
        ("lods in.ply out.glb -r 50%", "did you mean --levels?"),
        ("lods in.ply out.glb -r50%", "did you mean --levels?"),
        ("simplify in.ply out.ply -si 0.1", "did you mean --ratio?"),
        ("simplify in.ply out.ply --target-reduction 0.9", "--ratio 10% for a reduction of 90%"),
        ("compress in.ply out.mlq -r 10%", "--ratio is an option of simplify, compare and batch"),
        ("extract in.mlod out.ply --ratio 10%", "did you mean --faces?"),
        ("simplify in.ply out.ply -r 10% --preserve-uv", "attributes are kept anyway"),
        ("simplify in.ply out.ply --levels 50%", "--levels is an option of lods and strip"),
        ("simplify in.ply -o out.ply -r 10%", "only a place: meshlod simplify <IN> <OUT>"),
        ("check in.ply --output report", "did you mean --out <DIR>?"),
        ("check in.ply --fix", "meshlod repair does that"),
        ("simplify in.ply out.ply -r 10% --overwrite", "files that are there are replaced"),
        ("simplify in.ply out.glb -r 10% --draco", "meshlod compress writes"),
        ("simplify in.ply out.ply -ratio 10%", "two hyphens: --ratio"),
        ("simplify in.ply out.ply –ratio 10%", "two hyphens, not a dash: --ratio"),
        ("--ratio 10% in.ply out.ply", "name the verb first"),
        ("--simplify in.ply out.ply", "a verb has no hyphens: meshlod simplify"),
    ];
    let run = folder();
    refused(&run, 2, &cases);
    for (arguments, _) in cases {
        assert!(!line(&run, arguments).err.contains("as a value"), "{arguments}");
    }
    let json = line(&run, "simplify in.ply out.ply --rato 10% --json").json();
    let message = "unexpected argument '--rato' found; did you mean --ratio?";
    assert_eq!(json["failure"]["message"], message);
}

#[test]
fn words_without_a_place_are_told_theirs() {
    let run = folder();
    fs::copy(run.path("in.ply"), run.path("my mesh.ply")).unwrap();
    let cases = [
        ("simplify in.ply in.glb out.ply -r 10%", "several: meshlod batch <IN>... <OUT FOLDER>"),
        ("convert in.ply in.glb out.ply", "--recipe '{\"verb\": \"convert\"}'"),
        ("compare in.ply in.glb", "meshlod measure in.ply in.glb"),
        ("simplify my mesh.ply out.ply -r 10%", "needs quotes: \"my mesh.ply\""),
        ("simplify in.ply out.ply -r 10 %", "without a space: 10%"),
        ("simplify in.ply out.ply -e 1 mm", "without a space: 1mm"),
        ("simplify in.ply out.ply -e 1 percent", "without a space: 1%"),
        ("strip in.ply out.glb", "did you mean --out out.glb?"),
        ("simplify in.ply out.ply 10%", "did you mean --ratio 10%?"),
        ("simplify in.ply out.ply 500", "did you mean --faces 500?"),
        ("lods in.ply out.glb 50%", "did you mean --levels 50%?"),
        ("lods in.ply out.glb --levels 50% 25% 10%", "--levels 50%,25%,10%"),
        ("lods in.ply out.glb --levels 50%, 25%", "--levels 50%,25%"),
        ("lods in.ply out.glb --levels 50%,", "a number is missing"),
        ("simplify in.ply", "say how far, such as --ratio 10%"),
        ("simplify in.ply -r 10%", "name the file to write after in.ply"),
        ("measure in.ply", "meshlod measure in.ply <B>"),
        ("batch in.ply", "the last path is the folder to write to"),
    ];
    refused(&run, 2, &cases);
    let done = line(&run, "simplify in.ply out.ply -r 10% --json out.json");
    assert!(done.err.contains("write --json > out.json"), "{done:?}");
}

#[test]
fn a_line_without_a_verb_is_told_which() {
    let cases = [
        ("in.ply out.ply", "name a verb first: meshlod simplify in.ply out.ply --ratio 10%"),
        ("in.ply out.glb", "meshlod convert in.ply out.glb, or meshlod simplify"),
        ("in.ply out.mlod", "meshlod build in.ply out.mlod"),
        ("in.ply", "meshlod info in.ply"),
        ("decimate in.ply out.ply", "did you mean simplify?"),
        ("simplfy in.ply out.ply", "did you mean simplify?"),
        ("validate in.ply", "did you mean check?"),
    ];
    refused(&folder(), 2, &cases);
}

#[test]
fn keys_and_verbs_of_recipes_are_told_like_options() {
    let run = folder();
    let cases = [
        ("{\"verb\": \"simplify\", \"rato\": 0.1}", "no option \"rato\"; did you mean ratio?"),
        ("{\"verb\": \"simplify\", \"mode\": \"qem\"}", "did you mean method?"),
        ("{\"verb\": \"simplify\", \"lock_boundary\": true}", "did you mean lock-boundary?"),
        ("{\"verb\": \"decimate\"}", "did you mean simplify?"),
        ("{\"verb\": \"simplify\"}", "say how far, such as --ratio 10%"),
        ("{\"verb\": \"lods\", \"levels\": \"10,000\"}", "write 10000, not 10,000"),
        ("simplify", "a verb is run by itself: meshlod simplify"),
    ];
    for (recipe, words) in cases {
        let done = run.run(&["run", recipe, "in.ply", "out.ply"]);
        assert!(done.code == 1 && done.only_line().contains(words), "{recipe}: {done:?}");
    }
}

#[test]
fn files_that_are_not_read_name_a_way() {
    let run = folder();
    fs::create_dir(run.path("out")).unwrap();
    let cases = [
        ("info in.fbx", "in.fbx: .fbx is not read: open it in Blender and export .glb"),
        ("info in.3mf", "export .stl from a slicer"),
        ("simplify in.usdz out.glb -r 10%", "which imports USD, and export .glb"),
        ("simplify in.STEP out.glb -r 10%", ".step is not read: it holds CAD surfaces"),
        ("info in.ply.gz", "unpack it first"),
        ("info in.mtl", "name the .obj or .gltf"),
        (
            "extract in.ply out.ply",
            "is no .mlod file; make one first: meshlod build in.ply in.mlod",
        ),
        ("decompress in.ply out.ply", "use meshlod convert in.ply out.ply"),
        ("info in.obj", "did you mean in.glb?"),
        ("info IN.ply", "did you mean in.ply?"),
        ("simplify *.ply out.ply -r 10%", "meshlod batch '*.ply' OUT"),
        ("info https://example.com/a.glb", "download it first"),
        ("simplify in.ply out -r 10%", "name a file to write, such as out/out.glb"),
        ("simplify in.ply new/ -r 10%", "name a file to write, such as new/out.glb"),
        ("batch none out2 -r 10%", "none: there is no such file or folder"),
        (
            "simplify in.ply out.ply -r 10% --locks in.ply",
            "written by meshlod check IN --locks FILE",
        ),
    ];
    refused(&run, 1, &cases);
    let cases = [
        ("convert in.ply out.usdz", ".usdz is not written: write .glb"),
        ("lods in.ply out.fbx", ".fbx is not written: write .glb"),
        ("convert in.ply new", "did you mean new.glb?"),
        ("convert in.ply obj", "did you mean out.obj?"),
        ("build in.ply out.glb", "levels in .glb are written by meshlod lods"),
        ("batch in.ply out.ply -r 10%", "the last path of a batch is the folder to write to"),
        ("batch in.ply in.glb -r 10%", "the last path of a batch is the folder to write to"),
    ];
    refused(&run, 2, &cases);
}

#[test]
fn a_folder_gets_the_levels_of_a_chain() {
    let run = folder();
    let report = run.json(&["lods", "in.ply", "new/", "--levels", "50%"]);
    assert_eq!(report["layout"], "files");
    fs::create_dir(run.path("there")).unwrap();
    run.json(&["lods", "in.ply", "there", "--levels", "50%", "--format", "obj"]);
    run.json(&["lods", "in.ply", "there", "--levels", "50%", "--layout", "scene"]);
    for file in ["new/in_LOD0.ply", "new/in_LOD1.ply", "new/in.lods.json", "there/in_LOD1.obj"] {
        assert!(run.path(file).exists(), "{file}");
    }
    assert!(run.path("there/in.glb").exists());
}

#[test]
fn info_and_check_take_several_files() {
    let run = folder();
    for verb in ["info", "check"] {
        let all = run.json(&[verb, "in.ply", "in.glb"]);
        for (at, file) in ["in.ply", "in.glb"].into_iter().enumerate() {
            let mut one = run.json(&[verb, file]);
            one.as_object_mut().unwrap().retain(|key, _| !HEAD.contains(&&**key));
            assert_eq!(all["files"][at], one);
        }
        let pattern = run.json(&[verb, "in.*"]);
        let names: Vec<_> =
            pattern["files"].as_array().unwrap().iter().map(|f| &f["file"]).collect();
        assert_eq!(names, ["in.glb", "in.ply"]);
        let done = line(&run, &format!("{verb} in.ply none.ply in.glb"));
        assert!(done.code == 1 && done.only_line().contains("none.ply: "), "{done:?}");
        assert!(done.text().contains("in.ply") && done.text().contains("in.glb"), "{done:?}");
        let json = line(&run, &format!("{verb} none.ply in.glb --json")).json();
        assert_eq!(
            (&json["files"][0]["exit"], json["files"].as_array().unwrap().len()),
            (&1.into(), 2)
        );
    }
    refused(&run, 2, &[("check in.ply in.glb --out page", "--locks and --out are for one file")]);
}

#[test]
fn a_defect_in_one_of_several_files_is_an_exit_code() {
    let run = folder();
    let faces = "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n";
    fs::write(run.path("twice.off"), faces).unwrap();
    let code = |files: &str| line(&run, &format!("check {files}")).code;
    assert_eq!((code("in.ply in.glb"), code("twice.off"), code("twice.off in.ply")), (0, 3, 3));
}
