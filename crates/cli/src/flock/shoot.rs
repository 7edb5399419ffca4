//! Filming: frame after frame is simulated, selected, drawn and written.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use meshlod::Mesh;
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
    let mut painter =
        (!options.no_pictures).then(|| FlockPainter::new(table, &model.look, &obstacles));
    if let (Some(painter), Some(_)) = (&mut painter, budget.impostors_below_px) {
        let impostor = Impostor::draw(table, &model.look, &ImpostorOptions::default());
        painter.impostor = Some(Arc::new(impostor.map_err(Failure::new)?));
    }
    let levels_only = Budget { impostors_below_px: None, ..*budget };
    let mut selector = Selector::new(options.school.policy, table.clone());
    let mut everything = Selector::new(PolicyName::None, table.clone());
    let mut recorder = options
        .record
        .as_deref()
        .map(|folder| Recorder::new(folder, film.scenario(), model.file.as_deref()));
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
        before.clear();
        before.extend_from_slice(levels);
        if let Some(recorder) = &mut recorder {
            recorder.push(flock, &camera, levels);
        }
        let mut draw_ms = None;
        if let Some(painter) = &mut painter {
            check_size(selector.triangles())?;
            let start = Instant::now();
            let picture = painter.draw(flock, &before, &camera).map_err(Failure::new)?;
            draw_ms = Some(milliseconds(start));
            if frame == 0 {
                files::make_folder(&options.out)?;
            }
            write_file(&options.out.join(frame_name(frame)), &picture.png())?;
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
    files::make_folder(&options.out)?;
    let lines = options.out.join("frames.jsonl");
    write_file(&lines, figures.lines().as_bytes())?;
    warn_of_others(options, session);
    if let Some(recorder) = &recorder {
        recorder.write(table, session)?;
    }
    Ok(Take { figures, lines })
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
