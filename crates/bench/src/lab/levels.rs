//! Measures the multiresolution model: its size on disk and in memory, and the speed of queries.

use anyhow::Result;
use meshlod::measure::{DistanceOptions, distance};
use meshlod::mesh::{Bounds, Mesh};
use meshlod::multires::{
    Archive, Cut, Explicit, Focus, Forest, Implicit, Model, Query, Recorder, SlotMesh, SplitRule,
    Storage, Tolerance, UpdateLimits, ViewCamera,
};
use meshlod::simplify::Simplifier;
use meshlod::{Options, Target, Topology};

use crate::lab::table::Table;
use crate::{least_seconds, one_core};

const MESHES: [&str; 4] = ["bunny.ply", "horse-97k.ply", "igea.ply", "dragon.ply"];
const ROUNDS: usize = 5;
/// Tolerances in parts of the diagonal.
const TOLERANCES: [f64; 4] = [3e-3, 3e-4, 3e-5, 0.0];
const PIXELS: [f64; 3] = [1.0, 0.25, 0.02];
const FRAMES: i32 = 200;
/// Approximate numbers of updates per chunk.
const CHUNKS: [usize; 3] = [1 << 10, 1 << 12, 1 << 14];

/// Headings of the table of sizes.
const ROOM: [&str; 12] = [
    "bytes per vertex",
    "in memory",
    "compact",
    "face list",
    "explicit",
    "file: 1,024 per chunk",
    "4,096",
    "16,384",
    "moved, %",
    "first mesh, bytes",
    "its max error, %",
    "read for a ball of 2 % at full detail, %",
];
/// Headings of the table of times to build.
const BUILD: [&str; 6] = [
    "build",
    "to exhaustion, s",
    "recorded, ×",
    "whole file, ×",
    "packing, M updates/s",
    "certificate, µs per update",
];
/// Headings of the table of speeds of queries.
const RATES: [&str; 13] = [
    "million faces per second",
    "one tolerance: .3 %",
    ".03 %",
    ".003 %",
    "0",
    "exact: 1 px",
    ".25 px",
    ".02 px",
    "saturated: 1 px",
    ".25 px",
    ".02 px",
    "from the base, 0",
    "compact",
];
/// Headings of the table of sizes beside the smallest cut.
const MORE: [&str; 7] = [
    "more faces than exact, %",
    "saturated for a range of 4: 1 px",
    ".5 px",
    ".25 px",
    ".1 px",
    "by wings: 1 px",
    "folds by exact, wings",
];

/// Returns the tables of sizes, of times to build, and of queries.
pub fn section() -> Result<String> {
    let [mut room, mut build] = [Table::new(ROOM), Table::new(BUILD)];
    let [mut rates, mut more] = [Table::new(RATES), Table::new(MORE)];
    let mut following = String::new();
    for file in MESHES {
        let Some(mesh) = crate::read(file)? else { continue };
        one_core(|| -> Result<()> {
            let (forest, row) = build_times(file, &mesh)?;
            build.row(row);
            room.row(sizes(file, &mesh, &forest)?);
            rates.row(extraction_rates(file, &mesh.bounds(), &forest)?);
            more.row(relative_sizes(file, &mesh.bounds(), &forest)?);
            if file == "dragon.ply" {
                following = follow(&mesh.bounds(), &forest)?;
            }
            Ok(())
        })?;
    }
    Ok(format!(
        "By `lindstrom-turk`, with smoothed errors; CPU time on one core, the best of {ROUNDS} rounds. Files \
         move vertices by at most .005 % of the diagonal, except those of triangles that would lose \
         their area. The camera is 1.2 diagonals from the centre, 1920 × 1080, with a vertical field \
         of view of 46°. Right triangles are in docs/notes/rtin.md, more in docs/notes/multires.md. \
         To reproduce: `cargo xtask results levels`.\n\n{}{}{}{}{following}",
        room.markdown(),
        build.markdown(),
        rates.markdown(),
        more.markdown(),
    ))
}

/// Builds a forest and times it.
fn build_times(file: &str, mesh: &Mesh) -> Result<(Forest, Vec<String>)> {
    let options = Options { topology: Topology::Keep, ..Options::default() };
    let ready = || Simplifier::new(mesh, &options);
    let bare = least_seconds(ROUNDS, || {
        ready().map(|mut simplifier| simplifier.run(Target::Faces(0), &mut ()).map(|_| ()))
    });
    let record = || -> Result<Forest> {
        let mut simplifier = ready()?;
        let mut recorder = Recorder::new(&simplifier);
        simplifier.run(Target::Faces(0), &mut recorder)?;
        Ok(recorder.into_forest()?)
    };
    let mut forest = record()?;
    // As the command line does.
    forest.smooth_errors();
    let recorded = least_seconds(ROUNDS, record);
    let written = least_seconds(ROUNDS, || Archive::write(&forest, &Storage::default()));
    let packed = least_seconds(ROUNDS, || Implicit::new(&forest));
    let model = Implicit::new(&forest)?;
    let proved = least_seconds(ROUNDS, || model.certify());
    let updates = forest.update_count() as f64;
    let figures = [
        format!("{bare:.2}"),
        format!("{:.2}", recorded / bare),
        format!("{:.2}", (recorded + written) / bare),
        format!("{:.1}", updates / packed * 1e-6),
        format!("{:.2}", proved / updates * 1e6),
    ];
    Ok((forest, std::iter::once(file.to_owned()).chain(figures).collect()))
}

/// Measures the size of each encoding.
fn sizes(file: &str, mesh: &Mesh, forest: &Forest) -> Result<Vec<String>> {
    let vertices = mesh.used_vertices().iter().filter(|&&used| used).count() as f64;
    let each = |bytes: usize| format!("{:.1}", bytes as f64 / vertices);
    let bytes = Model::new(forest)?.bytes();
    let compact = compacted_model(forest)?.map_or("–".into(), |compact| each(compact.bytes()));
    let mut row = vec![
        file.to_owned(),
        each(bytes.implicit),
        compact,
        each(bytes.faces),
        each(Explicit::new(forest).bytes()),
    ];
    for updates_per_chunk in CHUNKS {
        let storage = Storage { updates_per_chunk, ..Storage::default() };
        let size = Archive::write(forest, &storage)?.0.into_source().len();
        row.push(format!("{:.2}", size as f64 / vertices));
    }
    let archive = Archive::write(forest, &Storage::default())?.0;
    row.push(format!("{:.4}", 100.0 * archive.rounding() / archive.diagonal()));
    let first = archive.chunk_ends().nth(1).unwrap_or(0);
    let coarse = archive.read_chunks(1)?.0;
    let coarse = Cut::at(&coarse, &Query::uniform(0.0))?.level().mesh();
    let apart = distance(mesh, &coarse, &DistanceOptions::default())?;
    row.extend([first.to_string(), format!("{:.3}", apart.percent(apart.max()))]);
    // An arbitrary vertex of the mesh.
    let center = mesh.positions[mesh.faces[mesh.faces.len() / 3][0].index()];
    let focus = Focus::Sphere { center, radius: 0.02 * archive.diagonal() };
    let read = archive.extract(&Query { focus, tolerance: Tolerance::Uniform(0.0) })?.bytes;
    let all = archive.chunk_ends().last().unwrap_or(1);
    row.push(format!("{:.0}", 100.0 * read as f64 / all as f64));
    Ok(row)
}

/// Measures extraction rates.
fn extraction_rates(file: &str, bounds: &Bounds, forest: &Forest) -> Result<Vec<String>> {
    let mut model = Model::new(forest)?;
    for pixels in PIXELS {
        let slope = pixels * camera(bounds, 0.0, 1.2).pixel();
        model.saturate([slope / 2.0, slope * 2.0])?;
    }
    let mut extractor = model.extractor();
    let mut row = vec![file.to_owned()];
    let mut rate = |work: &mut dyn FnMut() -> Option<usize>| {
        let faces = work().unwrap_or(0);
        let seconds = least_seconds(ROUNDS, &mut *work);
        row.push(format!("{:.1}", faces as f64 / seconds * 1e-6));
    };
    for part in TOLERANCES {
        let most = part * bounds.diagonal();
        rate(&mut || extractor.uniform(most).ok().map(|level| level.faces.len()));
    }
    let query = |pixels| Query::pixels(camera(bounds, 0.0, 1.2), pixels);
    for pixels in PIXELS {
        rate(&mut || extractor.exact(&query(pixels)).ok().map(|level| level.faces.len()));
    }
    for pixels in PIXELS {
        rate(&mut || extractor.saturated(&query(pixels)).ok().map(|level| level.faces.len()));
    }
    let all = Query::uniform(0.0);
    rate(&mut || Cut::at(model.implicit(), &all).ok().map(|cut| cut.face_count()));
    let compact = compacted_model(forest)?;
    rate(&mut || compact.as_ref().and_then(|mt| Some(Cut::at(mt, &all).ok()?.face_count())));
    Ok(row)
}

/// Reads the model back from a file in its compact form, half the memory.
fn compacted_model(forest: &Forest) -> Result<Option<Implicit>> {
    let bytes = Archive::write(forest, &Storage::default())?.0.into_source();
    Ok(Archive::open(bytes)?.read()?.0.compacted())
}

/// Compares the sizes of saturated cuts and of cuts by the weaker rule with exact cuts.
fn relative_sizes(file: &str, bounds: &Bounds, forest: &Forest) -> Result<Vec<String>> {
    let mut model = Model::new(forest)?;
    let weaker = Model::with_rule(forest, SplitRule::Wings)?;
    let query = |pixels| Query::pixels(camera(bounds, 0.0, 1.2), pixels);
    let percent =
        |of: usize, than: usize| format!("{:+.1}", 100.0 * (of as f64 / than as f64 - 1.0));
    let mut row = vec![file.to_owned()];
    for pixels in [1.0, 0.5, 0.25, 0.1] {
        let slope = pixels * camera(bounds, 0.0, 1.2).pixel();
        model.saturate([slope / 2.0, slope * 2.0])?;
        let mut extractor = model.extractor();
        let exact = extractor.exact(&query(pixels))?.faces.len();
        row.push(percent(extractor.saturated(&query(pixels))?.faces.len(), exact));
    }
    let exact = model.extractor().exact(&query(1.0))?.clone();
    let by_wings = weaker.extractor().exact(&query(1.0))?.clone();
    row.push(percent(by_wings.faces.len(), exact.faces.len()));
    row.push(format!("{}, {}", exact.folds(), by_wings.folds()));
    Ok(row)
}

/// Follows an orbit and a dolly frame by frame, and times face budgets.
fn follow(bounds: &Bounds, forest: &Forest) -> Result<String> {
    let model = Model::new(forest)?;
    let mut table = Table::new([
        "tracking the dragon, median of 200 frames",
        "faces",
        "orbit of .1°, µs",
        "orbit of 1°, µs",
        "dolly of .5 %, µs",
        "dolly, ns per changed triangle",
        "selecting and extracting at this face budget, ms",
    ]);
    for pixels in [1.0, 0.2, 0.023] {
        let orbit = |turn: f64| move |frame| (turn.to_radians() * f64::from(frame), 1.2);
        let start = Query::pixels(camera(bounds, 0.0, 1.2), pixels);
        let faces = Cut::at(model.implicit(), &start)?.face_count();
        let [slow, quick] = [0.1, 1.0].map(|turn| frames(&model, bounds, pixels, orbit(turn)));
        let dolly = frames(&model, bounds, pixels, |frame| (0.0, 1.2 * 0.995f64.powi(frame)))?;
        let mut extractor = model.extractor();
        let budget = least_seconds(ROUNDS, || extractor.at_most(faces, &start).map(|_| ()));
        table.row([
            format!("{pixels} px"),
            faces.to_string(),
            format!("{:.0}", slow?.median),
            format!("{:.0}", quick?.median),
            format!("{:.0}", dolly.median),
            format!("{:.0}", dolly.a_triangle),
            format!("{:.1}", budget * 1e3),
        ]);
    }
    Ok(table.markdown())
}

struct Frames {
    /// Time per frame in µs.
    median: f64,
    /// Time per changed triangle in ns.
    a_triangle: f64,
}

/// Follows a camera, given its angle and its distance in diagonals by frame.
fn frames(
    model: &Model,
    bounds: &Bounds,
    pixels: f64,
    at: impl Fn(i32) -> (f64, f64),
) -> Result<Frames> {
    let query = |frame| {
        let (angle, distance) = at(frame);
        Query::pixels(camera(bounds, angle, distance), pixels)
    };
    let mut cut = Cut::at(model.implicit(), &query(0))?;
    let (mut times, mut changed) = (Vec::new(), 0);
    for frame in 1..=FRAMES {
        let query = query(frame);
        times.push(least_seconds(1, || cut.update(&query, &UpdateLimits::default()).map(|_| ())));
        changed += cut.patches().count();
    }
    let all: f64 = times.iter().sum();
    times.sort_by(f64::total_cmp);
    let median = times[times.len() / 2] * 1e6;
    Ok(Frames { median, a_triangle: all * 1e9 / changed.max(1) as f64 })
}

fn camera(bounds: &Bounds, angle: f64, distance: f64) -> ViewCamera {
    let (center, reach) = (bounds.center(), distance * bounds.diagonal());
    let (sin, cos) = angle.sin_cos();
    let eye = [center[0] + reach * sin, center[1], center[2] + reach * cos];
    ViewCamera { eye, look: center, up: [0.0, 1.0, 0.0], fov_rad: 0.8, viewport: [1920, 1080] }
}
