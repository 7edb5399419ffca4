//! The viewer in a window.

use meshlod_view::ViewError;
use meshlod_view::viewer::{self, ViewerOptions, ViewerReport};

use crate::session::Session;
use crate::session::answer::{Answer, Outcome};
use crate::session::failure::Failure;
use crate::session::files;
use crate::text::numbers::{count, faces};
use crate::verbs::view::View;

pub fn run(verb: View, session: &Session) -> Result<Answer, Failure> {
    if let Some(path) = verb.files.iter().find(|path| files::is_pipe(path)) {
        return Err(Failure::usage(format_args!(
            "{}: the viewer opens files, not a pipe",
            files::name(path)
        )));
    }
    if let Some(path) = &verb.screenshot {
        files::check_picture(path, session)?;
    }
    let options = ViewerOptions {
        reading: verb.reading.options(),
        files: verb.files,
        seconds: verb.seconds,
        screenshot: verb.screenshot,
        started: session.started,
        ..ViewerOptions::default()
    };
    let wanted = options.files.len();
    let report = viewer::run(options)?;
    for problem in &report.problems {
        session.warn(problem);
    }
    let has_failed = wanted > 0 && report.first_picture_ms.is_none();
    let outcome = Outcome::Missed.when(has_failed);
    Ok(Answer { outcome, ..Answer::new(&report, text(&report)) })
}

fn text(report: &ViewerReport) -> String {
    let mut text = format!("{} frames on {}\n", count(report.frames), report.gpu);
    if report.faces > 0 {
        let mib = report.gpu_bytes as f64 / f64::from(1 << 20);
        text += &format!("{} on the GPU in {mib:.1} MiB\n", faces(report.faces));
    }
    if let Some(ms) = report.first_picture_ms {
        text += &format!("first picture after {ms:.0} ms\n");
    }
    text
}

impl From<ViewError> for Failure {
    fn from(error: ViewError) -> Self {
        Self::new(error)
    }
}
