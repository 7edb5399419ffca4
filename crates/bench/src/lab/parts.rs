//! Measures models of many parts: bare and with textures beside other programs, their extent, and
//! scenes made for the purpose.

mod bare;
mod cache;
pub mod deviation;
mod extent;
mod hubs;
pub mod inputs;
mod maximum;
pub mod peers;
mod scenes;
mod textured;

use std::ffi::OsStr;
use std::path::Path;

use anyhow::{Context, Result, bail};
use meshlod::mesh::Mesh;

use super::command::Program;

/// Program that the tables are made with.
pub struct Tools {
    program: Program,
}

/// A table: its name for the command line, what it shows, and the function that makes it.
type Part = (&'static str, &'static str, fn(&Tools) -> Result<String>);

const PARTS: [Part; 6] = [
    (
        "bare",
        "Bare geometry at equal numbers of faces: every model of several components and some of one, \
         flattened to one mesh and welded where positions are equal, the same PLY for all. Mean and \
         maximum distance in % of the diagonal; the number of faces where it is above what was \
         wanted. PyMeshLab by quadrics with optimal placement, meshoptimizer by simplify without a \
         limit of the error. A peer counts where it is within 1 % of the number of faces.",
        bare::table,
    ),
    (
        "textured",
        "With textures: mean FLIP (0 is best) by the protocol of docs/notes/image-error.md. \
         meshoptimizer prunes in both columns. Where the better of its levels has more faces than \
         wanted, ours with as many is compared.",
        textured::table,
    ),
    (
        "extent",
        "Outside the bounding box of the input, in % of its diagonal: all models as they are, with \
         attributes, by default and by `qem` with as many faces.",
        extent::table,
    ),
    (
        "maximum",
        "The default beside `qem` with as many faces, bare and welded, in % of the diagonal; the mean \
         beside what it was before pieces could vanish.",
        maximum::table,
    ),
    (
        "scenes",
        "Random scenes of boxes, plates, cylinders, nested shells and cards (`scene` in the crate \
         fixtures), beside removing the smallest pieces whole until the number of faces is reached.",
        scenes::table,
    ),
    (
        "hubs",
        "A fish of 100,000 faces to 1 %, as it is, with 1,000 random pairs of near vertices merged, \
         and with every face doubled back to back; distance from its own input in % of the diagonal.",
        hubs::table,
    ),
];

/// Returns all tables of models of many parts.
pub fn section() -> Result<String> {
    let tools = Tools { program: Program::build()? };
    let mut page = "To reproduce one of the tables: `cargo xtask parts NAME`, where NAME is its \
                    heading.\n\n"
        .to_owned();
    for part in PARTS {
        page.push_str(&made(&tools, part)?);
    }
    Ok(page)
}

/// Prints the named tables, or all, each as soon as it is made; `--program PATH` before them runs
/// another build of `meshlod`.
///
/// # Errors
/// A name that no table has, before any work; a table that cannot be made.
pub fn run(arguments: &[String]) -> Result<()> {
    let (program, names) = match arguments {
        [option, path, names @ ..] if option == "--program" => (Some(path), names),
        names => (None, names),
    };
    if let Some(name) = names.iter().find(|name| !PARTS.iter().any(|part| part.0 == *name)) {
        let known = PARTS.map(|part| part.0).join(", ");
        bail!("no table is called {name:?}; the tables are {known}")
    }
    let program = program.map_or_else(Program::build, |path| Ok(Program::at(path)))?;
    let tools = Tools { program };
    for part in
        PARTS.into_iter().filter(|part| names.is_empty() || names.iter().any(|name| part.0 == name))
    {
        print!("{}", made(&tools, part)?);
    }
    Ok(())
}

fn made(tools: &Tools, (name, what, table): Part) -> Result<String> {
    eprintln!(" {name} …");
    Ok(format!("### {name}\n\n{what}\n\n{}", table(tools).with_context(|| name)?))
}

impl Tools {
    /// Simplifies a file to another by the program, to at most `faces` faces, and reads the level
    /// as one mesh in world space.
    ///
    /// A run that fails gives `None` and says why on standard error: it is a row of a table that
    /// falls short, and no reason to lose the others.
    fn simplify(&self, input: &Path, output: &Path, faces: usize, more: &[&str]) -> Option<Mesh> {
        let faces = faces.to_string();
        let fixed = ["simplify".as_ref(), input.as_os_str(), output.as_os_str()];
        let options = ["--faces", &faces].into_iter().chain(more.iter().copied()).map(OsStr::new);
        let level = self.program.answer(fixed.into_iter().chain(options));
        match level.and_then(|_| inputs::read(output)) {
            Ok(level) => Some(level),
            Err(error) => {
                eprintln!("  {} to {faces}: {error:#}", name_of(input));
                None
            }
        }
    }
}

/// Returns the name of a file without its folder.
fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
