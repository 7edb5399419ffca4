//! Tests of tilesets that are made whole, and of plans whose tasks are done one by one.

use meshlod_fixtures::folder_files as files;
use meshlod_samples as samples;
use meshlod_tiles::source::SceneSource;

use super::result::TILES;
use super::*;
use crate::Scene;

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
    let tasks = plan_tiles(input, PlanFolder::new(&plan), &request, &()).unwrap();
    assert_eq!(tasks, report.tiles);
    let early = run_tile_task(&plan, tasks - 1).unwrap_err();
    assert!(early.to_string().contains("is not done"), "{early}");
    (0..tasks).for_each(|task| run_tile_task(&plan, task).unwrap());
    // As of a process that was killed.
    fs::write(plan.join("content/.0-0-0-0.glb.4194305-0"), "glTF").unwrap();
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

    plan_tiles(input, PlanFolder::new(&plan), &request, &()).unwrap();
    let opened = TilePlan::open(&plan).unwrap();
    let root = opened.tasks() - 1;
    (0..root).for_each(|task| opened.run(task).unwrap());
    assert!(opened.is_done(root - 1).unwrap() && !opened.is_done(root).unwrap());
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
        assert_eq!(assemble_tiles(PlanFolder::new(&plan), &out, &()).unwrap(), expected);
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
    let ended = plan_tiles(input, PlanFolder::new(&plan), &TilesRequest::default(), &Impatient)
        .unwrap_err();
    assert!(matches!(ended, JobError::Cancelled), "{ended}");
    assert!(!plan.exists());
}

#[test]
fn open_edges_across_the_corners_of_tiles_are_not_cracks() {
    // Its sides are on those of the whole, and it crosses planes of two axes in almost one place.
    let mut mesh = samples::terrain(8_000);
    mesh.positions.iter_mut().for_each(|at| at[2] = 1.001 * at[1]);
    let source = SceneSource::new(Scene::from_mesh("plane", mesh));
    let (folder, look) = (tempfile::tempdir().unwrap(), Look::default());
    let input = TileInput { source: &source, look: &look, key: "plane" };
    let request = TilesRequest { tile_faces: 200, ..TilesRequest::default() };
    tiles(input, folder.path(), &request, &()).unwrap();
    assert_eq!(check_tileset(folder.path(), &()).unwrap().findings, [""; 0]);
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
fn a_transform_that_was_changed_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let (source, look) = (knot(), Look::default());
    let input = TileInput { source: &source, look: &look, key: "knot" };
    let request = TilesRequest { tile_faces: 2_000, ..TilesRequest::default() };
    tiles(input, folder.path(), &request, &()).unwrap();
    let path = folder.path().join("tileset.json");
    let whole: serde_json::Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    for (pointer, expected) in [("/root", "tileset.json"), ("/root/children/0", "1-")] {
        let mut changed = whole.clone();
        changed.pointer_mut(pointer).unwrap()["transform"][0] = 2.into();
        fs::write(&path, changed.to_string()).unwrap();
        let findings = check_tileset(folder.path(), &()).unwrap().findings;
        let [finding] = &findings[..] else { panic!("{pointer}: {findings:?}") };
        assert!(finding.contains(expected) && finding.contains("transform"), "{finding}");
    }
    let mut moved = whole.clone();
    moved["root"]["children"][0]["transform"][13] = 3.5.into();
    fs::write(&path, moved.to_string()).unwrap();
    assert!(!check_tileset(folder.path(), &()).unwrap().findings.is_empty());
    fs::write(&path, whole.to_string()).unwrap();
    assert_eq!(check_tileset(folder.path(), &()).unwrap().findings, [""; 0]);
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

/// Changes a file by `change` for as long as `work` runs.
fn with_changed<T>(path: &Path, change: fn(&mut Vec<u8>), work: impl FnOnce() -> T) -> T {
    let old = fs::read(path).unwrap();
    let mut new = old.clone();
    change(&mut new);
    fs::write(path, new).unwrap();
    let done = work();
    fs::write(path, old).unwrap();
    done
}

#[test]
fn files_that_were_changed_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let (source, look) = (knot(), Look::default());
    let input = TileInput { source: &source, look: &look, key: "knot" };
    let request = TilesRequest { tile_faces: 2_000, ..TilesRequest::default() };
    let plan = folder.path().join("plan");
    let tasks = plan_tiles(input, PlanFolder::new(&plan), &request, &()).unwrap();
    (0..tasks).for_each(|task| run_tile_task(&plan, task).unwrap());
    let out = folder.path().join("out");
    let root = tasks - 1;
    let known = Folder::new(&plan).plan().unwrap().unwrap();
    let leaf = known.cell(0).unwrap();
    let part = known.cell(root - 1).unwrap();
    let record = |cell: meshlod_tiles::Cell| plan.join(format!("tiles/{cell}.json"));
    let task = |task: usize, cell| {
        // A task that is done reads nothing.
        fs::remove_file(record(cell)).unwrap();
        run_tile_task(&plan, task)
    };
    let leaf_again = || task(0, leaf);
    let root_again = || task(root, known.cell(root).unwrap());
    let finish = || finish_tiles(&plan, &out, &()).map(drop);
    let again = || run_tile_task(&plan, 0);
    type Work<'a> = &'a dyn Fn() -> Result<(), JobError>;
    let cases: [(_, Work<'_>, &str); 4] = [
        (plan.join("plan.json"), &again, "plan.json: is cut off or changed; remove"),
        (plan.join("blocks"), &leaf_again, "blocks: is cut off or changed; remove"),
        (plan.join("pieces"), &leaf_again, "pieces: is c"),
        (plan.join(format!("content/{part}.glb")), &finish, ".glb: is cut off or changed; do task"),
    ];
    let changes: [fn(&mut Vec<u8>); 3] = [
        // So little that none of what a task reads is left.
        |bytes| bytes.truncate(20),
        |bytes| bytes.clear(),
        |bytes| bytes.iter_mut().for_each(|byte| *byte ^= 4),
    ];
    for (path, work, expected) in cases {
        for change in changes {
            let error = with_changed(&path, change, work).unwrap_err().to_string();
            assert!(error.contains(expected) && !error.contains('\n'), "{expected}: {error}");
            [0, root].into_iter().for_each(|task| run_tile_task(&plan, task).unwrap());
        }
    }
    // Files of a part are made anew by the task that needs them.
    for path in [plan.join(format!("tiles/{part}.mesh")), record(part)] {
        let expected = fs::read(&path).unwrap();
        for change in changes {
            let mut bytes = expected.clone();
            change(&mut bytes);
            fs::write(&path, bytes).unwrap();
            root_again().unwrap();
            assert_eq!(fs::read(&path).unwrap(), expected);
        }
    }
    assert!(!out.exists());
    finish().unwrap();
    assert_eq!(check_tileset(&out, &()).unwrap().findings, [""; 0]);
}

#[test]
fn a_plan_is_changed_by_one_process_at_a_time() {
    let folder = tempfile::tempdir().unwrap();
    let (source, look) = (knot(), Look::default());
    let input = TileInput { source: &source, look: &look, key: "knot" };
    let request = TilesRequest { tile_faces: 2_000, ..TilesRequest::default() };
    let [plan, out, whole] = ["plan", "out", "whole"].map(|name| folder.path().join(name));
    let tasks = plan_tiles(input, PlanFolder::new(&plan), &request, &()).unwrap();
    let busy = |done: Result<(), JobError>| {
        done.unwrap_err().to_string().contains("another process is making tiles here")
    };
    let replan = || plan_tiles(input, PlanFolder::new(&plan), &request, &()).map(drop);
    let finish = || finish_tiles(&plan, &out, &()).map(drop);
    let held = Folder::new(&plan);
    let alone = PlanFolder::new(&plan);
    let hold = Hold::alone(alone).unwrap();
    assert!(busy(replan()) && busy(finish()) && busy(run_tile_task(&plan, 0)));
    drop(hold);
    let hold = Hold::shared(&held).unwrap();
    assert!(busy(replan()) && busy(finish()));
    // Each of these does all tasks, at the same time as the others.
    std::thread::scope(|scope| {
        for _ in 0..3 {
            scope.spawn(|| (0..tasks).for_each(|task| run_tile_task(&plan, task).unwrap()));
        }
    });
    drop(hold);
    finish().unwrap();
    assert!(!plan.exists());
    tiles(input, &whole, &request, &()).unwrap();
    assert_eq!(files(&out), files(&whole));
}

#[test]
fn a_run_has_its_folder_between_its_steps() {
    let folder = tempfile::tempdir().unwrap();
    let (source, look) = (knot(), Look::default());
    let input = TileInput { source: &source, look: &look, key: "knot" };
    let request = TilesRequest { tile_faces: 4_000, ..TilesRequest::default() };
    let [plan, out] = ["plan", "out"].map(|name| folder.path().join(name));
    let run = TileRun::begin(&plan).unwrap();
    let key = run.key().to_owned();
    let own = PlanFolder::of_run(&plan, &key);
    let refused = || {
        let plan_it = |place| plan_tiles(input, place, &request, &()).map(drop);
        let all = [
            TileRun::begin(&plan).map(drop),
            plan_it(PlanFolder::new(&plan)),
            plan_it(PlanFolder::of_run(&plan, "another")),
            finish_tiles(&plan, &out, &()).map(drop),
        ];
        let busy = "another process is making tiles here";
        all.into_iter().all(|done| done.is_err_and(|error| error.to_string().contains(busy)))
    };
    assert!(refused());
    let tasks = plan_tiles(input, own, &request, &()).unwrap();
    remove_tile_plan(&plan);
    assert!(refused());
    (0..tasks).for_each(|task| run_tile_task(&plan, task).unwrap());
    assemble_tiles(own, &out, &()).unwrap();
    assert!(refused());
    run.remove();
    assert!(!plan.exists() && check_tileset(&out, &()).unwrap().findings.is_empty());

    // Without a plan nothing is left of a run, and with one the next may go on.
    drop(TileRun::begin(&plan).unwrap());
    assert!(!plan.exists());
    let run = TileRun::begin(&plan).unwrap();
    plan_tiles(input, PlanFolder::of_run(&plan, run.key()), &request, &()).unwrap();
    drop(run);
    assert!(TilePlan::open(&plan).is_ok());
    finish_tiles(&plan, &out, &()).unwrap_err();
    plan_tiles(input, PlanFolder::new(&plan), &request, &()).unwrap();
}

#[test]
fn files_that_cannot_be_read_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let (source, look) = (knot(), Look::default());
    let input = TileInput { source: &source, look: &look, key: "knot" };
    let request = TilesRequest { tile_faces: 4_000, ..TilesRequest::default() };
    let plan = folder.path().join("plan");
    plan_tiles(input, PlanFolder::new(&plan), &request, &()).unwrap();
    run_tile_task(&plan, 0).unwrap();
    let opened = TilePlan::open(&plan).unwrap();
    for inner in ["tiles", "content"] {
        // A folder in place of a file is there and cannot be read.
        let is_read = |path: &Path| path.extension().is_some_and(|kind| kind != "mesh");
        let mut entries =
            fs::read_dir(plan.join(inner)).unwrap().map(|entry| entry.unwrap().path());
        let path = entries.find(|path| is_read(path)).unwrap();
        let bytes = fs::read(&path).unwrap();
        fs::remove_file(&path).unwrap();
        assert!(!opened.is_done(0).unwrap());
        if inner == "tiles" {
            fs::create_dir(&path).unwrap();
            let name = format!("{}: ", path.display());
            let error = opened.is_done(0).unwrap_err().to_string();
            assert!(error.starts_with(&name), "{error}");
            assert_eq!(run_tile_task(&plan, 0).unwrap_err().to_string(), error);
            fs::remove_dir(&path).unwrap();
        }
        fs::write(&path, bytes).unwrap();
        assert!(opened.is_done(0).unwrap());
    }
}

#[test]
fn a_plan_on_another_disk_is_finished() {
    let memory = Path::new("/dev/shm");
    let folder = tempfile::tempdir().unwrap();
    if !memory.is_dir() || fs::rename(folder.path(), memory.join("meshlod-rename")).is_ok() {
        let _ = fs::remove_dir_all(memory.join("meshlod-rename"));
        println!("skipped: no second disk");
        return;
    }
    let other = tempfile::tempdir_in(memory).unwrap();
    let (source, look) = (knot(), Look::default());
    let input = TileInput { source: &source, look: &look, key: "knot" };
    let request = TilesRequest { tile_faces: 4_000, ..TilesRequest::default() };
    let (plan, out) = (other.path().join("plan"), folder.path().join("out"));
    let tasks = plan_tiles(input, PlanFolder::new(&plan), &request, &()).unwrap();
    (0..tasks).for_each(|task| run_tile_task(&plan, task).unwrap());
    finish_tiles(&plan, &out, &()).unwrap();
    assert!(!plan.exists());
    assert_eq!(check_tileset(&out, &()).unwrap().tiles, tasks);
    assert_eq!(fs::read_dir(&out).unwrap().count(), 2);
}

#[test]
fn coordinates_about_the_middle_of_the_earth_stay_there() {
    let folder = tempfile::tempdir().unwrap();
    let middle = [4_010_000.5, 610_000.25, 4_905_000.125];
    let mut mesh = samples::knot(4_000);
    for at in &mut mesh.positions {
        *at = [0, 1, 2].map(|axis| middle[axis] + 50.0 * at[axis]);
    }
    let bounds = mesh.bounds();
    let source = SceneSource::new(Scene::from_mesh("knot", mesh));
    let look = Look::default();
    let input = TileInput { source: &source, look: &look, key: "knot" };
    let request = TilesRequest { tile_faces: 1_000, ecef: true, ..TilesRequest::default() };
    tiles(input, folder.path(), &request, &()).unwrap();
    assert_eq!(check_tileset(folder.path(), &()).unwrap().findings, [""; 0]);
    let text = fs::read(folder.path().join("tileset.json")).unwrap();
    let root = &serde_json::from_slice::<serde_json::Value>(&text).unwrap()["root"];
    let numbers = |value: &serde_json::Value| -> Vec<f64> {
        value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
    };
    let (to, around) = (numbers(&root["transform"]), numbers(&root["boundingVolume"]["box"]));
    assert_eq!(to[..12], [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    for axis in 0..3 {
        let center = to[12 + axis] + around[axis];
        let half = around[3 + 4 * axis];
        // Skirts and simplification move the sides of the box by little.
        assert!((center - half - bounds.min[axis]).abs() < 2.0, "{around:?}");
        assert!((center + half - bounds.max[axis]).abs() < 2.0, "{around:?}");
    }
    let globe = Some(Globe { latitude: 1.0, longitude: 2.0, altitude: 0.0 });
    let both = TilesRequest { globe, ..request };
    assert!(tiles(input, folder.path(), &both, &()).is_err());
}

#[test]
fn files_of_others_inside_are_told_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let (source, look) = (knot(), Look::default());
    let input = TileInput { source: &source, look: &look, key: "knot" };
    let request = TilesRequest { tile_faces: 20_000, ..TilesRequest::default() };
    tiles(input, &out, &request, &()).unwrap();
    check_tiles_folder(&out).unwrap();
    let before = files(&out);
    fs::write(out.join("tiles/wall.png"), "png").unwrap();
    let error = tiles(input, &out, &request, &()).unwrap_err().to_string();
    assert!(error.contains("its folder tiles holds other files"), "{error}");
    fs::remove_file(out.join("tiles/wall.png")).unwrap();
    assert_eq!(files(&out), before);
    for inner in ["content", "tiles"] {
        let plan = folder.path().join(inner);
        fs::create_dir_all(plan.join(inner)).unwrap();
        fs::write(plan.join(inner).join("wall.png"), "png").unwrap();
        let error =
            plan_tiles(input, PlanFolder::new(&plan), &request, &()).unwrap_err().to_string();
        assert!(error.contains("holds other files"), "{error}");
        assert_eq!(files(&plan).len(), 1);
    }
}

#[test]
fn an_obj_file_in_passing_gives_the_bytes_of_one_read_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    let scene = Scene::from_mesh("knot", samples::knot(20_000));
    crate::write(&path, &scene, &crate::WriteOptions::default()).unwrap();
    let text = fs::read_to_string(&path).unwrap();
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let faces: Vec<usize> = (0..lines.len()).filter(|&at| lines[at].starts_with("f ")).collect();
    for (number, &at) in faces.iter().enumerate() {
        let material = if number % 3_000 == 0 {
            ["usemtl a\r\n", "usemtl b\r\n"][number / 3_000 % 2]
        } else {
            ""
        };
        let uvs = if number % 5 == 0 {
            lines[at].clone()
        } else {
            let corners =
                lines[at].split(' ').skip(1).map(|corner| format!("{corner}/{}", number % 3 + 1));
            format!("f {}", corners.collect::<Vec<_>>().join(" \\\r\n "))
        };
        lines[at] = format!("{material}{uvs}");
    }
    let head = "mtllib a.mtl\r\nvt 0 0\r\nvt 1 0\r\nvt .5 1\r\n";
    fs::write(&path, head.to_owned() + &lines.join("\r\n")).unwrap();
    fs::write(folder.path().join("a.mtl"), "newmtl b\nKd 1 0 0\nnewmtl a\nKd 0 1 0\n").unwrap();

    let whole = crate::read(&path, &crate::ReadOptions::default()).unwrap();
    let streamed = meshlod_tiles::source::open_stream(&path, 0, folder.path()).unwrap().unwrap();
    let request = TilesRequest { tile_faces: 2_000, ..TilesRequest::default() };
    let make = |name: &str, source: &dyn Source, look: Look| {
        let out = folder.path().join(name);
        let input = TileInput { source, look: &look, key: "a" };
        tiles(input, &out, &request, &()).unwrap();
        files(&out)
    };
    let look = model::look(&whole);
    let expected = make("whole", &SceneSource::new(whole), look);
    let look = model::look(streamed.scene.as_ref().unwrap());
    assert_eq!(make("streamed", &*streamed.source, look), expected);
}
