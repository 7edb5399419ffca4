//! The window: its state, and the order of a frame.

use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use eframe::egui_wgpu::RenderState;
use meshlod::picture::UpAxis;

use super::document::{Document, DocumentId};
use super::gpu_guard::GpuGuard;
use super::jobs::{JobKind, Jobs};
use super::picture_pane::{PaneRenderers, PicturePane};
use super::settings::Settings;
use super::timing::FrameTimes;
use super::work::{EarlyLoad, News};
use super::{ViewerOptions, ViewerReport, panels, theme, work};
use crate::stage::{Coloring, Loaded, Stage, Subject, SubjectId};
use crate::{Gpu, Renderer, ViewError};

/// Time between frames that show progress.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(60);

/// Everything that the window shows and does.
pub(crate) struct ViewerApp {
    pub options: ViewerOptions,
    pub state: RenderState,
    pub renderers: Arc<PaneRenderers>,
    pub guard: GpuGuard,
    pub stage: Stage,
    pub pane: PicturePane,
    pub jobs: Jobs<News>,
    pub documents: Vec<Document>,
    /// Index of the document that panels are about.
    pub active: usize,
    pub settings: Settings,
    pub times: FrameTimes,
    pub has_help: bool,
    /// Speed of a flight, in diagonals per second; `None` while the camera orbits.
    pub flight: Option<f64>,
    /// Number of changes of subjects, which a picture depends on.
    pub changes: u64,
    /// Lines that the status bar shows, the last one first to go.
    pub notices: Vec<Notice>,
    /// Size of the picture in pixels.
    pub size: [u32; 2],
    pub problems: Vec<String>,
    pub load_ms: Option<f64>,
    /// Subjects whose normals are to be refined once they are on the screen.
    pub rough: Vec<(SubjectId, Arc<Loaded>)>,
    /// Colours that jobs were started for: one that was refused or cancelled is not tried again
    /// until other colours were chosen.
    pub tried: Vec<(SubjectId, Coloring)>,
    /// True once a frame has drawn a subject.
    pub has_drawn: bool,
    next_document: usize,
    report: Arc<Mutex<ViewerReport>>,
    open: Arc<Mutex<Vec<PathBuf>>>,
    last_frame: Instant,
    /// Time between the last two frames, a tenth of a second at most.
    last_seconds: f32,
    shot: Shot,
    close_at: Option<Instant>,
}

/// Line in the status bar.
#[derive(Clone, Debug)]
pub(crate) struct Notice {
    pub text: String,
    pub is_problem: bool,
    pub until: Instant,
}

/// State of the picture that was asked for at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shot {
    Waiting,
    Writing,
    Done,
}

impl ViewerApp {
    /// Takes over a window that has just opened.
    pub fn new(
        context: &eframe::CreationContext<'_>,
        options: ViewerOptions,
        early: Vec<EarlyLoad>,
        report: Arc<Mutex<ViewerReport>>,
        open: Arc<Mutex<Vec<PathBuf>>>,
    ) -> Result<Self, ViewError> {
        let state = context.wgpu_render_state.clone().ok_or(ViewError::NoGpu)?;
        let gpu = Gpu::new(&state.adapter, state.device.clone(), state.queue.clone());
        let guard = GpuGuard::of(&gpu, &context.egui_ctx);
        let renderers = Arc::new(PaneRenderers::new(&gpu));
        theme::apply(&context.egui_ctx);
        let settings = Settings::read(context.storage);
        let mut stage = Stage::default();
        stage.display = settings.display;
        stage.rig.set_up(if settings.is_z_up { UpAxis::Z } else { UpAxis::Y });
        stage.rig.set_fov_rad(settings.fov_deg.to_radians());
        let mut this = Self {
            jobs: Jobs::new(&context.egui_ctx),
            times: FrameTimes::new(options.started),
            options,
            state,
            guard,
            stage,
            pane: PicturePane::default(),
            documents: Vec::new(),
            active: 0,
            settings,
            has_help: false,
            flight: None,
            changes: 0,
            notices: Vec::new(),
            size: [0; 2],
            problems: Vec::new(),
            load_ms: None,
            rough: Vec::new(),
            tried: Vec::new(),
            has_drawn: false,
            next_document: 0,
            report,
            open,
            last_frame: Instant::now(),
            last_seconds: 0.0,
            shot: Shot::Waiting,
            close_at: None,
            renderers,
        };
        this.warm_up();
        for early in early {
            let (name, renderer) = (early.path.display().to_string(), this.renderer());
            let work = move |watch: &_| early.upload(&renderer, watch);
            this.jobs.start(JobKind::Open, format!("Opening {name}"), work);
        }
        Ok(this)
    }

    /// Compiles the pipelines beside everything else.
    fn warm_up(&self) {
        let renderers = Arc::clone(&self.renderers);
        std::thread::spawn(move || {
            // A software GPU compiles shaders when they first draw. Without it, the first picture
            // takes longer and nothing else happens.
            let _ = work::warm_up(&renderers.draft).and_then(|()| work::warm_up(&renderers.full));
        });
    }

    /// Returns the renderer that uploads and draws.
    pub fn renderer(&self) -> Arc<Renderer> {
        Arc::clone(&self.renderers.full)
    }

    pub fn next_document_id(&mut self) -> DocumentId {
        self.next_document += 1;
        DocumentId(self.next_document)
    }

    /// Returns the document that panels are about.
    pub fn document(&self) -> Option<&Document> {
        self.documents.get(self.active)
    }

    /// Shows a line for a few seconds.
    pub fn notify(&mut self, text: impl Into<String>) {
        let until = Instant::now() + Duration::from_secs(5);
        self.notices.push(Notice { text: text.into(), is_problem: false, until });
    }

    /// Shows a line about what went wrong, and keeps it for the report.
    pub fn complain(&mut self, text: impl Into<String>) {
        let (text, until) = (text.into(), Instant::now() + Duration::from_secs(12));
        // Some come with every frame.
        if self.problems.contains(&text) {
            return;
        }
        self.problems.push(text.clone());
        self.notices.push(Notice { text, is_problem: true, until });
    }

    /// Notes which files are open, for the case that the window must be opened again.
    pub fn note_open_files(&self) {
        if let Ok(mut open) = self.open.lock() {
            *open = self.documents.iter().map(|document| document.loaded.path.clone()).collect();
        }
    }

    /// Ends flights and the window when their time has come. Returns the time to the next frame, if
    /// one must come by itself.
    fn advance(&mut self, ctx: &egui::Context) -> Option<Duration> {
        let seconds = self.last_frame.elapsed().as_secs_f64().min(0.1);
        self.last_frame = Instant::now();
        self.last_seconds = seconds as f32;
        let mut next = None;
        if self.stage.rig.advance(seconds) || self.fly(ctx, seconds) {
            next = Some(Duration::ZERO);
        }
        self.notices.retain(|notice| notice.until > Instant::now());
        if self.jobs.running().next().is_some() {
            // Progress moves; more often would take time from the work.
            next = next.or(Some(PROGRESS_INTERVAL));
        } else if !self.notices.is_empty() {
            next = next.or(Some(Duration::from_millis(500)));
        }
        next
    }

    /// Returns true if the picture shows everything as it should: with final normals, and the cut
    /// that was asked for.
    fn is_settled(&self) -> bool {
        let is_busy = self.jobs.has(JobKind::Refine) || !self.rough.is_empty();
        let is_changing = self
            .stage
            .shown()
            .filter_map(|id| self.stage.subject(id))
            .any(|subject| matches!(subject, Subject::Levels(levels) if levels.is_changing()));
        !is_busy && !is_changing && self.pane.is_final(self.changes)
    }

    /// Writes the picture that was asked for, and closes the window when it is time.
    fn keep_schedule(&mut self, ctx: &egui::Context) {
        let is_loading = self.jobs.has(JobKind::Open);
        let is_shown = self.times.first_picture_ms.is_some() || self.documents.is_empty();
        if is_loading || !is_shown {
            return;
        }
        if let Some(path) = self.options.screenshot.clone() {
            match self.shot {
                Shot::Waiting if self.documents.is_empty() => self.shot = Shot::Writing,
                Shot::Waiting if self.is_settled() => {
                    self.save_picture(path);
                    self.shot = Shot::Writing;
                }
                Shot::Waiting => ctx.request_repaint_after(PROGRESS_INTERVAL),
                Shot::Writing if !self.jobs.has(JobKind::Save) => {
                    self.shot = Shot::Done;
                    if self.options.seconds.is_none() {
                        ctx.send_viewport_cmd(egui::ViewportCommand::Close);
                    }
                }
                _ => {}
            }
        }
        if let Some(seconds) = self.options.seconds {
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
    }

    fn watch_gpu(&mut self, ctx: &egui::Context) {
        for error in self.guard.take_errors() {
            self.complain(format!("GPU: {error}"));
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
        let shown: Vec<_> = self.stage.shown().filter_map(|id| self.stage.subject(id)).collect();
        let [median_frame_ms, longest_frame_ms] = self.times.summary();
        let [median_loading_frame_ms, longest_loading_frame_ms] = self.times.loading_summary();
        *report = ViewerReport {
            gpu: self.renderers.full.gpu().name().to_owned(),
            faces: shown.iter().map(|subject| subject.faces()).sum(),
            vertices: shown.iter().map(|subject| subject.vertices()).sum(),
            gpu_bytes: shown.iter().map(|subject| subject.bytes()).sum(),
            frames: self.times.frames(),
            median_frame_ms,
            longest_frame_ms,
            median_loading_frame_ms,
            longest_loading_frame_ms,
            load_ms: self.load_ms,
            first_frame_ms: self.times.first_frame_ms,
            first_picture_ms: self.times.first_picture_ms,
            problems: self.problems.clone(),
            gpu_was_lost: report.gpu_was_lost,
        };
    }
}

impl eframe::App for ViewerApp {
    fn logic(&mut self, ctx: &egui::Context, _: &mut eframe::Frame) {
        self.watch_gpu(ctx);
        if self.times.first_picture_ms.is_some() {
            self.refine_normals();
        }
        self.take_news();
        self.keep_schedule(ctx);
    }

    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        self.times.begin(self.jobs.has(JobKind::Open));
        let ctx = ui.ctx().clone();
        self.take_dropped_files(&ctx);
        self.take_keys(&ctx);
        let next = self.advance(&ctx);
        panels::show(self, ui);
        self.show_center(ui);
        panels::help::show(self, &ctx);
        self.follow_cuts(self.last_seconds);
        self.ensure_colors();
        if let Some(wait) = next {
            ctx.request_repaint_after(wait);
        }
        if next.is_none_or(|wait| wait > PROGRESS_INTERVAL) {
            self.times.rest();
        }
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        self.settings.display = self.stage.display;
        self.settings.write(storage);
    }

    fn on_exit(&mut self) {
        self.note_open_files();
        self.write_report();
    }
}
