//! Tests that recordings come back as they were, and that broken files are named.

use std::collections::BTreeMap;

use meshlod::flock::levels::{ChainOptions, LevelTable, Look, ModelAxes};
use meshlod::flock::select::{Budget, PolicyName, Selector};
use proptest::prelude::*;

use super::*;
use crate::scene::{Film, Scenario, ScenarioName, ScenarioOptions};

type Folder = BTreeMap<String, Vec<u8>>;

fn put(folder: &mut Folder) -> impl FnMut(&str, &[u8]) -> Result<(), ()> {
    |name, bytes| {
        assert!(folder.insert(name.into(), bytes.to_vec()).is_none(), "{name} is written twice");
        Ok(())
    }
}

fn source(folder: &Folder) -> Source<'_> {
    Source::new(|name| folder.get(name).cloned().ok_or("no such file".into()))
}

fn table() -> LevelTable {
    let options = ChainOptions { axes: ModelAxes::FISH, directions: 2, ..ChainOptions::default() };
    LevelTable::new(&meshlod::samples::fish(300), &Look::default(), &options).unwrap()
}

/// Records a scene with its levels and a selection.
fn record(name: ScenarioName) -> (Recording, LevelTable, Selection, Folder) {
    let terrain = meshlod::samples::terrain(200);
    let options = ScenarioOptions {
        members: 9,
        schools: 2,
        terrain: Some(&terrain),
        ..ScenarioOptions::default()
    };
    let mut film = Film::new(Scenario::named(name, &options).unwrap()).unwrap();
    let mut recording = Recording::new(film.scenario(), Some("fish.glb".into()));
    let mut selection = Selection::new(9);
    let table = std::sync::Arc::new(table());
    let mut selector = Selector::new(PolicyName::Ours, table.clone());
    for _ in 0..3 {
        let (flock, camera) = film.next_frame().unwrap();
        recording.push(flock, &camera);
        selection.push(selector.select(flock, &camera, &Budget::default()));
    }
    let mut folder = Folder::new();
    recording.write(put(&mut folder)).unwrap();
    write_levels(&table, put(&mut folder)).unwrap();
    selection.write(put(&mut folder)).unwrap();
    (recording, (*table).clone(), selection, folder)
}

/// Reads all that a folder holds.
fn read(folder: &Folder) -> Result<(Recording, LevelTable, Selection), RecordingError> {
    let mut source = source(folder);
    let recording = Recording::read(&mut source)?;
    let table = read_levels(&mut source)?;
    let shape = [recording.frames(), recording.scene().members];
    let selection = Selection::read(&mut source, shape, table.levels.len())?;
    Ok((recording, table, selection))
}

#[test]
fn a_recording_comes_back_as_it_was() {
    for name in ScenarioName::ALL {
        let (recording, table, selection, folder) = record(name);
        let (recording_read, table_read, selection_read) = read(&folder).unwrap();
        assert_eq!((recording.frames(), selection.frames()), (3, 3));
        assert_eq!((&selection, recording.cameras()), (&selection_read, recording_read.cameras()));
        assert_eq!(recording.flock(2), recording_read.flock(2));
        assert_eq!(format!("{table:?}"), format!("{table_read:?}"));
        let footage = recording_read.footage();
        assert_eq!(
            (footage.len(), footage.obstacles.len()),
            (3, recording.scene().obstacles.len())
        );
        // Meshes of obstacles are stored in single precision; once stored, nothing changes.
        let mut again = Folder::new();
        recording_read.write(put(&mut again)).unwrap();
        assert!(again.iter().all(|(file, bytes)| &folder[file] == bytes), "{}", name.name());
    }
}

/// Returns the error of reading a folder in which the text of a file is changed.
fn error_with(folder: &Folder, file: &str, from: &str, to: &str) -> String {
    let text = String::from_utf8(folder[file].clone()).unwrap();
    assert!(text.contains(from), "{file} has {from}: {text}");
    let mut folder = folder.clone();
    folder.insert(file.into(), text.replacen(from, to, 1).into());
    read(&folder).map(drop).expect_err(to).to_string()
}

#[test]
fn descriptions_that_do_not_fit_are_refused() {
    let (_, table, _, folder) = record(ScenarioName::Obstacles);
    let levels = table.levels.len();
    let cases = [
        ("scene.json", "\"version\": 1", "\"version\": 2", "version 2"),
        ("scene.json", "\"members\": 9", "\"members\": 0", "at least one"),
        ("scene.json", "\"members\": 9", "\"members\": 8", "school 1"),
        (
            "scene.json",
            "\"members\": 9",
            "\"members\": 987654321012345",
            "positions.npy: its shape",
        ),
        ("scene.json", "\"frames\": 3", "\"frames\": 1000000000000000000", "its shape"),
        ("scene.json", "\"first\": 5", "\"first\": 4", "school 1"),
        ("scene.json", "\"first\": 5", "\"first\": 18446744073709551615", "school 1"),
        ("scene.json", "\"radius\": ", "\"radius\": -", "obstacle 0"),
        ("scene.json", "\"radius\": ", "\"radius\": 1e39, \"was\": ", "scene.json: "),
        ("scene.json", "\"seconds_per_frame\": 0", "\"seconds_per_frame\": -1", "seconds"),
        ("scene.json", "{", "[", "scene.json: "),
        ("cameras.json", "\"fov_rad\":0", "\"fov_rad\":9", "camera 0: "),
        ("cameras.json", "\"up\":[", "\"up\":[0, 0, 0],\"was\":[", "camera 0: `up`"),
        ("cameras.json", "\"forward\":[", "\"forward\":[9, 0, 0],\"was\":[", "`forward`"),
        ("cameras.json", "\"eye\":[", "\"eye\":[null, 0, 0],\"was\":[", "cameras.json: "),
        ("levels.json", "\"side\":2", "\"side\":33", "facing 0: `side` is 33"),
        ("levels.json", "\"side\":2", "\"side\":3", "facing 0: it must have 9 levels"),
        ("levels.json", "\"facing\":[{", "\"facing\":[], \"was\":[{", "facing: "),
        ("levels.json", "\"whole\"", "\"left-coarsened\"", "chains: they must be"),
        ("levels.json", "\"levels\":", "\"levels\":1000000", "chain 0"),
        ("levels.json", "\"first_level\":0", "\"first_level\":1", "chain 0"),
        ("levels.json", "\"first_triangle\":0", "\"first_triangle\":99999999", "level 0"),
        ("levels.json", "\"error\":0", "\"error\":-1", "its error must be"),
        ("levels.json", "\"normal\"", "\"uv\"", "its shape"),
        ("levels.json", "layer_0.npy", "../layer_0.npy", "not a file name"),
        ("levels.json", "layer_0.npy", "missing.npy", "missing.npy: no such file"),
    ];
    for (file, from, to, reason) in cases {
        let error = error_with(&folder, file, from, to);
        assert!(error.contains(reason) && !error.contains('\n'), "{to}: {error}");
    }
    assert!(levels > 20);
}

#[test]
fn arrays_that_do_not_fit_are_refused() {
    let (_, table, _, folder) = record(ScenarioName::Terrain);
    let levels = table.levels.len() as u16;
    let with = |file: &str, change: &dyn Fn(&mut Vec<u8>)| {
        let mut folder = folder.clone();
        change(folder.get_mut(file).unwrap());
        read(&folder).map(drop).expect_err(file).to_string()
    };
    // The first value begins at byte 128.
    let set = |at: usize, value: f32| {
        move |bytes: &mut Vec<u8>| bytes[128 + 4 * at..][..4].copy_from_slice(&value.to_le_bytes())
    };
    let set_index = |at: usize| {
        move |bytes: &mut Vec<u8>| bytes[128 + 4 * at..][..4].copy_from_slice(&[0, 0, 1, 0])
    };
    let cases = [
        with("positions.npy", &set(3 * 9 + 4, f32::NAN)),
        with("headings.npy", &set(3 * 9 + 4, 3.0)),
        with("speeds.npy", &set(9 + 1, f32::INFINITY)),
        with("leaders.npy", &set(6 * 2 + 6, f32::NAN)),
        with("vertices.npy", &set(5, f32::NAN)),
        with("triangles.npy", &set_index(5)),
        with("layer_0.npy", &set(5, f32::INFINITY)),
        with("differences.npy", &set(5, f32::NAN)),
        with("obstacle_0_vertices.npy", &set(5, f32::NAN)),
        with("obstacle_0_triangles.npy", &set_index(5)),
        with("selection.npy", &|bytes| bytes[130..132].copy_from_slice(&levels.to_le_bytes())),
        with("positions.npy", &|bytes| bytes.truncate(200)),
        with("selection.npy", &|bytes| bytes.truncate(20)),
        with("headings.npy", &|bytes| bytes.clear()),
    ];
    let reasons = [
        "positions.npy: frame 1, member 1: a position must be finite",
        "headings.npy: frame 1, member 1: a heading must be a unit vector",
        "speeds.npy: frame 1, member 1: a speed",
        "leaders.npy: frame 1, leader 1: it must have a finite position",
        "vertices.npy: entry 1: ",
        "triangles.npy: triangle 1: vertex 65536 is not one of",
        "layer_0.npy: entry 1: ",
        "differences.npy: entry 0: ",
        "obstacle_0_triangles.npy: obstacle_0_vertices.npy: vertex",
        "obstacle_0_triangles.npy: obstacle_0_vertices.npy: face",
        "selection.npy: frame 0, member 1: level",
        "positions.npy: the header announces 324 bytes of values, but 72 follow",
        "selection.npy: the file ends within its header",
        "headings.npy: not a .npy file",
    ];
    for (error, reason) in cases.iter().zip(reasons) {
        assert!(error.starts_with(reason), "{error} for {reason}");
    }
    for file in folder.keys() {
        let mut less = folder.clone();
        less.remove(file);
        let error = read(&less).map(drop).expect_err(file);
        assert_eq!(error.to_string(), format!("{file}: no such file"));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn no_folder_makes_reading_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        static FOLDER: std::sync::LazyLock<Folder> =
            std::sync::LazyLock::new(|| record(ScenarioName::Obstacles).3);
        let mut folder = FOLDER.clone();
        for (file, at, byte) in changes {
            let (_, bytes) = folder.iter_mut().nth(file.index(FOLDER.len())).unwrap();
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if let Err(error) = read(&folder) {
            prop_assert!(!error.to_string().contains('\n'));
        }
    }
}
