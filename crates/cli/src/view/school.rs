//! School in a window.

use std::sync::Arc;

use meshlod::flock::levels::{Impostor, ImpostorOptions};
use meshlod_view::Gpu;
use meshlod_view::viewer::{SchoolReport, SchoolWindowOptions, run_school};

use crate::flock::model::FlockModel;
use crate::flock::scene::SceneSettings;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
use crate::text::numbers::{count, plural};
use crate::verbs::view::View;

/// Frames per second of the simulated film; the window skips frames that it has no time for.
const FPS: f64 = 120.0;

/// Builds the levels of the model, and opens the window.
pub fn run(verb: View, session: &Session) -> Result<Answer, Failure> {
    if let Some(path) = &verb.screenshot {
        files::check_picture(path, session)?;
    }
    let args = &verb.school;
    let scenes = SceneSettings {
        members: args.members,
        schools: args.schools,
        seed: 1,
        size: [960, 540],
        fps: FPS,
    };
    session.progress.stage("setting the scene");
    let scenario = scenes.scenario(args.camera)?;
    let model = FlockModel::load(&verb.model, &verb.reading, session)?;
    // Levels take seconds; a machine without a GPU should say so at once.
    Gpu::headless()?;
    session.progress.stage("building levels");
    let table = Arc::new(model.table(verb.model.method)?);
    session.progress.stage("drawing impostors");
    let impostor = Impostor::draw(&table, &model.look, &ImpostorOptions::default());
    let impostor = Arc::new(impostor.map_err(Failure::new)?);
    session.progress.stage("the window is open");
    let full = args.members.saturating_mul(table.triangle_count(0));
    let report = run_school(SchoolWindowOptions {
        table,
        look: model.look,
        impostor: Some(impostor),
        scenario,
        scenes: Arc::new(move |name| scenes.scenario(name).map_err(|failure| failure.to_string())),
        policy: args.policy,
        triangles: (full / 10).max(1),
        seconds: verb.seconds,
        screenshot: verb.screenshot,
        memory: None,
    })?;
    for problem in &report.problems {
        session.warn(problem);
    }
    Ok(Answer::new(&report, text(&report)))
}

fn text(report: &SchoolReport) -> String {
    let mut text = format!(
        "{} frames of {} member{} on {}\n",
        count(report.frames),
        count(report.members),
        plural(report.members),
        report.gpu
    );
    if report.mean_full_faces > 0.0 {
        text += &format!(
            "{} of {} faces drawn in the mean, chosen in {:.2} ms\n",
            count(report.mean_faces as usize),
            count(report.mean_full_faces as usize),
            report.mean_select_ms
        );
    }
    if let [Some(median), Some(longest)] = [report.median_frame_ms, report.longest_frame_ms] {
        text += &format!("{median:.1} ms a frame (median), {longest:.0} ms at most\n");
    }
    text
}
