//! Measures how long files take to be read, with attributes and without.
//!
//! `cargo run --release -p meshlod-multires --example read_cost [MESH…]`; the default is the shared
//! models with textures. Each mesh of a scene has a file of its own. The figures are the processor's
//! time of one thread, the best of some rounds.

use std::error::Error;
use std::path::{Path, PathBuf};

use cpu_time::ThreadTime;
use meshlod_io::ReadOptions;
use meshlod_mesh::Mesh;
use meshlod_multires::{Archive, Forest, Query, Storage};
use meshlod_simplify::Options;

type Failure = Box<dyn Error + Send + Sync>;

const ROUNDS: u32 = 9;
const MODELS: [&str; 4] =
    ["duck.glb", "spot.obj", "fish-bream.obj", "flight-helmet/FlightHelmet.gltf"];

fn main() -> Result<(), Failure> {
    let mut paths: Vec<PathBuf> = std::env::args_os().skip(1).map(Into::into).collect();
    if paths.is_empty() {
        paths.extend(MODELS.iter().filter_map(|name| meshlod_fixtures::shared_mesh(name)));
    }
    println!("| milliseconds | wedges | all, certified | bare | finest level | bare |");
    println!("|---|--:|--:|--:|--:|--:|");
    for path in paths {
        row(&path)?;
    }
    Ok(())
}

/// Prints the times of the meshes of a scene, in all.
fn row(path: &Path) -> Result<(), Failure> {
    let scene = meshlod_io::read(path, &ReadOptions::default())?;
    let (mut wedges, mut sums) = (0, [0.0; 4]);
    for mesh in scene.meshes.iter().map(|mesh| &mesh.mesh) {
        wedges += mesh.attributes.as_ref().map_or(0, |all| all.wedge_count);
        let bare = Mesh { attributes: None, materials: None, objects: None, ..mesh.clone() };
        let [with, without] = [times(mesh)?, times(&bare)?];
        let own = [with[0], without[0], with[1], without[1]];
        sums.iter_mut().zip(own).for_each(|(sum, time)| *sum += time);
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let [all, bare, level, bare_level] = sums;
    println!("| {name} | {wedges} | {all:.1} | {bare:.1} | {level:.1} | {bare_level:.1} |");
    Ok(())
}

/// Returns the milliseconds in which the file of a mesh is read and certified, and in which its finest
/// level is.
fn times(mesh: &Mesh) -> Result<[f64; 2], Failure> {
    let file = Archive::write(&Forest::new(mesh, &Options::default())?, &Storage::default())?
        .0
        .into_source();
    let read = || {
        Archive::open(file.clone())?.read()?;
        Ok(())
    };
    let extract = || {
        Archive::open(file.clone())?.extract(&Query::uniform(0.0))?;
        Ok(())
    };
    Ok([best(read)?, best(extract)?])
}

fn best(mut work: impl FnMut() -> Result<(), Failure>) -> Result<f64, Failure> {
    let mut least = f64::INFINITY;
    for _ in 0..ROUNDS {
        let start = ThreadTime::now();
        work()?;
        least = least.min(start.elapsed().as_secs_f64());
    }
    Ok(least * 1e3)
}
