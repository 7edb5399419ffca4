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

    let plan = other.path().join("plan");
    let tasks = plan_tiles(input, &plan, &request, &()).unwrap();
    assert_eq!(tasks, report.tiles);
    let early = run_tile_task(&plan, tasks - 1).unwrap_err();
    assert!(early.to_string().contains("is not done"), "{early}");
    (0..tasks).for_each(|task| run_tile_task(&plan, task).unwrap());
    let out = other.path().join("out");
    assert_eq!(finish_tiles(&plan, &out, &()).unwrap(), report);
    assert_eq!(
        files(&out),
        files(folder.path()).into_iter().filter(|(name, _)| !name.starts_with(".plan")).collect()
    );
}
