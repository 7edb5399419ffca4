//! Actions and commands, carried out.

use std::path::PathBuf;

use egui::{CursorGrab, ViewportCommand};
use meshlod::picture::UpAxis;

use super::action::Action;
use super::document::{Document, ShownSide};
use super::input::{Command, OrbitStep, commands};
use super::state::ViewerState;
use crate::stage::Shading;

/// Turn of the keys 2, 4, 6 and 8, in radians.
const ORBIT_STEP: f64 = std::f64::consts::PI / 12.0;
/// Speed of a flight at its start, in diagonals per second.
const FLIGHT_SPEED: f64 = 0.4;
/// Radius of the view of a finding, relative to the diagonal.
const FINDING_RADIUS: f64 = 0.03;

impl ViewerState {
    /// Opens the files that were dropped on the window.
    pub fn take_dropped_files(&mut self, ctx: &egui::Context) {
        let dropped = ctx.input_mut(|input| std::mem::take(&mut input.raw.dropped_files));
        for file in dropped {
            self.open(file.path().to_owned());
        }
    }

    /// Carries out the commands of the keys of this frame, unless a text field has the focus.
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

    /// Flies to where all shown subjects fill the picture.
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
        let shown = self.document().map(Document::shown).unwrap_or_default();
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

    /// Returns an unused path in the working directory.
    fn picture_path(&self) -> PathBuf {
        let name =
            self.document().map_or("meshlod".into(), |document| document.loaded.path.clone());
        let stem = name.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let numbered = (1..).map(|number| PathBuf::from(format!("{stem}-{number}.png")));
        numbered.into_iter().find(|path| !path.exists()).unwrap_or_default()
    }
}
