//! Measures the change of volume of the closed parts of textured models, whose seams restrict where
//! vertices may go.

use std::path::Path;

use anyhow::Result;
use meshlod::io::{Precision, Scene};
use meshlod::mesh::Mesh;
use meshlod::samples;
use meshlod::scene::{ConditionedScene, SceneSimplifier, closed_volume, conserve_volumes};
use meshlod::simplify::{Digits, Method, Options, Target, Topology, VolumeLoss};
use meshlod::{Borders, ReadOptions, WriteOptions, read, write};

use super::RATIOS;
use crate::fixtures::{charted, in_materials};
use crate::lab::table::Table;

/// Closed models, and open ones, of which only the closed parts have a volume.
const FILES: [&str; 5] =
    ["spot.obj", "duck.glb", "pirate.obj", "fish-bream.obj", "flight-helmet/FlightHelmet.gltf"];
/// Bare meshes that get texture charts.
const BARE: &str = "igea.ply";
const METHODS: [Method; 3] = [Method::LindstromTurk, Method::KimJang, Method::LeeJang];

/// Returns a table of the relative change of volume by model, ratio and method.
pub fn section() -> Result<String> {
    let mut table = Table::new([
        "model, ratio",
        "faces",
        "lindstrom-turk",
        "owed",
        "with --exact-volume",
        "kim-jang",
        "lee-jang",
    ]);
    let folder = tempfile::tempdir()?;
    let mut open = Vec::new();
    for (name, scene) in scenes(folder.path())? {
        if closed_volume(&scene) == 0.0 {
            open.push(name);
            continue;
        }
        for ratio in RATIOS {
            let mut row = vec![format!("{name}, {:.0} %", ratio * 100.0)];
            for method in METHODS {
                let found = Measured::new(&scene, method, ratio, folder.path())?;
                if method == Method::LindstromTurk {
                    row.push(found.faces.to_string());
                }
                row.push(format!("{:.1e}", found.change));
                if method == Method::LindstromTurk {
                    row.push(format!("{:.1e}", found.owed));
                    row.push(
                        found.exact.map_or("refused".into(), |change| format!("{change:.1e}")),
                    );
                }
            }
            table.row(row);
        }
    }
    Ok(format!(
        "|ΔV| / V of the closed parts of textured models, with the topology kept, of the level as read \
         back from OBJ. *Owed* is what contractions of `lindstrom-turk` left to be repaid and the level \
         was not, by its report. To reproduce a row: `meshlod simplify MODEL out.obj --ratio R --method \
         M --topology keep --precision f64 --json`, for the column before `kim-jang` with \
         `--exact-volume`. Charts are those of `meshlod_fixtures::charted`. Without a \
         closed part: {}.\n\n{}",
        if open.is_empty() { "none".to_owned() } else { open.join(", ") },
        table.markdown()
    ))
}

/// Reads the available models, and makes the samples and the bare meshes with texture charts.
fn scenes(folder: &Path) -> Result<Vec<(String, Scene)>> {
    let fish = folder.join("fish.glb");
    let options = WriteOptions { precision: Precision::F32 };
    write(&fish, &Scene::from_mesh("fish", samples::fish(4_000)), &options)?;
    let with_charts = |mesh: &Mesh| Scene::from_mesh("charted", charted(mesh));
    let knot = samples::knot(20_000);
    let mut scenes = vec![
        ("fish (sample, .glb)".to_owned(), read(&fish, &ReadOptions::default())?),
        ("knot (sample) with charts".to_owned(), with_charts(&knot)),
        (
            "knot (sample) in six materials".to_owned(),
            Scene::from_mesh("knot", in_materials(&knot)),
        ),
    ];
    for file in FILES {
        if let Some(scene) = crate::read_scene(file)? {
            scenes.push((file.to_owned(), scene));
        }
    }
    if let Some(mesh) = crate::read(BARE)? {
        scenes.push((format!("{BARE} with charts"), with_charts(&mesh)));
    }
    Ok(scenes)
}

/// Relative changes of the volume of a level as read back from a file.
struct Measured {
    faces: usize,
    change: f64,
    /// Volume that contractions still owe after the level was repaid, by the report, relative to
    /// the whole.
    owed: f64,
    /// Change of the level of exact volume; `None` if that is refused.
    exact: Option<f64>,
}

impl Measured {
    fn new(scene: &Scene, method: Method, ratio: f64, folder: &Path) -> Result<Self> {
        let before = closed_volume(scene);
        let options = Options { method, topology: Topology::Keep, ..Options::default() };
        let ready = ConditionedScene::new(scene, &options, Borders::Stitch)?;
        let mut simplifier = SceneSimplifier::new(&ready)?;
        let report = simplifier.run(Target::Ratio(ratio), &mut ())?;
        let mut loss = VolumeLoss { ..report.volume };
        let mut meshes = simplifier.settled_level(&mut loss);
        let written = |meshes: &[Mesh]| -> Result<f64> {
            let level = through_file(scene, meshes, &folder.join("level.obj"))?;
            Ok((closed_volume(&level) - before).abs() / before)
        };
        let change = written(&meshes)?;
        // A mesh without closed parts has no volume to restore.
        let found = conserve_volumes(&ready, &mut meshes, Digits::F64);
        let is_refused = found.iter().any(|found| {
            found
                .as_ref()
                .is_err_and(|error| *error != meshlod::simplify::ExactVolumeError::OpenMesh)
        });
        let exact = if is_refused { None } else { Some(written(&meshes)?) };
        let owed = (loss.owed - loss.repaid).abs() / before;
        Ok(Self { faces: report.output_faces, change, owed, exact })
    }
}

/// Writes the meshes of a scene in double precision, with their indices as they are, and reads them
/// back.
fn through_file(scene: &Scene, meshes: &[Mesh], path: &Path) -> Result<Scene> {
    let mut scene = scene.clone();
    for (of, mesh) in scene.meshes.iter_mut().zip(meshes) {
        of.mesh = mesh.clone();
    }
    write(path, &scene, &WriteOptions { precision: Precision::F64 })?;
    Ok(read(path, &ReadOptions::default())?)
}
