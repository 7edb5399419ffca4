//! Multiresolution files that are damaged, cut short or none at all.

use crate::models::{
    CAMERA, TORUS, bytes, extract, number, pieces, refused, terrain, torus, write,
};
use crate::run::Run;

/// Runs every verb that reads such files; all must refuse it.
fn refused_by_all(run: &Run, input: &str) -> Vec<String> {
    let verbs: [&[&str]; 3] = [
        &["check", input],
        &["extract", input, "out.ply", "--error", "0"],
        &["extract", input, "out.ply", "--faces", "500", "--camera", CAMERA],
    ];
    let lines = verbs.map(|arguments| {
        let done = refused(run, arguments, 1);
        assert!(done.only_line().starts_with(&format!("meshlod: {input}: ")), "{done:?}");
        done.only_line().to_owned()
    });
    lines.to_vec()
}

#[test]
fn a_file_that_is_none_is_1_and_one_line() {
    let run = Run::new();
    run.sample("torus", 100, "in.ply");
    let mesh = bytes(&run, "in.ply");
    write(&run, "mesh.mlod", &mesh);
    write(&run, "empty.mlod", b"");
    write(&run, "magic.mlod", b"meshlodm");
    write(&run, "field.mlod", b"meshlodh");
    write(&run, "zeros.mlod", &[0; 4096]);
    std::fs::create_dir(run.path("folder.mlod")).unwrap();
    for name in ["mesh.mlod", "empty.mlod", "magic.mlod", "field.mlod", "zeros.mlod", "folder.mlod"]
    {
        refused_by_all(&run, name);
    }
    refused_by_all(&run, "absent.mlod");
    // A mesh is told by its suffix, before it is read.
    write(&run, "mesh.ply", &mesh);
    let done = refused(&run, &["extract", "mesh.ply", "out.ply", "--error", "0"], 1);
    assert!(done.only_line().contains("meshlod build mesh.ply mesh.mlod"), "{done:?}");
}

#[test]
fn a_file_of_another_version_says_so() {
    let run = Run::new();
    torus(&run);
    terrain(&run, 200);
    for name in ["torus.mlod", "terrain.mlod"] {
        let mut later = bytes(&run, name);
        later[8] = 77;
        write(&run, "later.mlod", &later);
        let lines = refused_by_all(&run, "later.mlod");
        assert!(lines.iter().all(|line| line.contains("version 77")), "{lines:?}");
    }
}

#[test]
fn a_file_without_its_coarsest_mesh_is_refused() {
    let run = Run::new();
    torus(&run);
    let whole = bytes(&run, "torus.mlod");
    let pieces = pieces(&whole);
    for end in [9, 40, 87, 89, pieces[0].end, pieces[1].end - 1] {
        write(&run, "short.mlod", &whole[..end]);
        let lines = refused_by_all(&run, "short.mlod");
        assert!(lines[0].contains(&format!("truncated at byte {end}")), "{lines:?}");
    }
}

#[test]
fn what_is_there_of_a_file_is_a_mesh() {
    let run = Run::new();
    torus(&run);
    let whole = bytes(&run, "torus.mlod");
    let pieces = pieces(&whole);
    let last = pieces.len() - 1;
    let mut faces = 0;
    for end in [pieces[1].end, pieces[2].end, pieces[3].end + 9, pieces[last].end - 1] {
        write(&run, "part.mlod", &whole[..end]);
        let whole_chunks = pieces[2..].iter().filter(|piece| piece.end <= end).count();
        let told = format!("{whole_chunks} of its {} chunks are present", last - 1);
        for arguments in [&["--error", "0"][..], &["--faces", "100000", "--camera", CAMERA]] {
            let done = run.run(&[&["extract", "part.mlod", "a.ply", "--json"], arguments].concat());
            assert!(done.code == 0 && done.only_line().contains(&told), "{done:?}");
            assert_eq!(run.json(&["info", "a.ply"])["closed"], true);
            let found = number(&done.json()["faces"]);
            assert!(found >= faces, "{found} after {faces}");
            faces = found;
        }
        let done = run.run(&["check", "part.mlod", "--json"]);
        assert!(done.code == 0 && done.only_line().contains(&told), "{done:?}");
        assert_eq!(
            (&done.json()["faces"], &done.json()["chunks_there"]),
            (&faces.into(), &whole_chunks.into())
        );
        let missing = last - 1 - whole_chunks;
        let proof = run.run(&["check", "part.mlod"]);
        let unproved = format!("nothing is proved of the {missing} that ");
        assert!(proof.text().contains(&unproved), "{proof:?}");
    }
    assert!(!run.run(&["check", "torus.mlod"]).text().contains("nothing is proved"));
    assert!(faces < TORUS);
    write(&run, "longer.mlod", &[&whole[..], b"!"].concat());
    let lines = refused_by_all(&run, "longer.mlod");
    assert!(lines[0].contains("unexpected data after the last chunk"), "{lines:?}");
}

#[test]
fn a_damaged_piece_is_named() {
    let run = Run::new();
    torus(&run);
    let whole = bytes(&run, "torus.mlod");
    for (i, piece) in pieces(&whole).into_iter().enumerate() {
        let mut wrong = whole.clone();
        // Not in the first words, which have their own errors.
        let at = if i == 0 { piece.end - 10 } else { (piece.start + piece.end) / 2 };
        wrong[at] ^= 0x10;
        write(&run, "wrong.mlod", &wrong);
        let what = match i {
            0 => "the header".to_owned(),
            1 => "the coarsest mesh".to_owned(),
            chunk => format!("chunk {}", chunk - 2),
        };
        let lines = refused_by_all(&run, "wrong.mlod");
        let told = format!("the checksum of {what} does not match");
        assert!(lines.iter().all(|line| line.contains(&told)), "{lines:?}");
    }
    // Damage in parts that are not read goes unnoticed.
    let mut wrong = whole.clone();
    *wrong.last_mut().unwrap() ^= 1;
    write(&run, "wrong.mlod", &wrong);
    assert!(
        number(
            &extract(&run, "wrong.mlod", "a.ply", &["--error", "100%", "--unverified"])["faces"]
        ) > 0
    );
}

#[test]
fn a_height_field_that_is_damaged_is_refused() {
    let run = Run::new();
    terrain(&run, 200);
    let whole = bytes(&run, "terrain.mlod");
    for at in [0, 9, 13, 17, 30, 60, 90, whole.len() - 1] {
        let mut wrong = whole.clone();
        wrong[at] ^= 0x40;
        write(&run, "wrong.mlod", &wrong);
        refused_by_all(&run, "wrong.mlod");
    }
    for end in [9, 16, 50, 90] {
        write(&run, "short.mlod", &whole[..end]);
        refused_by_all(&run, "short.mlod");
    }
}

#[test]
fn a_mesh_that_could_not_be_taken_leaves_the_old_one() {
    let run = Run::new();
    torus(&run);
    let before = bytes(&run, "torus.ply");
    let mut wrong = bytes(&run, "torus.mlod");
    *wrong.last_mut().unwrap() ^= 1;
    write(&run, "wrong.mlod", &wrong);
    refused(&run, &["extract", "wrong.mlod", "torus.ply", "--error", "0"], 1);
    assert_eq!(bytes(&run, "torus.ply"), before);
}
