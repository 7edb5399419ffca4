//! The window: the order of a frame, screenshots, and closing.

use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use super::gpu_guard::GpuGuard;
use super::jobs::JobKind;
use super::load::{self, EarlyLoad};
use super::state::ViewerState;
use super::{ViewerOptions, ViewerReport, panels, theme};
use crate::stage::Subject;
use crate::{Gpu, ViewError};

/// Time between frames that show progress.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(60);

/// The window with its state.
pub(crate) struct ViewerApp {
    state: ViewerState,
    guard: GpuGuard,
    report: Arc<Mutex<ViewerReport>>,
    last_frame: Instant,
    /// Time between the last two frames, a tenth of a second at most.
    last_seconds: f32,
    shot: Shot,
    close_at: Option<Instant>,
}

/// State of the screenshot of the options.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shot {
    Waiting,
    Writing,
    Done,
}

impl ViewerApp {
    /// Takes over a window that has just opened; `open` lists the open files from now on.
    pub fn new(
        context: &eframe::CreationContext<'_>,
        options: ViewerOptions,
        early: Vec<EarlyLoad>,
        report: Arc<Mutex<ViewerReport>>,
        open: Arc<Mutex<Vec<PathBuf>>>,
    ) -> Result<Self, ViewError> {
        let render_state = context.wgpu_render_state.clone().ok_or(ViewError::NoGpu)?;
        let (device, queue) = (render_state.device.clone(), render_state.queue.clone());
        let gpu = Gpu::new(&render_state.adapter, device, queue);
        let guard = GpuGuard::of(&gpu, &context.egui_ctx);
        theme::apply(&context.egui_ctx);
        let mut this = Self {
            state: ViewerState::new(context, render_state, &gpu, options, open),
            guard,
            report,
            last_frame: Instant::now(),
            last_seconds: 0.0,
            shot: Shot::Waiting,
            close_at: None,
        };
        this.warm_up();
        for early in early {
            let (name, renderer) = (early.path.display().to_string(), this.state.renderer());
            let work = move |watch: &_| early.upload(&renderer, watch);
            this.state.jobs.start(JobKind::Open, format!("Opening {name}"), work);
        }
        Ok(this)
    }

    /// Compiles the pipelines in the background.
    fn warm_up(&self) {
        let renderers = Arc::clone(&self.state.renderers);
        std::thread::spawn(move || {
            // A software GPU compiles shaders when they first draw. Without it, the first picture
            // takes longer and nothing else happens.
            let _ = load::warm_up(&renderers.draft).and_then(|()| load::warm_up(&renderers.full));
        });
    }

    /// Ends flights and the window when their time has come. Returns the time to the next frame, if
    /// one must come by itself.
    fn advance(&mut self, ctx: &egui::Context) -> Option<Duration> {
        let seconds = self.last_frame.elapsed().as_secs_f64().min(0.1);
        self.last_frame = Instant::now();
        self.last_seconds = seconds as f32;
        let mut next = None;
        if self.state.stage.rig.advance(seconds) || self.state.fly(ctx, seconds) {
            next = Some(Duration::ZERO);
        }
        self.state.notices.retain(|notice| notice.until > Instant::now());
        if self.state.jobs.running().next().is_some() {
            // Progress moves; more often would take time from the work.
            next = next.or(Some(PROGRESS_INTERVAL));
        } else if !self.state.notices.is_empty() {
            next = next.or(Some(Duration::from_millis(500)));
        }
        next
    }

    /// Returns true if the picture is final: with refined normals and a cut that satisfies its
    /// query.
    fn is_settled(&self) -> bool {
        let is_busy = self.state.jobs.has(JobKind::Refine) || !self.state.rough.is_empty();
        let is_changing = self
            .state
            .stage
            .shown()
            .filter_map(|id| self.state.stage.subject(id))
            .any(|subject| matches!(subject, Subject::Levels(levels) if levels.is_changing()));
        !is_busy && !is_changing && self.state.pane.is_final(self.state.changes)
    }

    /// Takes the screenshot and closes the window, each when it is time.
    fn keep_schedule(&mut self, ctx: &egui::Context) {
        let is_loading = self.state.jobs.has(JobKind::Open);
        let is_shown =
            self.state.times.first_picture_ms.is_some() || self.state.documents.is_empty();
        if is_loading || !is_shown {
            return;
        }
        if let Some(path) = self.state.options.screenshot.clone() {
            self.take_shot(path, ctx);
        }
        if let Some(seconds) = self.state.options.seconds {
            self.close_after(seconds, ctx);
        }
    }

    /// Writes the screenshot once the picture is final, and closes the window after that.
    fn take_shot(&mut self, path: PathBuf, ctx: &egui::Context) {
        match self.shot {
            Shot::Waiting if self.state.documents.is_empty() => self.shot = Shot::Writing,
            Shot::Waiting if self.is_settled() => {
                self.state.save_picture(path);
                self.shot = Shot::Writing;
            }
            Shot::Waiting => ctx.request_repaint_after(PROGRESS_INTERVAL),
            Shot::Writing if !self.state.jobs.has(JobKind::Save) => {
                self.shot = Shot::Done;
                if self.state.options.seconds.is_none() {
                    ctx.send_viewport_cmd(egui::ViewportCommand::Close);
                }
            }
            _ => {}
        }
    }

    /// Closes the window a number of seconds after the first call, but not while the screenshot is
    /// being written.
    fn close_after(&mut self, seconds: f64, ctx: &egui::Context) {
        let wait = Duration::from_secs_f64(seconds.clamp(0.0, 1e6));
        let end = *self.close_at.get_or_insert(Instant::now() + wait);
        match end.checked_duration_since(Instant::now()) {
            Some(rest) => ctx.request_repaint_after(rest),
            None if self.shot != Shot::Writing => {
                ctx.send_viewport_cmd(egui::ViewportCommand::Close);
            }
            None => {}
        }
    }

    fn watch_gpu(&mut self, ctx: &egui::Context) {
        for error in self.guard.take_errors() {
            self.state.complain(format!("GPU: {error}"));
        }
        if self.guard.is_lost() {
            if let Ok(mut report) = self.report.lock() {
                report.gpu_was_lost = true;
            }
            ctx.send_viewport_cmd(egui::ViewportCommand::Close);
        }
    }

    fn write_report(&self) {
        let Ok(mut report) = self.report.lock() else { return };
        let shown: Vec<_> =
            self.state.stage.shown().filter_map(|id| self.state.stage.subject(id)).collect();
        let [median_frame_ms, longest_frame_ms] = self.state.times.summary();
        let [median_loading_frame_ms, longest_loading_frame_ms] =
            self.state.times.loading_summary();
        *report = ViewerReport {
            gpu: self.state.renderers.full.gpu().name().to_owned(),
            faces: shown.iter().map(|subject| subject.faces()).sum(),
            vertices: shown.iter().map(|subject| subject.vertices()).sum(),
            gpu_bytes: shown.iter().map(|subject| subject.bytes()).sum(),
            frames: self.state.times.frames(),
            median_frame_ms,
            longest_frame_ms,
            median_loading_frame_ms,
            longest_loading_frame_ms,
            load_ms: self.state.load_ms,
            first_frame_ms: self.state.times.first_frame_ms,
            first_picture_ms: self.state.times.first_picture_ms,
            problems: self.state.problems.clone(),
            gpu_was_lost: report.gpu_was_lost,
        };
    }
}

impl eframe::App for ViewerApp {
    fn logic(&mut self, ctx: &egui::Context, _: &mut eframe::Frame) {
        self.watch_gpu(ctx);
        if self.state.times.first_picture_ms.is_some() {
            self.state.refine_normals();
        }
        self.state.take_news();
        self.keep_schedule(ctx);
    }

    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        self.state.times.begin(self.state.jobs.has(JobKind::Open));
        let ctx = ui.ctx().clone();
        self.state.take_dropped_files(&ctx);
        self.state.take_keys(&ctx);
        let next = self.advance(&ctx);
        for action in panels::show(&mut self.state, ui) {
            self.state.act(action, &ctx);
        }
        self.state.show_center(ui);
        panels::help::show(&mut self.state, &ctx);
        self.state.follow_cuts(self.last_seconds);
        self.state.ensure_colors();
        if let Some(wait) = next {
            ctx.request_repaint_after(wait);
        }
        if next.is_none_or(|wait| wait > PROGRESS_INTERVAL) {
            self.state.times.rest();
        }
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        self.state.settings.display = self.state.stage.display;
        self.state.settings.write(storage);
    }

    fn on_exit(&mut self) {
        self.state.note_open_files();
        self.write_report();
    }
}
