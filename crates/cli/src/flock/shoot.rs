//! Filming: frame after frame is simulated, selected, drawn and written.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use meshlod::Mesh;
use meshlod::flock::FlockCamera;
use meshlod::flock::draw::FlockPainter;
use meshlod::flock::levels::{Impostor, ImpostorOptions, LevelTable};
use meshlod::flock::select::{Budget, InstanceLevel, PolicyName, Selector};
use meshlod::io::write_file;
use meshlod_school::scene::Film;

use crate::flock::figures::{Figures, FrameFigures, switches};
use crate::flock::model::FlockModel;
use crate::flock::record::Recorder;
use crate::session::Session;
use crate::session::failure::Failure;
use crate::session::files;
use crate::text::numbers::{count, plural};
use crate::verbs::flock::Flock;

/// Files and figures of a film.
pub struct Take {
    pub figures: Figures,
    /// File of the figures.
    pub lines: PathBuf,
}

/// Greatest number of triangles of a picture, each of which takes about a hundred bytes.
const MAX_DRAWN: usize = 30_000_000;

/// Runs a film and writes its frames.
pub fn shoot(
    options: &Flock,
    model: &FlockModel,
    table: &Arc<LevelTable>,
    mut film: Film,
    budget: &Budget,
    session: &Session,
) -> Result<Take, Failure> {
    let obstacles: Vec<Mesh> = film.scenario().obstacle_meshes();
    let mut painter = (!options.no_pictures)
        .then(|| painter(table, model, &obstacles, budget.impostors_below_px.is_some()))
        .transpose()?;
    let levels_only = Budget { impostors_below_px: None, ..*budget };
    let mut selector = Selector::new(options.school.policy, table.clone());
    let mut everything = Selector::new(PolicyName::None, table.clone());
    let record = |folder: &PathBuf| Recorder::new(folder, film.scenario(), model.file.as_deref());
    let mut recorder = options.record.as_ref().map(record);
    let mut before: Vec<InstanceLevel> = Vec::new();
    let mut figures = Figures::default();
    for frame in 0..options.frames {
        session.progress.part("filming", frame, options.frames);
        let start = Instant::now();
        let (flock, camera) = film.next_frame().map_err(Failure::new)?;
        let simulation_ms = milliseconds(start);
        let full = everything.select(flock, &camera, &levels_only);
        let members_in_view = full.iter().filter(|level| level.level().is_some()).count();
        let start = Instant::now();
        let levels = selector.select(flock, &camera, budget);
        let selection_ms = milliseconds(start);
        let switches = switches(table, &before, levels);
        let impostors = levels.iter().filter(|level| level.is_impostor()).count();
        before.splice(.., levels.iter().copied());
        if let Some(recorder) = &mut recorder {
            recorder.push(flock, &camera, levels);
        }
        let mut draw_ms = None;
        if let Some(painter) = &mut painter {
            check_size(selector.triangles())?;
            draw_ms = Some(draw(painter, (flock, &before, &camera), &options.out, frame)?);
        }
        figures.frames.push(FrameFigures {
            frame,
            seconds: frame as f64 / options.fps,
            members_in_view,
            triangles: selector.triangles(),
            impostors,
            full_triangles: everything.triangles(),
            switches,
            simulation_ms,
            selection_ms,
            draw_ms,
        });
    }
    warn_of_others(options, session);
    write_figures(figures, &options.out, || match &recorder {
        Some(recorder) => recorder.write(table, session),
        None => Ok(()),
    })
}

/// Writes the figures of all frames, and what else belongs to the film.
fn write_figures(
    figures: Figures,
    out: &Path,
    write_others: impl FnOnce() -> Result<(), Failure>,
) -> Result<Take, Failure> {
    files::make_folder(out)?;
    let lines = out.join("frames.jsonl");
    write_file(&lines, figures.lines().as_bytes())?;
    write_others()?;
    Ok(Take { figures, lines })
}

/// Draws a frame to a file in a folder, and returns the milliseconds of drawing.
fn draw(
    painter: &mut FlockPainter<'_>,
    (flock, levels, camera): (&meshlod::flock::Flock, &[InstanceLevel], &FlockCamera),
    out: &Path,
    frame: usize,
) -> Result<f64, Failure> {
    let start = Instant::now();
    let picture = painter.draw(flock, levels, camera).map_err(Failure::new)?;
    let draw_ms = milliseconds(start);
    if frame == 0 {
        files::make_folder(out)?;
    }
    write_file(&out.join(frame_name(frame)), &picture.png())?;
    Ok(draw_ms)
}

/// Creates the painter of a film, with a picture of the model if members may be impostors.
fn painter<'p>(
    table: &'p LevelTable,
    model: &'p FlockModel,
    obstacles: &'p [Mesh],
    has_impostors: bool,
) -> Result<FlockPainter<'p>, Failure> {
    let mut painter = FlockPainter::new(table, &model.look, obstacles);
    if has_impostors {
        let impostor = Impostor::draw(table, &model.look, &ImpostorOptions::default());
        painter.impostor = Some(Arc::new(impostor.map_err(Failure::new)?));
    }
    Ok(painter)
}

/// Returns the file name of a frame.
fn frame_name(frame: usize) -> String {
    format!("frame_{frame:04}.png")
}

fn milliseconds(since: Instant) -> f64 {
    since.elapsed().as_secs_f64() * 1e3
}

fn check_size(triangles: usize) -> Result<(), Failure> {
    match triangles > MAX_DRAWN {
        false => Ok(()),
        true => Err(Failure::new(format_args!(
            "a picture can show {} triangles, not {}: give --no-pictures or another --policy",
            count(MAX_DRAWN),
            count(triangles)
        ))),
    }
}

/// Warns of frames that an earlier, longer film has left in the folder.
fn warn_of_others(options: &Flock, session: &Session) {
    let number =
        |name: &str| name.strip_prefix("frame_")?.strip_suffix(".png")?.parse::<usize>().ok();
    let is_other = |path: &Path| {
        let name = path.file_name().and_then(|name| name.to_str());
        name.and_then(number).is_some_and(|n| n >= options.frames || options.no_pictures)
    };
    let Ok(entries) = fs::read_dir(&options.out) else { return };
    let others = entries.flatten().filter(|entry| is_other(&entry.path())).count();
    if others > 0 {
        let verb = if others == 1 { "is" } else { "are" };
        let reason =
            format_args!("{others} frame{} of an earlier film {verb} still there", plural(others));
        session.warn(Failure::at(&options.out, reason));
    }
}
