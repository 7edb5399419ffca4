//! `page` and `serve`: what they write and print, and what they refuse.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::process::Stdio;

use meshlod_fixtures::folding_strip;

use crate::run::Run;

#[test]
fn a_page_holds_all_levels_and_nothing_from_elsewhere() {
    let run = Run::new();
    run.sample("knot", 2_000, "in.ply");
    run.json(&["build", "in.ply", "in.mlod"]);
    let report = run.json(&["page", "in.mlod", "levels.html"]);
    let model = fs::read(run.path("in.mlod")).unwrap();
    assert_eq!(report["model_bytes"], model.len());
    assert!(report["viewer_bytes"].as_u64().unwrap() <= 150_000);
    let page = fs::read_to_string(run.path("levels.html")).unwrap();
    assert_eq!(report["bytes"], page.len());
    assert!(page.contains("<title>in.mlod – meshlod</title>"));
    for word in ["src=", "http://", "<link rel=\"stylesheet\"", "@import"] {
        assert!(!page.contains(word), "{word}");
    }
    // A mesh becomes the file that `build` makes of it.
    run.json(&["page", "in.ply", "mesh.html"]);
    assert_eq!(page, fs::read_to_string(run.path("mesh.html")).unwrap());
    fs::write(run.path("fold.glb"), folding_strip(40)).unwrap();
    assert!(run.json(&["page", "fold.glb", "fold.html"])["model_bytes"].as_u64().unwrap() > 0);
}

#[test]
fn what_no_page_can_be_made_of_is_told() {
    let run = Run::new();
    run.sample("torus", 500, "in.ply");
    fs::write(run.path("bad.mlod"), b"meshlodm, but no more").unwrap();
    fs::create_dir(run.path("folder")).unwrap();
    for (line, code, reason) in [
        (["page", "in.ply", "out.ply"], 2, "must end in .html"),
        (["page", "missing.ply", "out.html"], 1, "missing.ply"),
        (["page", "bad.mlod", "out.html"], 1, "bad.mlod: "),
        (["page", "in.ply", "folder"], 2, "must end in .html"),
        (["serve", "missing", "--json"], 1, "missing: no such folder"),
        (["serve", "in.ply", "--json"], 1, "in.ply: is a file; name its folder"),
        (["serve", "folder", "--seconds=-1"], 2, "must be a number of seconds"),
    ] {
        let done = run.run(&line);
        assert_eq!(done.code, code, "{line:?}: {done:?}");
        assert!(done.err.contains(reason), "{line:?}: {done:?}");
        assert!(done.has_no_answer(), "{line:?}: {done:?}");
    }
    assert_eq!(run.files(), ["bad.mlod", "folder", "in.ply"]);
}

#[test]
fn a_port_that_is_taken_is_told() {
    let run = Run::new();
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let done = run.run(&["serve", ".", "--port", &port]);
    assert_eq!(done.code, 1, "{done:?}");
    assert!(done.only_line().contains("--port 0 takes one that is free"), "{done:?}");
}

#[test]
fn a_server_tells_its_address_first_and_its_figures_last() {
    let run = Run::new();
    fs::write(run.path("a.txt"), "some text").unwrap();
    let mut command = run.command(&["serve", ".", "--port", "0", "--seconds", "2", "--json"]);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut line = String::new();
    BufReader::new(child.stderr.take().unwrap()).read_line(&mut line).unwrap();
    let address = line.split("http://").nth(1).unwrap().trim_end().trim_end_matches('/');
    assert!(address.starts_with("127.0.0.1:"), "{line}");
    let mut stream = TcpStream::connect(address).unwrap();
    stream.write_all(b"GET /a.txt HTTP/1.0\r\n\r\n").unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    assert!(answer.ends_with("\r\n\r\nsome text"), "{answer}");
    let done = child.wait_with_output().unwrap();
    assert!(done.status.success());
    let report: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!((&report["requests"], &report["bytes"]), (&1.into(), &9.into()), "{report}");
    assert_eq!(report["url"], format!("http://{address}/"));
}
