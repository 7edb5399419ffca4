//! The viewer: a window with the stage, panels, keys and mouse.
//!
//! The frame never waits: files are read, meshes simplified, checked and uploaded by jobs on other
//! threads, whose news arrive as messages.
//!
//! In the order of reading:
//! - plain data: `options` (with the report at the end), `settings`, `document` (an open file),
//!   `input` (keys and commands), `action` (requests of panels);
//! - background: `jobs` (threads), `load` and `work` (their work), `timing`, `gpu_guard`;
//! - the picture: `canvas_texture`, `picture_pane` on it, and the marks of `overlay`;
//! - `state` holds all of this; it is changed by `orders` (starts jobs), `news` (takes their
//!   results), `perform` (actions and commands) and `central` (the picture and the pointer);
//! - `panels` show the state and return actions, in the look of `theme`;
//! - `app` has the order of a frame; `school` is another window.

mod action;
mod app;
mod canvas_texture;
mod central;
mod document;
mod gpu_guard;
mod input;
mod jobs;
mod load;
mod news;
mod options;
mod orders;
mod overlay;
mod panels;
mod perform;
mod picture_pane;
mod school;
mod settings;
mod state;
mod theme;
mod timing;
mod work;

pub use options::{ViewerOptions, ViewerReport};
pub use school::{SchoolReport, SchoolScenes, SchoolWindowOptions, run_school};

use std::path::PathBuf;
use std::sync::{Arc, Mutex};

use eframe::egui_wgpu::{WgpuConfiguration, WgpuError, WgpuSetup, WgpuSetupCreateNew};

use crate::{Gpu, ViewError};
use app::ViewerApp;
use load::EarlyLoad;

/// Name under which the window and its settings are remembered.
const APP_ID: &str = "meshlod";

/// Opens the viewer and returns when its window is closed.
///
/// Must be called on the main thread. After the loss of the GPU the window opens once more.
///
/// # Errors
/// No screen or no GPU, and a GPU that keeps failing.
pub fn run(options: ViewerOptions) -> Result<ViewerReport, ViewError> {
    leave_a_core();
    let report = Arc::new(Mutex::new(ViewerReport::default()));
    let files = open_window(&options, &report)?;
    let take_loss = || report.lock().is_ok_and(|mut r| std::mem::take(&mut r.gpu_was_lost));
    if take_loss() {
        open_window(&ViewerOptions { files, ..options }, &report)?;
        if report.lock().is_ok_and(|report| report.gpu_was_lost) {
            return Err(ViewError::Failed("it was lost twice".into()));
        }
    }
    let report = report.lock().map(|report| report.clone());
    report.map_err(|_| ViewError::Failed("a thread of the viewer panicked".into()))
}

/// Opens the window until it is closed; returns the open files, for another try.
fn open_window(
    options: &ViewerOptions,
    report: &Arc<Mutex<ViewerReport>>,
) -> Result<Vec<PathBuf>, ViewError> {
    // Files are read while the window and the GPU open.
    let early: Vec<EarlyLoad> =
        options.files.iter().map(|path| EarlyLoad::start(path, &options.reading)).collect();
    let open = Arc::new(Mutex::new(options.files.clone()));
    let (app_options, app_report, app_open) = (options.clone(), Arc::clone(report), open.clone());
    let native = native_options(options);
    let done = eframe::run_native(
        APP_ID,
        native,
        Box::new(move |context| {
            let app = ViewerApp::new(context, app_options, early, app_report, app_open)?;
            Ok(Box::new(app))
        }),
    );
    done.map_err(|error| view_error(&error))?;
    Ok(open.lock().map(|open| open.clone()).unwrap_or_default())
}

fn native_options(options: &ViewerOptions) -> eframe::NativeOptions {
    let mut setup = WgpuSetupCreateNew {
        power_preference: eframe::wgpu::PowerPreference::HighPerformance,
        device_descriptor: Arc::new(Gpu::descriptor),
        ..WgpuSetupCreateNew::without_display_handle()
    };
    setup.instance_descriptor.backends &= Gpu::BACKENDS;
    let viewport = egui::ViewportBuilder::default()
        .with_title("meshlod")
        .with_app_id(APP_ID)
        .with_inner_size([1280.0, 800.0])
        .with_min_inner_size([320.0, 240.0])
        .with_drag_and_drop(true);
    eframe::NativeOptions {
        viewport,
        renderer: eframe::Renderer::Wgpu,
        wgpu_options: WgpuConfiguration {
            wgpu_setup: WgpuSetup::CreateNew(setup),
            ..WgpuConfiguration::default()
        },
        persistence_path: options.memory.clone(),
        ..eframe::NativeOptions::default()
    }
}

fn view_error(error: &eframe::Error) -> ViewError {
    match error {
        eframe::Error::Wgpu(
            WgpuError::RequestAdapterError(_)
            | WgpuError::CustomNativeAdapterSelectionError(_)
            // No driver at all: not even a surface can be made.
            | WgpuError::CreateSurfaceError(_),
        ) => ViewError::NoGpu,
        eframe::Error::Wgpu(error) => ViewError::Failed(one_line(error)),
        error => ViewError::NoWindow(one_line(error)),
    }
}

fn one_line(error: &impl ToString) -> String {
    let text = error.to_string().lines().map(str::trim).collect::<Vec<_>>().join(" ");
    // The window library begins with a line of its source: "os error at …/mod.rs:765: ".
    let place = text.rsplit_once(".rs:").and_then(|(_, rest)| rest.split_once(": "));
    place.map_or(text.clone(), |(_, reason)| reason.to_owned())
}

/// Leaves one core to the frame, unless the number of threads was chosen already.
fn leave_a_core() {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(cores.saturating_sub(1).max(1));
    // An error says that the pool is there, with the number of threads that was asked for.
    let _ = pool.build_global();
}
