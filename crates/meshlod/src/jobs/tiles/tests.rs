//! Tests of tilesets that are made whole, and of plans whose tasks are done one by one.

use std::collections::BTreeMap;

use meshlod_samples as samples;
use meshlod_tiles::source::SceneSource;

use super::*;
use crate::Scene;

fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(at) = folders.pop() {
        for entry in fs::read_dir(&at).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().display().to_string();
                all.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    all
}

fn knot() -> SceneSource {
    SceneSource::new(Scene::from_mesh("knot", samples::knot(20_000)))
}

#[test]
fn tasks_one_by_one_make_the_same_files() {
    let (folder, other) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let (source, look) = (knot(), Look::default());
    let input = TileInput { source: &source, look: &look, key: "knot" };
    let request = TilesRequest { tile_faces: 2_000, ..TilesRequest::default() };
    let report = tiles(input, folder.path(), &request, &()).unwrap();
    assert_eq!(report.unchanged_tiles, 0);
    assert!(
        report
            .levels
            .windows(2)
            .all(|pair| pair[0].faces < pair[1].faces
                && pair[0].error_proved >= pair[1].error_proved)
    );

    let found = check_tileset(folder.path(), &()).unwrap();
    assert_eq!((found.tiles, &found.findings[..]), (report.tiles, &[][..]));

    let plan = other.path().join("plan");
    let tasks = plan_tiles(input, &plan, &request, &()).unwrap();
    assert_eq!(tasks, report.tiles);
    let early = run_tile_task(&plan, tasks - 1).unwrap_err();
    assert!(early.to_string().contains("is not done"), "{early}");
    (0..tasks).for_each(|task| run_tile_task(&plan, task).unwrap());
    let out = other.path().join("out");
    assert_eq!(finish_tiles(&plan, &out, &()).unwrap(), report);
    assert_eq!(files(&out), files(folder.path()));
}

#[test]
fn steps_that_were_ended_or_spoilt_go_on() {
    let folder = tempfile::tempdir().unwrap();
    let (source, look) = (knot(), Look::default());
    let input = TileInput { source: &source, look: &look, key: "knot" };
    let request = TilesRequest { tile_faces: 2_000, ..TilesRequest::default() };
    let [plan, whole, out] = ["plan", "whole", "out"].map(|name| folder.path().join(name));
    let expected = tiles(input, &whole, &request, &()).unwrap();

    plan_tiles(input, &plan, &request, &()).unwrap();
    let opened = TilePlan::open(&plan).unwrap();
    let root = opened.tasks() - 1;
    (0..root).for_each(|task| opened.run(task).unwrap());
    assert!(opened.is_done(root - 1) && !opened.is_done(root));
    // Meshes that the root needs: one is cut off, another and its parts are gone.
    let meshes = opened.parts(root);
    let mesh =
        |task: usize| plan.join("tiles").join(format!("{}.mesh", opened.plan.cell(task).unwrap()));
    let whole_mesh = fs::read(mesh(meshes[0])).unwrap();
    fs::write(mesh(meshes[0]), &whole_mesh[..whole_mesh.len() / 2]).unwrap();
    fs::remove_file(mesh(meshes[1])).unwrap();
    opened.forget_parts(meshes[1]);
    opened.run(root).unwrap();
    assert_eq!(fs::read(mesh(meshes[0])).unwrap(), whole_mesh);

    // What a process that was killed leaves does not get into the tileset.
    fs::write(plan.join("content/.0-0-0-0.glb.1-0"), "half").unwrap();
    for _ in 0..2 {
        assert_eq!(assemble_tiles(&plan, &out, &()).unwrap(), expected);
        assert_eq!(files(&out), files(&whole));
    }
    remove_tile_plan(&plan);
    assert!(!plan.exists());
}

#[test]
fn planning_ends_where_it_is_cancelled() {
    struct Impatient;
    impl Watch for Impatient {
        fn is_cancelled(&self) -> bool {
            true
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let (source, look) = (knot(), Look::default());
    let input = TileInput { source: &source, look: &look, key: "knot" };
    let plan = folder.path().join("plan");
    let ended = plan_tiles(input, &plan, &TilesRequest::default(), &Impatient).unwrap_err();
    assert!(matches!(ended, JobError::Cancelled), "{ended}");
    assert_eq!(files(&plan).into_keys().collect::<Vec<_>>(), ["lock"]);
}

#[test]
fn a_tile_that_was_changed_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let (source, look) = (knot(), Look::default());
    let input = TileInput { source: &source, look: &look, key: "knot" };
    let request = TilesRequest { tile_faces: 2_000, plain: true, ..TilesRequest::default() };
    tiles(input, folder.path(), &request, &()).unwrap();
    let tiles = folder.path().join(TILES);
    let [one, other] = ["1-0-0-0.glb", "1-1-0-0.glb"].map(|name| tiles.join(name));
    fs::copy(&one, &other).unwrap();
    let findings = check_tileset(folder.path(), &()).unwrap().findings;
    assert!(findings.iter().any(|finding| finding.contains("do not meet")), "{findings:?}");
    fs::write(&other, b"glTF").unwrap();
    let findings = check_tileset(folder.path(), &()).unwrap().findings;
    assert!(findings.iter().any(|finding| finding.contains("1-1-0-0.glb")), "{findings:?}");
}

#[test]
fn what_has_no_extent_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let mut mesh = samples::torus(100);
    mesh.positions.fill([1.0; 3]);
    let source = SceneSource::new(Scene::from_mesh("point", mesh));
    let look = Look::default();
    let input = TileInput { source: &source, look: &look, key: "point" };
    let out = folder.path().join("out");
    let error = tiles(input, &out, &TilesRequest::default(), &()).unwrap_err();
    assert!(error.to_string().contains("no extent") && !out.exists(), "{error}");
}
