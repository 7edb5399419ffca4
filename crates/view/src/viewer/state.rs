//! State of the viewer, which panels show and actions change.

use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use eframe::egui_wgpu::RenderState;
use meshlod::picture::UpAxis;

use super::ViewerOptions;
use super::document::{Document, DocumentId};
use super::jobs::Jobs;
use super::picture_pane::{PaneRenderers, PicturePane};
use super::settings::Settings;
use super::timing::FrameTimes;
use super::work::News;
use crate::stage::{Coloring, Loaded, Stage, SubjectId};
use crate::{Gpu, Renderer};

/// Everything that the window shows.
pub(crate) struct ViewerState {
    pub options: ViewerOptions,
    pub render_state: RenderState,
    pub renderers: Arc<PaneRenderers>,
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
    /// Number of changes of subjects; a change outdates the picture.
    pub changes: u64,
    /// Messages for the status bar, which shows the last.
    pub notices: Vec<Notice>,
    /// Size of the picture in pixels.
    pub size: [u32; 2],
    pub problems: Vec<String>,
    pub load_ms: Option<f64>,
    /// Subjects whose normals are to be refined once they are on the screen.
    pub rough: Vec<(SubjectId, Arc<Loaded>)>,
    /// Colourings that jobs were started for: a refused or cancelled one is not tried again until
    /// another is chosen.
    pub tried: Vec<(SubjectId, Coloring)>,
    /// True once a frame has drawn a subject.
    pub has_drawn: bool,
    next_document: usize,
    open_files: Arc<Mutex<Vec<PathBuf>>>,
}

/// Line in the status bar.
#[derive(Clone, Debug)]
pub(crate) struct Notice {
    pub text: String,
    pub is_problem: bool,
    pub until: Instant,
}

impl ViewerState {
    /// Starts with the settings of the last run and nothing open; `open_files` is kept up to date.
    pub fn new(
        context: &eframe::CreationContext<'_>,
        render_state: RenderState,
        gpu: &Gpu,
        options: ViewerOptions,
        open_files: Arc<Mutex<Vec<PathBuf>>>,
    ) -> Self {
        let settings = Settings::read(context.storage);
        Self {
            jobs: Jobs::new(&context.egui_ctx),
            times: FrameTimes::new(options.started),
            options,
            render_state,
            renderers: Arc::new(PaneRenderers::new(gpu)),
            stage: first_stage(&settings),
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
            open_files,
        }
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

    /// Shows an error message, and keeps it for the report.
    pub fn complain(&mut self, text: impl Into<String>) {
        let (text, until) = (text.into(), Instant::now() + Duration::from_secs(12));
        // Some come with every frame.
        if self.problems.contains(&text) {
            return;
        }
        self.problems.push(text.clone());
        self.notices.push(Notice { text, is_problem: true, until });
    }

    /// Notes the open files, in case the window must be opened again.
    pub fn note_open_files(&self) {
        if let Ok(mut open) = self.open_files.lock() {
            *open = self.documents.iter().map(|document| document.loaded.path.clone()).collect();
        }
    }
}

/// Returns an empty stage with the camera and the display of the settings.
fn first_stage(settings: &Settings) -> Stage {
    let mut stage = Stage::default();
    stage.display = settings.display;
    stage.rig.set_up(if settings.is_z_up { UpAxis::Z } else { UpAxis::Y });
    stage.rig.set_fov_rad(settings.fov_deg.to_radians());
    stage
}
