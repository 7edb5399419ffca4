//! Help, short options, quiet runs, completions and manual pages.

use crate::run::Run;

#[test]
fn short_options_are_the_long_ones() {
    let run = Run::new();
    run.sample("knot", 2_000, "in.ply");
    let pairs = [
        (&["-r", "10%"][..], &["--ratio", "10%"][..]),
        (&["-f", "100"], &["--faces", "100"]),
        (&["-e", "1%"], &["--error", "1%"]),
        (&["-qj1", "-f50"], &["--quiet", "--threads", "1", "--faces", "50"]),
    ];
    for (short, long) in pairs {
        let written = [("short.ply", short), ("long.ply", long)].map(|(file, options)| {
            let done = run.run(&[&["simplify", "in.ply", file], options].concat());
            assert_eq!(done.code, 0, "{options:?}: {done:?}");
            std::fs::read(run.path(file)).unwrap()
        });
        assert!(written[0] == written[1], "{short:?}");
    }
}

#[test]
fn help_comes_in_groups() {
    let run = Run::new();
    let help = run.run(&["simplify", "-h"]);
    let headings = [
        "Arguments:",
        "Options:",
        "Target, one of:",
        "Method:",
        "Constraints:",
        "Attributes:",
        "Files:",
        "Global options:",
    ];
    for heading in headings {
        let count = help.text().lines().filter(|line| *line == heading).count();
        assert_eq!(count, 1, "{heading} in {}", help.text());
    }
    let line = |start: &str| {
        let found = help.text().lines().position(|line| line.trim_start().starts_with(start));
        found.unwrap_or_else(|| panic!("{start} in {}", help.text()))
    };
    let order =
        ["Options:", "--measured", "Target, one of:", "-r, --ratio", "Method:", "--boundary"];
    let rest = ["Constraints:", "--fuse", "Attributes:", "--weight-uv", "Files:", "--weld"];
    assert!([order, rest].concat().windows(2).all(|pair| line(pair[0]) < line(pair[1])));
}

#[test]
fn a_quiet_run_says_only_why_it_failed() {
    let run = Run::new();
    run.sample("sphere", 500, "in.ply");
    let loud = run.run(&["simplify", "in.ply", "a.ply", "-f", "0", "--topology", "keep"]);
    assert!(loud.err.contains("warning") && !loud.out.is_empty(), "{loud:?}");
    let quiet = run.run(&["simplify", "in.ply", "b.ply", "-f", "0", "--topology", "keep", "-q"]);
    assert_eq!((quiet.code, quiet.text(), &*quiet.err), (0, "", ""));
    assert!(run.json(&["info", "in.ply", "-q"])["faces"].is_u64());
    let failed = run.run(&["info", "none.ply", "-q"]);
    assert!(failed.code == 1 && failed.only_line().contains("none.ply"), "{failed:?}");
}

#[test]
fn shells_get_a_script() {
    let run = Run::new();
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let done = run.run(&["completions", shell, "-q"]);
        assert_eq!((done.code, &*done.err), (0, ""));
        for word in ["simplify", "exact-volume"] {
            assert!(done.text().contains(word), "{shell}: {word}");
        }
    }
    assert_eq!(run.run(&["completions", "cobol"]).code, 2);
}

#[test]
fn manual_pages_are_made_of_the_help() {
    let run = Run::new();
    let page = run.run(&["man"]);
    assert!(page.code == 0 && page.text().contains(".TH meshlod"), "{page:?}");
    let written = run.run(&["man", "pages"]);
    assert_eq!(written.code, 0, "{written:?}");
    assert!(written.text().lines().count() > 20, "{written:?}");
    let simplify = std::fs::read_to_string(run.path("pages/meshlod-simplify.1")).unwrap();
    assert!(simplify.contains("Reduce a mesh to fewer faces"), "{simplify}");
    assert!(run.path("pages/meshlod.1").exists());
    std::fs::write(run.path("file"), "").unwrap();
    assert!(run.run(&["man", "file"]).only_line().contains("file: is a file"));
}
