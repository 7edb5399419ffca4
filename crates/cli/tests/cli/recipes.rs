//! Recipes: the verb `run`, keys and values as on the command line, messages with lines.

use std::fs;

use crate::run::Run;

#[test]
fn a_recipe_does_what_its_options_do() {
    let run = Run::new();
    run.sample("torus", 2000, "in.ply");
    let options =
        ["--ratio", "10%", "--lock-boundary", "--weight-normal", "0.5", "--precision", "f64"];
    let done = run.run(&[&["simplify", "in.ply", "by-options.ply"][..], &options].concat());
    assert_eq!(done.code, 0, "{done:?}");
    let toml = "verb = 'simplify'\nratio = '10%'\nlock-boundary = true\nmeasured = false\n\
        weight-normal = 0.5\nprecision = \"f64\"\n";
    fs::write(run.path("r.toml"), toml).unwrap();
    let json = "{\"verb\": \"simplify\", \"ratio\": 0.1, \"lock-boundary\": true,\n\
        \"weight-normal\": 0.5, \"precision\": \"f64\"}";
    fs::write(run.path("r.json"), json).unwrap();
    for recipe in ["r.toml", "r.json", json] {
        let done = run.run(&["run", recipe, "in.ply", "by-recipe.ply"]);
        assert_eq!(done.code, 0, "{recipe}: {done:?}");
        let [a, b] = ["by-options.ply", "by-recipe.ply"].map(|name| fs::read(run.path(name)));
        assert_eq!(a.unwrap(), b.unwrap(), "{recipe}");
    }
}

#[test]
fn paths_of_a_recipe_are_relative_to_its_folder() {
    let run = Run::new();
    fs::create_dir(run.path("sub")).unwrap();
    run.sample("sphere", 500, "sub/in.ply");
    let toml = "verb = 'lods'\ninput = 'in.ply'\noutput = 'out.glb'\nlevels = ['50%', '20%']\n";
    fs::write(run.path("sub/r.toml"), toml).unwrap();
    let json = run.json(&["run", "sub/r.toml"]);
    assert_eq!(json["levels"].as_array().map(Vec::len), Some(2), "{json}");
    assert!(run.path("sub/out.glb").exists());
    let done = run.run(&["run", "sub/r.toml", "sub/in.ply", "here.glb"]);
    assert!(done.code == 0 && run.path("here.glb").exists(), "{done:?}");
}

#[test]
fn what_is_wrong_in_a_recipe_has_a_line() {
    let run = Run::new();
    run.sample("sphere", 100, "in.ply");
    let cases = [
        ("r.toml", "verb = 'simplify'\nrato = '10%'", "line 2: simplify has no option \"rato\""),
        (
            "r.json",
            "{\"verb\": \"simplify\",\n\"rato\": 1}",
            "line 2: simplify has no option \"rato\"",
        ),
        ("r.toml", "\nverb = 'run'", "line 2: verb must be one of info, "),
        ("r.toml", "ratio = '10%'", "verb is missing"),
        ("r.toml", "verb = 'simplify'\n\nratio = '200%'", "line 3: invalid value '200%'"),
        ("r.toml", "verb = 'simplify'\nmeasured = true", "the following required arguments"),
        ("r.toml", "verb = 'simplify'\nratio = true", "line 2: ratio takes a value"),
        ("r.toml", "verb = 'simplify'\nmeasured = 'yes'", "line 2: measured takes true or false"),
        ("r.toml", "verb = 'simplify'\nratio = ['1%', '2%']", "line 2: ratio takes one value"),
        ("r.toml", "verb = 'simplify'\n[ratio]\na = 1", "line 2: ratio must be a string"),
        ("r.toml", "verb = 'simplify'\nratio = \n", "line 2: "),
        ("r.toml", "verb = 'simplify'\nfaces = 9\nratio = '1%'", "cannot be used with"),
        ("r.toml", "verb = 'simplify'\nhelp = true", "line 2: simplify has no option \"help\""),
        ("r.json", "[]", "line 1: a recipe is a JSON object"),
        ("r.yaml", "verb: simplify", "a recipe must end in .toml or .json"),
        ("r.toml", "\u{0}\u{1}", "line 1: "),
    ];
    for (name, text, reason) in cases {
        fs::write(run.path(name), text).unwrap();
        let done = run.run(&["run", name, "in.ply", "out.ply"]);
        assert_eq!((done.code, &done.out[..]), (1, &b""[..]), "{text}: {done:?}");
        let line = done.only_line();
        assert!(line.starts_with(&format!("meshlod: {name}: ")) && line.contains(reason), "{line}");
        fs::remove_file(run.path(name)).unwrap();
    }
    let done = run.run(&["run", "none.toml"]);
    assert!(done.code == 1 && done.only_line().starts_with("meshlod: none.toml: "), "{done:?}");
    assert_eq!(run.files(), ["in.ply"]);
}
