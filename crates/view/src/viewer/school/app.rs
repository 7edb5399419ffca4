//! The window of a school: its state, and the order of a frame.

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use eframe::egui_wgpu::RenderState;
use glam::Vec3;
use meshlod::flock::FlockCamera;
use meshlod::picture::UpAxis;
use meshlod_school::scene::ScenarioName;

use super::controls::Controls;
use super::drag::PickedObstacle;
use super::report::{SchoolOutcome, Totals};
use super::stage_thread::ComingScene;
use super::{SchoolReport, SchoolWindowOptions, panel};
use crate::stage::{CameraRig, RigPose};
use crate::viewer::canvas_texture::CanvasTexture;
use crate::viewer::gpu_guard::GpuGuard;
use crate::viewer::theme;
use crate::viewer::timing::FrameTimes;
use crate::{Gpu, Renderer, SchoolShow, TargetFormat, ViewError};

/// Number of frames after which a picture is written.
const FRAMES_BEFORE_PICTURE: usize = 30;
/// Time for which a line about a problem stays.
const NOTICE_TIME: Duration = Duration::from_secs(8);

/// Everything that the window shows and does.
pub(crate) struct SchoolApp {
    options: SchoolWindowOptions,
    state: RenderState,
    pub renderer: Arc<Renderer>,
    guard: GpuGuard,
    pub show: Option<Box<SchoolShow>>,
    pub coming: Option<ComingScene>,
    pub controls: Controls,
    /// Camera that moves along with the school; `None` for the path of the film.
    pub orbit: Option<CameraRig>,
    /// Obstacle that the pointer holds.
    pub held: Option<PickedObstacle>,
    pub pane: CanvasTexture,
    /// Size of the picture in pixels.
    pub size: [u32; 2],
    /// Number of faces of all members in full detail.
    pub full_faces: usize,
    pub times: FrameTimes,
    totals: Totals,
    problems: Vec<String>,
    last_problem: Option<Instant>,
    close_at: Option<Instant>,
    has_picture: bool,
    outcome: Arc<Mutex<SchoolOutcome>>,
}

impl SchoolApp {
    /// Takes over a window that has just opened.
    pub fn new(
        context: &eframe::CreationContext<'_>,
        options: SchoolWindowOptions,
        outcome: Arc<Mutex<SchoolOutcome>>,
    ) -> Result<Self, ViewError> {
        let state = context.wgpu_render_state.clone().ok_or(ViewError::NoGpu)?;
        let gpu = Gpu::new(&state.adapter, state.device.clone(), state.queue.clone());
        let guard = GpuGuard::of(&gpu, &context.egui_ctx);
        let renderer = Arc::new(Renderer::new(&gpu, TargetFormat::CANVAS));
        theme::apply(&context.egui_ctx);
        let scenario = options.scenario.clone();
        let schools = &scenario.simulation.schools;
        let members: usize = schools.iter().map(|school| school.members).sum();
        let full_faces = members.saturating_mul(options.table.triangle_count(0));
        let name = scenario.name;
        let ctx = &context.egui_ctx;
        let coming = ComingScene::start(name, Some(scenario), &renderer, &options, ctx);
        Ok(Self {
            controls: Controls::new(options.policy, options.triangles),
            coming: Some(coming),
            options,
            state,
            renderer,
            guard,
            show: None,
            orbit: None,
            held: None,
            pane: CanvasTexture::default(),
            size: [0; 2],
            full_faces,
            times: FrameTimes::new(Instant::now()),
            totals: Totals::default(),
            problems: Vec::new(),
            last_problem: None,
            close_at: None,
            has_picture: false,
            outcome,
        })
    }

    /// Returns the scene that is shown, or is about to be.
    pub fn scene(&self) -> ScenarioName {
        let shown = self.show.as_ref().map(|show| show.scenario().name);
        let coming = self.coming.as_ref().map(|coming| coming.name);
        coming.or(shown).unwrap_or(self.options.scenario.name)
    }

    /// Sets up another scene, or the same one anew; the one that is shown goes on meanwhile.
    pub fn switch_to(&mut self, name: ScenarioName, ctx: &egui::Context) {
        let coming = ComingScene::start(name, None, &self.renderer, &self.options, ctx);
        self.coming = Some(coming);
    }

    /// Shows a line about what went wrong, and keeps it for the report.
    pub fn complain(&mut self, text: String) {
        self.last_problem = Some(Instant::now());
        if self.problems.last() != Some(&text) {
            self.problems.push(text);
        }
    }

    /// Returns the line about what went wrong lately.
    pub fn notice(&self) -> Option<&str> {
        let is_recent = self.last_problem.is_some_and(|at| at.elapsed() < NOTICE_TIME);
        self.problems.last().filter(|_| is_recent).map(String::as_str)
    }

    /// Changes between the path of the film and an orbit that begins where the camera is.
    pub fn toggle_orbit(&mut self) {
        match self.orbit {
            Some(_) => self.orbit = None,
            None => self.start_orbit(),
        }
    }

    /// Takes the camera off the path of the film, where it is.
    pub fn start_orbit(&mut self) {
        if self.orbit.is_some() {
            return;
        }
        let frame = self.show.as_ref().and_then(|show| show.frame());
        self.orbit = frame.map(|(flock, camera)| {
            let leader = flock.schools.first().map_or(Vec3::ZERO, |school| school.leader);
            rig_of(camera, leader)
        });
    }

    /// Makes and draws the next frame of the scene.
    pub fn make_frame(&mut self) {
        let Some(show) = &mut self.show else { return };
        if self.size.contains(&0) {
            return;
        }
        self.controls.apply(show);
        show.orbit.clone_from(&self.orbit);
        show.resize(self.size);
        let drawn = show
            .advance()
            .and_then(|()| self.pane.canvas(&self.renderer, &self.state, self.size))
            .map(|canvas| canvas.draw(|pass| show.draw(&self.renderer, pass)));
        if let Some(frame) = show.history().last() {
            self.totals.add(frame);
        }
        if let Err(error) = drawn {
            self.complain(error.to_string());
        }
    }

    /// Shows the scene that was set up. One that fails at the start closes the window.
    fn take_scene(&mut self, ctx: &egui::Context) {
        let Some(done) = self.coming.as_ref().and_then(ComingScene::take) else { return };
        self.coming = None;
        match done {
            Ok(show) => {
                (self.show, self.orbit, self.held) = (Some(show), None, None);
                self.times.rest();
            }
            Err(text) if self.show.is_none() => self.fail(ViewError::Failed(text), ctx),
            Err(text) => self.complain(text),
        }
    }

    /// Closes the window because of an error.
    fn fail(&mut self, error: ViewError, ctx: &egui::Context) {
        if let Ok(mut outcome) = self.outcome.lock() {
            outcome.error.get_or_insert(error);
        }
        ctx.send_viewport_cmd(egui::ViewportCommand::Close);
    }

    fn watch_gpu(&mut self, ctx: &egui::Context) {
        for error in self.guard.take_errors() {
            self.complain(format!("GPU: {error}"));
        }
        if self.guard.is_lost() {
            self.fail(ViewError::Failed("it was lost".into()), ctx);
        }
    }

    /// Writes the picture that was asked for, and closes the window when it is time.
    fn keep_schedule(&mut self, ctx: &egui::Context) {
        if self.totals.frames() == 0 {
            return;
        }
        let seconds = self.options.seconds.map(|seconds| seconds.clamp(0.0, 1e6));
        let wait = seconds.map(Duration::from_secs_f64);
        let end = wait.map(|wait| *self.close_at.get_or_insert(Instant::now() + wait));
        let is_over = end.is_some_and(|end| Instant::now() >= end);
        let wants_picture = self.options.screenshot.is_some() && !self.has_picture;
        if wants_picture && (is_over || self.totals.frames() >= FRAMES_BEFORE_PICTURE) {
            self.save_picture();
        }
        if is_over || (self.has_picture && end.is_none()) {
            ctx.send_viewport_cmd(egui::ViewportCommand::Close);
        }
    }

    fn save_picture(&mut self) {
        self.has_picture = true;
        let Some(path) = self.options.screenshot.clone() else { return };
        let written = match self.pane.read() {
            Ok(Some(picture)) => {
                std::fs::write(&path, picture.png()).map_err(|error| error.to_string())
            }
            Ok(None) => Err("there is no picture yet".into()),
            Err(error) => Err(error.to_string()),
        };
        if let Err(error) = written {
            self.complain(format!("{}: {error}", path.display()));
        }
    }

    fn report(&self) -> SchoolReport {
        let [median_frame_ms, longest_frame_ms] = self.times.summary();
        let scenario = self.show.as_ref().map_or(&self.options.scenario, |show| show.scenario());
        let schools = &scenario.simulation.schools;
        let mut report = SchoolReport {
            gpu: self.renderer.gpu().name().to_owned(),
            camera: scenario.name.name().into(),
            policy: self.controls.policy.name().into(),
            members: schools.iter().map(|school| school.members).sum(),
            schools: schools.len(),
            size: self.size,
            median_frame_ms,
            longest_frame_ms,
            problems: self.problems.clone(),
            ..SchoolReport::default()
        };
        self.totals.write(&mut report);
        report
    }
}

impl eframe::App for SchoolApp {
    fn logic(&mut self, ctx: &egui::Context, _: &mut eframe::Frame) {
        self.watch_gpu(ctx);
        self.take_scene(ctx);
        self.keep_schedule(ctx);
    }

    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        if self.show.is_some() {
            self.times.begin(false);
        }
        let ctx = ui.ctx().clone();
        self.take_keys(&ctx);
        panel::show(self, ui);
        self.show_center(ui);
        panel::help(self, &ctx);
        match self.show {
            Some(_) => ctx.request_repaint(),
            None => ctx.request_repaint_after(Duration::from_millis(60)),
        }
    }

    fn on_exit(&mut self) {
        if let Ok(mut outcome) = self.outcome.lock() {
            outcome.report = self.report();
        }
    }
}

/// Returns the rig that sees what a camera sees, around a point as far away as the leader, with its
/// target relative to the leader.
fn rig_of(camera: &FlockCamera, leader: Vec3) -> CameraRig {
    let (eye, forward) = (camera.eye(), camera.axes()[2]);
    let distance = (leader - eye).length().max(0.5);
    let mut rig = CameraRig::new(UpAxis::Y);
    rig.set_fov_rad(camera.fov_rad().into());
    rig.set_pose(RigPose {
        target: (eye + forward * distance - leader).as_dvec3().into(),
        distance: distance.into(),
        yaw_rad: f64::from(-forward.x).atan2((-forward.z).into()),
        pitch_rad: f64::from(forward.y).clamp(-1.0, 1.0).asin(),
    });
    rig
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_orbit_begins_where_the_film_is() {
        let eye = Vec3::new(3.0, 4.0, -5.0);
        let camera = FlockCamera::look_along(eye.into(), [-0.6, -0.3, 0.7], 0.8, [4, 3]).unwrap();
        let leader = Vec3::new(1.0, 3.0, -2.0);
        let seen = rig_of(&camera, leader).camera();
        let seen_eye = glam::DVec3::from(seen.eye()) + leader.as_dvec3();
        assert!((seen_eye - eye.as_dvec3()).length() < 1e-5);
        let forward = glam::DVec3::from(seen.forward());
        assert!((forward - camera.axes()[2].as_dvec3()).length() < 1e-5);
    }
}
