//! `flock --score`: image errors of levels that anybody chose for a recording.

use std::path::Path;

use meshlod::flock::draw::FlockPainter;
use meshlod::flock::levels::{Impostor, ImpostorOptions, LevelTable};
use meshlod::flock::select::InstanceLevel;
use meshlod::picture::Background;
use meshlod_school::evaluate::{FrameScore, Reference};
use meshlod_school::recording::{Recording, Selection, Source, read_levels};
use serde_json::json;

use crate::flock::evaluate::check_extent;
use crate::flock::model::FlockModel;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
use crate::text::numbers::count;

/// Most frames that are drawn, evenly spread over the recording.
const SCORED: usize = 30;

/// Draws the frames of a recording with the levels of its `selection.npy`, and compares them with
/// full detail.
pub fn run(folder: &Path, model: &FlockModel, session: &Session) -> Result<Answer, Failure> {
    let at = |error| Failure::at(folder, error);
    let load = |name: &str| std::fs::read(folder.join(name)).map_err(|error| error.to_string());
    let mut source = Source::new(load);
    session.progress.stage("reading");
    let recording = Recording::read(&mut source).map_err(at)?;
    let table = read_levels(&mut source).map_err(at)?;
    let members = recording.scene().members;
    let selection = Selection::read(&mut source, [recording.frames(), members], table.levels.len())
        .map_err(at)?;
    check_extent(members, &table)?;
    let footage = recording.footage();
    let mut painter = FlockPainter::new(&table, &model.look, &footage.obstacles);
    painter.background = Background::Plain([128; 3]);
    let all = || (0..recording.frames()).flat_map(|frame| selection.frame(frame));
    if all().any(|level| level.is_impostor()) {
        let impostor = Impostor::draw(&table, &model.look, &ImpostorOptions::default());
        painter.impostor = Some(impostor.map_err(at_model(model))?.into());
    }
    let mut scores: Vec<(usize, usize, FrameScore)> = Vec::new();
    let step = recording.frames().div_ceil(SCORED).max(1);
    for frame in (0..recording.frames()).step_by(step) {
        session.progress.part("scoring", frame, recording.frames());
        let (flock, camera) = (&footage.flocks[frame], &footage.cameras[frame]);
        let levels = selection.frame(frame);
        let reference = Reference::new(&mut painter, flock, camera).map_err(Failure::new)?;
        let shown = painter.frame(flock, levels);
        let picture =
            painter.render(&shown, camera, &camera.for_picture()).map_err(Failure::new)?;
        let score = reference.score(&shown, camera, &picture).map_err(Failure::new)?;
        scores.push((frame, triangles(levels, &table), score));
    }
    Ok(answer(folder, &scores))
}

fn at_model<E: std::fmt::Display>(model: &FlockModel) -> impl Fn(E) -> Failure {
    |error| Failure::at(Path::new(&model.name), error)
}

fn triangles(levels: &[InstanceLevel], table: &LevelTable) -> usize {
    levels.iter().map(|level| level.triangles(table)).sum()
}

fn answer(folder: &Path, scores: &[(usize, usize, FrameScore)]) -> Answer {
    let mean = |figure: fn(&(usize, usize, FrameScore)) -> f64| {
        scores.iter().map(figure).sum::<f64>() / scores.len().max(1) as f64
    };
    let [triangles, flip, ssim] = [mean(|s| s.1 as f64), mean(|s| s.2.flip), mean(|s| s.2.ssim)];
    let frame = |(frame, triangles, score): &(usize, usize, FrameScore)| {
        json!({
            "frame": frame,
            "triangles": triangles,
            "flip": score.flip,
            "ssim": score.ssim,
            "pixels": score.pixels,
        })
    };
    let json = json!({
        "recording": files::name(folder),
        "mean": { "triangles": triangles, "flip": flip, "ssim": ssim },
        "frames": scores.iter().map(frame).collect::<Vec<_>>(),
    });
    let text = format!(
        "{}: FLIP {flip:.4}, SSIM {ssim:.4}, {} triangles a frame ({} frames scored)\n",
        files::name(folder),
        count(triangles.round() as usize),
        scores.len()
    );
    Answer::new(json, text)
}
