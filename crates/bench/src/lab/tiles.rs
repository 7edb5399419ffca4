//! Measures tilesets: what they cost to make, what each level is like, and what a client loads.
//!
//! | module | what it holds |
//! |---|---|
//! | `tileset` | the tiles of a tileset, and those of a level as one model |
//! | `level` | a level beside the input: distance, edges, FLIP, faces of `simplify` |
//! | `pyramid` | a pyramid of fixed levels, as other programs make it |
//! | `loaded` | bytes that 3DTilesRendererJS loads of either |

mod level;
mod loaded;
mod pyramid;
mod tileset;

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Result, bail};
use tempfile::TempDir;

use super::command::Program;
use super::table::Table;
use tileset::Tileset;

/// Model to make tiles of.
struct TileModel {
    name: &'static str,
    /// Sample and its number of faces, or a shared mesh if there is none.
    sample: Option<(&'static str, usize)>,
    /// Number of faces of a tile, such that there are several levels.
    tile_faces: usize,
    /// Whether levels are compared with the model, which is held in memory for that.
    compares: bool,
    /// Whether the bytes that a client loads are compared with those of a pyramid.
    loads: bool,
}

const MODELS: [TileModel; 4] = [
    TileModel {
        name: "terrain of 10⁶ faces",
        sample: Some(("terrain", 1_000_000)),
        tile_faces: 50_000,
        compares: true,
        loads: true,
    },
    TileModel { name: "bunny.ply", sample: None, tile_faces: 8_000, compares: true, loads: true },
    TileModel {
        name: "flight-helmet/FlightHelmet.gltf",
        sample: None,
        tile_faces: 8_000,
        compares: true,
        loads: false,
    },
    TileModel {
        name: "terrain of 10⁷ faces",
        sample: Some(("terrain", 10_000_000)),
        tile_faces: 50_000,
        compares: false,
        loads: false,
    },
];

/// Model that takes a quarter of an hour.
const LARGE: TileModel = TileModel {
    name: "terrain of 10⁸ faces",
    sample: Some(("terrain", 100_000_000)),
    tile_faces: 50_000,
    compares: false,
    loads: false,
};

/// Returns tables of tilesets.
pub fn section() -> Result<String> {
    let mut text = String::new();
    let models: Vec<&TileModel> = MODELS.iter().collect();
    tables(&Program::build()?, &models, &mut |table| text.push_str(table))?;
    Ok(text)
}

/// Prints the tables alone, each as soon as it is made. Arguments: `--program PATH` for another build
/// of `meshlod`, `--large` for the largest model as well, then names of models, or parts of names;
/// all without any.
///
/// # Errors
/// A name that no model has; a table that cannot be made.
pub fn run(arguments: &[String]) -> Result<()> {
    let (program, arguments) = match arguments {
        [option, path, rest @ ..] if option == "--program" => (Some(path), rest),
        rest => (None, rest),
    };
    let (is_large, names) = match arguments {
        [option, rest @ ..] if option == "--large" => (true, rest),
        rest => (false, rest),
    };
    let all = MODELS.iter().chain(is_large.then_some(&LARGE));
    let is_named =
        |model: &&TileModel| names.is_empty() || names.iter().any(|name| model.name.contains(name));
    let models: Vec<&TileModel> = all.filter(is_named).collect();
    if models.is_empty() {
        bail!("no model has such a name");
    }
    let program = program.map_or_else(Program::build, |path| Ok(Program::at(path)))?;
    tables(&program, &models, &mut |table| print!("{table}"))
}

/// Makes the tables, and calls `see` with each.
fn tables(program: &Program, models: &[&TileModel], see: &mut dyn FnMut(&str)) -> Result<()> {
    let folder = tempfile::tempdir()?;
    let mut costs = Table::new(COSTS);
    let mut made = Vec::new();
    // All runs before any model is read: memory of this process counts in the peak of its children.
    for model in models {
        eprintln!("  {} …", model.name);
        let Some(input) = input(program, model, &folder)? else { continue };
        let output = folder.path().join(format!("tiles-{}", made.len()));
        costs.row(cost(program, model, &input, &output)?);
        if model.sample.is_some() && !model.compares {
            std::fs::remove_file(&input)?;
        }
        made.push((*model, input, output));
    }
    see(&format!("{ABOUT_COSTS}{}{ABOUT_LEVELS}", costs.markdown()));
    for (model, input, output) in &made {
        eprintln!("  levels of {} …", model.name);
        let compared = model.compares.then_some((program, input.as_path()));
        see(&level::table(model.name, &Tileset::read(output)?, compared)?);
    }
    see(loaded::ABOUT);
    for (model, input, _) in made.iter().filter(|(model, ..)| model.loads) {
        eprintln!("  bytes of {} …", model.name);
        see(&loaded::table(program, model.name, input, model.tile_faces)?);
    }
    Ok(())
}

const ABOUT_COSTS: &str = "Whole runs of `meshlod tiles MODEL OUT --memory 1G`, with `--tile-faces 8000` for the \
     shared meshes, so that there are levels. Terrains have colours.\n\n";

const COSTS: [&str; 8] =
    ["model", "s", "CPU, s", "peak, MB", "tiles", "levels", "MB", "`check`, findings"];

const ABOUT_LEVELS: &str = "Each level by itself, its tiles joined as they decode, without skirts. *proved*: the greatest \
     `geometricError`; *measured*: greatest distance, both ways, by 500,000 samples each. \
     *`simplify`*: faces of the level by those of `simplify --error` on the whole model, at most at \
     the same measured distance. *open*, *non-manifold*: edges beyond those of the input. *FLIP*: mean \
     over twelve views of 1024 by 1024, over the pixels that show either; the camera is where the \
     level's error is one pixel at the nearest point of the surface, in the middle of the picture. *FLIP \
     of `simplify`*: that of the level which `simplify` made, seen alike.\n\n";

/// Returns the file of a model; `None` if the shared meshes are not there.
fn input(program: &Program, model: &TileModel, folder: &TempDir) -> Result<Option<PathBuf>> {
    let Some((sample, faces)) = model.sample else { return Ok(crate::shared_mesh(model.name)) };
    let path = folder.path().join(format!("{sample}-{faces}.ply"));
    let (path_text, faces) = (path.display().to_string(), faces.to_string());
    program.answer(["sample", sample, &path_text, "--faces", &faces, "--colors"])?;
    Ok(Some(path))
}

/// Makes a tileset, and returns what it cost.
fn cost(program: &Program, model: &TileModel, input: &Path, output: &Path) -> Result<Vec<String>> {
    let faces = model.tile_faces.to_string();
    let start = Instant::now();
    let arguments = ["tiles", "--memory", "1G", "--tile-faces", &faces];
    let used = program.run(&arguments, [input, output])?;
    let seconds = start.elapsed().as_secs_f64();
    let checked = program.answer(["check", &output.display().to_string()])?;
    let tileset = Tileset::read(output)?;
    Ok(vec![
        model.name.to_owned(),
        format!("{seconds:.1}"),
        format!("{:.1}", (used.utime + used.stime).as_secs_f64()),
        format!("{:.0}", used.maxrss as f64 / 1e6),
        tileset.tiles.len().to_string(),
        tileset.depths().count().to_string(),
        format!("{:.1}", tileset.bytes()? as f64 / 1e6),
        checked["findings"].as_array().map_or(0, Vec::len).to_string(),
    ])
}
