//! Actions: the wishes of keys and panels, carried out.

use std::path::PathBuf;
use std::sync::Arc;

use egui::{CursorGrab, ViewportCommand};
use meshlod::Target;
use meshlod::picture::UpAxis;

use super::app::ViewerApp;
use super::document::{DocumentLevel, LevelGoal, ShownSide};
use super::input::{Command, OrbitStep, commands};
use super::jobs::JobKind;
use super::work;
use crate::stage::{Coloring, Shading, Subject, SubjectId};

/// Turn of the keys 2, 4, 6 and 8, in radians.
const ORBIT_STEP: f64 = std::f64::consts::PI / 12.0;
/// Speed of a flight at its start, in diagonals per second.
const FLIGHT_SPEED: f64 = 0.4;
/// Radius of what is shown around a finding, relative to the diagonal.
const FINDING_RADIUS: f64 = 0.03;

/// Wish of a panel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Action {
    Do(Command),
    Activate(usize),
    Close(usize),
    Show(ShownSide),
    Simplify,
    Compare,
    Check,
    Cancel(JobKind),
    SelectFinding(usize),
    SetUp(UpAxis),
    ToggleFrozen,
}

impl ViewerApp {
    /// Opens the files that were dropped on the window.
    pub fn take_dropped_files(&mut self, ctx: &egui::Context) {
        let dropped = ctx.input_mut(|input| std::mem::take(&mut input.raw.dropped_files));
        for file in dropped {
            self.open(file.path().to_owned());
        }
    }

    /// Opens a file in the background.
    pub fn open(&mut self, path: PathBuf) {
        let (renderer, reading) = (self.renderer(), self.options.reading);
        let label = format!("Opening {}", path.display());
        let work = move |watch: &_| work::open(&path, &reading, &renderer, watch);
        self.jobs.start(JobKind::Open, label, work);
    }

    /// Does what the keys of this frame ask for, unless a field has them.
    pub fn take_keys(&mut self, ctx: &egui::Context) {
        if ctx.egui_wants_keyboard_input() {
            return;
        }
        for command in ctx.input_mut(commands) {
            self.obey(command, ctx);
        }
    }

    pub fn act(&mut self, action: Action, ctx: &egui::Context) {
        match action {
            Action::Do(command) => self.obey(command, ctx),
            Action::Activate(index) => {
                self.active = index;
                self.show_document();
                self.frame_all();
            }
            Action::Close(index) => self.close(index),
            Action::Show(mode) => self.show_side(mode),
            Action::Simplify => self.simplify(),
            Action::Compare => self.compare(),
            Action::Check => self.check(),
            Action::Cancel(kind) => self.jobs.cancel(kind),
            Action::SelectFinding(index) => self.select_finding(index),
            Action::SetUp(up) => {
                self.settings.is_z_up = up == UpAxis::Z;
                self.stage.rig.set_up(up);
            }
            Action::ToggleFrozen => self.toggle_frozen(),
        }
    }

    pub fn obey(&mut self, command: Command, ctx: &egui::Context) {
        let is_flying = self.flight.is_some();
        match command {
            Command::Look(side) => self.stage.rig.fly_to_side(side),
            Command::Orbit(step) => {
                let [turn, tilt] = match step {
                    OrbitStep::Left => [ORBIT_STEP, 0.0],
                    OrbitStep::Right => [-ORBIT_STEP, 0.0],
                    OrbitStep::Up => [0.0, ORBIT_STEP],
                    OrbitStep::Down => [0.0, -ORBIT_STEP],
                };
                self.stage.rig.orbit(turn, tilt);
            }
            Command::FrameAll => self.frame_all(),
            Command::FrameSelected => self.frame_selected(),
            Command::CycleShading => {
                self.stage.display.shading = match self.stage.display.shading {
                    Shading::Smooth => Shading::Flat,
                    Shading::Flat => Shading::Smooth,
                };
            }
            Command::ToggleWireframe => self.stage.display.wireframe ^= true,
            Command::ToggleFly => self.set_flight(!is_flying, ctx),
            Command::CycleSides => self.cycle_sides(),
            Command::FreezeCamera => self.toggle_frozen(),
            Command::TogglePanel => self.settings.has_panel ^= true,
            Command::SavePicture => {
                let path = self.picture_path();
                self.save_picture(path);
            }
            Command::ToggleHelp => self.has_help ^= true,
            Command::NextFile => {
                let next = (self.active + 1) % self.documents.len().max(1);
                self.act(Action::Activate(next), ctx);
            }
            Command::Leave => {
                self.set_flight(false, ctx);
                self.has_help = false;
                if let Some(document) = self.documents.get_mut(self.active) {
                    document.findings.selected = None;
                }
            }
        }
    }

    fn set_flight(&mut self, flies: bool, ctx: &egui::Context) {
        if flies == self.flight.is_some() {
            return;
        }
        self.flight = flies.then_some(FLIGHT_SPEED);
        let grab = if flies { CursorGrab::Locked } else { CursorGrab::None };
        ctx.send_viewport_cmd(ViewportCommand::CursorGrab(grab));
        ctx.send_viewport_cmd(ViewportCommand::CursorVisible(!flies));
    }

    /// Flies to where everything that is shown fills the picture.
    pub fn frame_all(&mut self) {
        let (bounds, aspect) = (self.stage.bounds(), self.stage.aspect(self.size));
        self.stage.rig.fly_to_bounds(&bounds, aspect);
    }

    fn frame_selected(&mut self) {
        let selected = self.document().and_then(|document| document.findings.selected);
        match selected {
            Some(index) => self.select_finding(index),
            None => self.frame_all(),
        }
    }

    fn select_finding(&mut self, index: usize) {
        let Some(document) = self.documents.get_mut(self.active) else { return };
        document.findings.selected = Some(index);
        let place = document.findings.places.get(index).copied().flatten();
        let radius = document.loaded.bounds.diagonal() * FINDING_RADIUS;
        if let Some(place) = place {
            self.stage.rig.fly_to_point(place, radius);
        }
    }

    fn toggle_frozen(&mut self) {
        let camera = self.stage.rig.camera();
        let document = self.documents.get_mut(self.active);
        if let Some(cut) = document.and_then(|document| document.cut.as_mut()) {
            cut.frozen = if cut.frozen.is_some() { None } else { Some(camera) };
        }
    }

    fn cycle_sides(&mut self) {
        let Some(document) = self.document().filter(|document| document.has_sides()) else {
            return;
        };
        self.show_side(match document.mode {
            ShownSide::Original => ShownSide::Level,
            ShownSide::Level => ShownSide::Both,
            ShownSide::Both => ShownSide::Original,
        });
    }

    fn show_side(&mut self, mode: ShownSide) {
        let before = self.stage.aspect(self.size);
        if let Some(document) = self.documents.get_mut(self.active) {
            document.mode = mode;
        }
        self.show_document();
        if before != self.stage.aspect(self.size) {
            self.frame_all();
        }
    }

    /// Shows the subjects of the active document.
    pub fn show_document(&mut self) {
        let shown = self.document().map(super::document::Document::shown).unwrap_or_default();
        self.stage.show(&shown);
        self.changes += 1;
    }

    fn close(&mut self, index: usize) {
        let document = self.documents.remove(index);
        let made = document.level.as_ref().map(|level| level.subject);
        for id in [Some(document.original), made].into_iter().flatten() {
            self.stage.remove(id);
        }
        if index < self.active {
            self.active -= 1;
        }
        self.active = self.active.min(self.documents.len().saturating_sub(1));
        self.note_open_files();
        self.show_document();
    }

    fn simplify(&mut self) {
        self.jobs.cancel(JobKind::Simplify);
        self.jobs.cancel(JobKind::Compare);
        let pose = self.stage.rig.pose();
        let height = f64::from(self.size[0].min(self.size[1]).max(1));
        let pixel = 2.0 * pose.distance * (self.stage.rig.fov_rad() / 2.0).tan() / height;
        let Some(document) = self.document() else { return };
        let order = document.order;
        let target = match order.goal {
            LevelGoal::Faces => Target::Faces(order.faces),
            LevelGoal::Error => {
                Target::Error(order.error_percent / 100.0 * document.loaded.bounds.diagonal())
            }
            LevelGoal::Pixels => Target::Error(order.pixels * pixel),
        };
        let (id, loaded) = (document.id, Arc::clone(&document.loaded));
        let (renderer, method) = (self.renderer(), order.method);
        self.jobs.start(JobKind::Simplify, "Simplifying", move |watch| {
            work::simplify(id, &loaded, method, target, &renderer, watch)
        });
    }

    fn compare(&mut self) {
        let Some(document) = self.document() else { return };
        let Some(DocumentLevel { loaded, subject, .. }) = &document.level else { return };
        let surface = |id: SubjectId, loaded: &Arc<_>| {
            let mesh = |subject: &Subject| subject.as_mesh().cloned();
            self.stage.subject(id).map(|subject| (id, Arc::clone(loaded), mesh(subject)))
        };
        let both = (surface(document.original, &document.loaded), surface(*subject, loaded));
        let ((Some(a), Some(b)), id) = (both, document.id) else { return };
        let renderer = self.renderer();
        self.jobs.start(JobKind::Compare, "Measuring the distance", move |watch| {
            work::compare(id, [a, b], &renderer, watch)
        });
    }

    fn check(&mut self) {
        let Some(document) = self.document() else { return };
        let (id, loaded) = (document.id, Arc::clone(&document.loaded));
        self.jobs.start(JobKind::Check, "Checking", move |watch| work::check(id, &loaded, watch));
    }

    /// Starts what the wanted colouring needs and the shown subjects lack.
    pub fn ensure_colors(&mut self) {
        let wanted = self.stage.display.coloring;
        if self.tried.first().is_some_and(|&(_, coloring)| coloring != wanted) {
            self.tried.clear();
        }
        // Each of these jobs gives back a whole subject: two at once would undo each other.
        let jobs = [JobKind::Compare, JobKind::Color, JobKind::Refine, JobKind::Simplify];
        if jobs.iter().any(|&kind| self.jobs.has(kind)) {
            return;
        }
        let Some(document) = self.document() else { return };
        if wanted == Coloring::Heat {
            let level = document.level.as_ref().filter(|level| level.distance.is_none());
            let Some(wish) = level.map(|level| (level.subject, wanted)) else { return };
            if !self.tried.contains(&wish) {
                self.tried.push(wish);
                self.compare();
            }
            return;
        }
        if !wanted.is_by_mesh_face() {
            return;
        }
        let level = document.level.as_ref().map(|level| (level.subject, Arc::clone(&level.loaded)));
        let own = [Some((document.original, Arc::clone(&document.loaded))), level];
        let shown: Vec<_> = self.stage.shown().collect();
        let lacking = own.into_iter().flatten().find_map(|(id, loaded)| {
            let subject = self.stage.subject(id).filter(|subject| !subject.has(wanted))?;
            let is_new = shown.contains(&id) && !self.tried.contains(&(id, wanted));
            let mesh = subject.as_mesh().filter(|_| is_new)?;
            Some((id, mesh.clone(), loaded))
        });
        let Some((id, mesh, loaded)) = lacking else { return };
        self.tried.push((id, wanted));
        let renderer = self.renderer();
        self.jobs.start(JobKind::Color, "Colouring", move |_| {
            work::color(id, mesh, &loaded, wanted, &renderer)
        });
    }

    /// Writes the picture to a file.
    pub fn save_picture(&mut self, path: PathBuf) {
        match self.pane.read() {
            Ok(Some(picture)) => {
                self.jobs.start(JobKind::Save, "Saving", move |_| work::save(&picture, path));
            }
            Ok(None) => {}
            Err(error) => self.complain(error.to_string()),
        }
    }

    /// Returns a path in the working directory that no file has yet.
    fn picture_path(&self) -> PathBuf {
        let name =
            self.document().map_or("meshlod".into(), |document| document.loaded.path.clone());
        let stem = name.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let numbered = (1..).map(|number| PathBuf::from(format!("{stem}-{number}.png")));
        numbered.into_iter().find(|path| !path.exists()).unwrap_or_default()
    }
}
