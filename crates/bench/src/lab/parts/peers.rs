//! PyMeshLab and meshoptimizer, in a Python environment of their own under `target`.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};
use meshlod::measure::PreparedSurface;
use serde_json::Value;

use super::cache::{Cache, folder};
use super::deviation::Deviation;
use super::inputs::read;
use crate::lab::folders::root;

/// Names of the other programs in files, and in tables.
pub const PEERS: [(&str, &str); 3] = [
    ("pymeshlab", "PyMeshLab"),
    ("meshopt", "meshoptimizer"),
    ("meshopt-prune", "meshoptimizer, prune"),
];

/// Packages that the script needs, in the versions that its figures were first made with.
const PACKAGES: [&str; 4] =
    ["pymeshlab==2025.7.post1", "meshoptimizer==0.2.30a0", "trimesh==5.2.0", "numpy==2.4.6"];

/// Measures the levels of all peers for an input in a PLY file, by number of faces asked for.
///
/// Runs the peers only for what no earlier run has made: the figures are kept by the content of the
/// file, the script and the packages. `None` stands for a peer that leaves nothing.
pub fn deviations(
    input: &Path,
    surface: &PreparedSurface<'_>,
    wanted: &[usize],
) -> Result<Vec<[Option<Deviation>; 3]>> {
    let bytes = std::fs::read(input).with_context(|| input.display().to_string())?;
    let versions = PACKAGES.map(str::as_bytes).into_iter().chain([&include_bytes!("peers.py")[..]]);
    let mut cache = Cache::open(versions.chain([&bytes[..]]))?;
    let name = |peer: &str, faces: usize| format!("{peer}-{faces}");
    let is_missing =
        |faces: &&usize| PEERS.iter().any(|(peer, _)| cache.get(&name(peer, **faces)).is_none());
    let missing: Vec<usize> = wanted.iter().filter(is_missing).copied().collect();
    if !missing.is_empty() {
        let levels = tempfile::tempdir()?;
        run(input, levels.path(), &missing)?;
        for level in missing.iter().flat_map(|&faces| PEERS.map(|(peer, _)| name(peer, faces))) {
            let path = levels.path().join(format!("{level}.ply"));
            let mesh = path.exists().then(|| read(&path)).transpose()?;
            let deviation = mesh.map(|mesh| Deviation::of(surface, &mesh)).transpose()?.flatten();
            cache.set(level, deviation.map_or(Value::Null, Deviation::to_json))?;
        }
    }
    let found =
        |faces: usize, peer: &str| cache.get(&name(peer, faces)).and_then(Deviation::from_json);
    Ok(wanted.iter().map(|&faces| PEERS.map(|(peer, _)| found(faces, peer))).collect())
}

fn run(input: &Path, folder: &Path, wanted: &[usize]) -> Result<()> {
    let script = root().join("crates/bench/src/lab/parts/peers.py");
    let mut command = Command::new(environment()?);
    command.arg(script).arg(input).arg(folder);
    call(command.args(wanted.iter().map(usize::to_string)))
}

/// Returns the Python of the environment, which it makes where it is missing or of other packages.
fn environment() -> Result<PathBuf> {
    let folder = folder("venv")?;
    let (python, stamp) = (folder.join("bin/python"), folder.join("packages.txt"));
    let packages = PACKAGES.join("\n");
    if std::fs::read_to_string(&stamp).is_ok_and(|installed| installed == packages) {
        return Ok(python);
    }
    eprintln!("  installing {} …", PACKAGES.join(", "));
    call(Command::new("python3").args(["-m", "venv", "--clear"]).arg(&folder))?;
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
    call(Command::new(&python).args(install).args(PACKAGES))?;
    std::fs::write(stamp, packages)?;
    Ok(python)
}

/// Runs a command, silent unless it fails.
fn call(command: &mut Command) -> Result<()> {
    let output = command.output().with_context(|| format!("{command:?}"))?;
    if !output.status.success() {
        bail!("{command:?} failed: {}", String::from_utf8_lossy(&output.stderr).trim());
    }
    Ok(())
}
