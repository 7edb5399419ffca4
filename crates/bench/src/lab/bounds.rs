//! Levels within an error that is proved: what the proof costs, by turns with the plain run to as many
//! faces, and what a file of all levels answers.

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result};
use serde_json::Value;

use crate::lab::command::Program;
use crate::lab::table::Table;

/// Best of this many rounds, in which the runs alternate.
const ROUNDS: usize = 3;

const MESHES: [&str; 9] = [
    "bunny.ply",
    "horse-97k.ply",
    "igea.ply",
    "dragon.ply",
    "armadillo-173k.ply",
    "feline.ply",
    "sponza.obj",
    "skyscraper.obj",
    "turbine.off",
];

/// Errors in % of the diagonal.
const ERRORS: [f64; 3] = [0.3, 0.1, 0.03];

const FLATS: [&str; 6] = ["cube", "plates", "prism", "boxes", "stairs", "voxels"];
const FLAT_FACES: &str = "49152";

/// Errors on flats, in parts of the diagonal.
const SMALL_ERRORS: [f64; 4] = [1e-2, 1e-4, 1e-6, 1e-7];

/// Returns tables of levels within an error.
pub fn section() -> Result<String> {
    let program = Program::build()?;
    let folder = tempfile::tempdir()?;
    let text = format!(
        "Whole commands, files included, best of {ROUNDS} by turns. *times*: relative to `simplify \
         --faces` to as many faces; *used*: the part of the error that is used, the lower bound of \
         `measure --certified`, which encloses it to 1 %; *cut*: faces of `extract --error` from `build`'s file, relative to those of \
         `simplify`; *by error*: from a file of `build --order error`.\n\n"
    );
    let levels = levels(&program, folder.path())?;
    Ok(text + &levels + &flats(&program, folder.path())?)
}

fn levels(program: &Program, folder: &Path) -> Result<String> {
    let headings = [
        "mesh, error",
        "faces",
        "rounds",
        "s",
        "plain, s",
        "times",
        "used",
        "extract, s",
        "cut",
        "by error",
    ];
    let mut table = Table::new(headings);
    let [level, plain, file, by_error] =
        ["level.ply", "plain.ply", "cost.mlod", "error.mlod"].map(|name| path_in(folder, name));
    for name in MESHES {
        let Some(mesh) = crate::shared_mesh(name) else { continue };
        let mesh = mesh.display().to_string();
        program.answer(["build", &mesh, &file])?;
        program.answer(["build", &mesh, &by_error, "--order", "error"])?;
        for error in ERRORS.map(|error| format!("{error}%")) {
            let within = ["simplify", &mesh, &level, "--error", &error];
            let report = program.answer(within)?;
            let faces = number(&report, "output_faces")?;
            let to_faces = ["simplify", &mesh, &plain, "--faces", &faces.to_string()];
            let extract = ["extract", &file, &plain, "--error", &error];
            let [proved, simplified, extracted] =
                alternate(program, [&within[..], &to_faces[..], &extract[..]])?;
            let cuts = [&file, &by_error].map(|file| -> Result<String> {
                let cut = program.answer(["extract", file, &plain, "--error", &error])?;
                Ok(format!("{:.2}", number(&cut, "faces")? / faces))
            });
            let [by_cost, by_error] = cuts;
            let used = program.answer(["measure", &mesh, &level, "--certified", "--samples=1"])?;
            let used = number(&used["certified"], "lower")? / number(&report, "error_asked")?;
            table.row([
                format!("{}, {error}", stem(name)),
                faces.to_string(),
                number(&report, "error_rounds")?.to_string(),
                format!("{proved:.2}"),
                format!("{simplified:.2}"),
                format!("{:.1}", proved / simplified),
                format!("{used:.3}"),
                format!("{extracted:.2}"),
                by_cost?,
                by_error?,
            ]);
        }
    }
    Ok(table.markdown())
}

/// Flats as they are and turned: seconds within errors of which each is proved, or how much is.
fn flats(program: &Program, folder: &Path) -> Result<String> {
    let errors = SMALL_ERRORS.map(|error| format!("{error:e}"));
    let mut table =
        Table::new(["flats, seconds within"].into_iter().chain(errors.each_ref().map(|e| &e[..])));
    let [input, level] = ["flat.ply", "flat-level.ply"].map(|name| path_in(folder, name));
    for flat in FLATS {
        for turned in [&[][..], &["--turned"]] {
            let sample = ["sample", flat, &input, "--faces", FLAT_FACES];
            program.answer(sample.iter().chain(turned))?;
            let mut cells = vec![[flat, if turned.is_empty() { "" } else { ", turned" }].concat()];
            for error in SMALL_ERRORS {
                let error = format!("{}%", 100.0 * error);
                let within = ["simplify", &input, &level, "--error", &error];
                let (seconds, report) = timed(program, &within)?;
                let proved = number(&report, "error_proved")? / number(&report, "error_asked")?;
                let note = if report["reached"] == true {
                    String::new()
                } else {
                    format!(", {proved:.1} proved")
                };
                cells.push(format!("{seconds:.2}{note}"));
            }
            table.row(cells);
        }
    }
    Ok(table.markdown())
}

/// Runs commands by turns. Returns the least time of each, in seconds.
fn alternate<const N: usize>(program: &Program, commands: [&[&str]; N]) -> Result<[f64; N]> {
    let mut least = [f64::INFINITY; N];
    for _ in 0..ROUNDS {
        for (least, command) in least.iter_mut().zip(commands) {
            *least = least.min(timed(program, command)?.0);
        }
    }
    Ok(least)
}

fn timed(program: &Program, command: &[&str]) -> Result<(f64, Value)> {
    let start = Instant::now();
    let report = program.answer(command)?;
    Ok((start.elapsed().as_secs_f64(), report))
}

fn number(report: &Value, field: &str) -> Result<f64> {
    report[field].as_f64().with_context(|| format!("{field} in {report}"))
}

fn path_in(folder: &Path, name: &str) -> String {
    folder.join(name).display().to_string()
}

fn stem(name: &str) -> &str {
    name.split('.').next().unwrap_or(name)
}
