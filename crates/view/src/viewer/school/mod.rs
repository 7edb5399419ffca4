//! School in a window: policies switched live, cameras, obstacles that are dragged, graphs.
//!
//! Scenes are set up on another thread, so that the window answers meanwhile.

mod app;
mod center;
mod controls;
mod drag;
mod graphs;
mod keys;
mod options;
mod panel;
mod report;
mod stage_thread;

pub use options::{SchoolReport, SchoolScenes, SchoolWindowOptions};

use std::sync::{Arc, Mutex};

use super::{ViewerOptions, leave_a_core, native_options, view_error};
use crate::ViewError;
use app::SchoolApp;
use report::SchoolOutcome;

/// Name under which the window is remembered.
const APP_ID: &str = "meshlod-school";

/// Opens a window with a school and returns when it is closed.
///
/// Must be called on the main thread.
///
/// # Errors
/// No screen or no GPU, a GPU that fails, and a scene that cannot be set up at the start.
pub fn run_school(options: SchoolWindowOptions) -> Result<SchoolReport, ViewError> {
    leave_a_core();
    let outcome = Arc::new(Mutex::new(SchoolOutcome::default()));
    let told = Arc::clone(&outcome);
    let mut native = native_options(&ViewerOptions {
        memory: options.memory.clone(),
        ..ViewerOptions::default()
    });
    native.viewport = native.viewport.with_title("meshlod: a school").with_app_id(APP_ID);
    let done = eframe::run_native(
        APP_ID,
        native,
        Box::new(move |context| Ok(Box::new(SchoolApp::new(context, options, told)?))),
    );
    done.map_err(|error| view_error(&error))?;
    let outcome = outcome.lock().map(|mut outcome| std::mem::take(&mut *outcome));
    let outcome =
        outcome.map_err(|_| ViewError::Failed("a thread of the viewer panicked".into()))?;
    outcome.error.map_or(Ok(outcome.report), Err)
}
