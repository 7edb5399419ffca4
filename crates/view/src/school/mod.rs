//! School that swims, with levels beside full detail: what a window shows, without the window.

mod clock;
mod follow;
mod stats;

use std::sync::Arc;
use std::time::Instant;

use glam::Vec3;
use meshlod::flock::draw::WATER;
use meshlod::flock::levels::{Impostor, LevelTable, Look};
use meshlod::flock::select::{Budget, InstanceLevel, PolicyName, Selector};
use meshlod::flock::{Flock, FlockCamera};
use meshlod::picture::Lighting;
use meshlod_school::scene::{Film, Scenario};
use wgpu::RenderPass;

use self::clock::FilmClock;
use self::stats::cohesion;
pub use self::stats::{SchoolFrame, SchoolHistory};
use crate::placement::{Placement, Shade};
use crate::renderer::{Backdrop, Renderer};
use crate::stage::CameraRig;
use crate::{GpuFlock, GpuObstacles, ViewError};

/// Scene that runs: a simulation, the choice of levels, and both on the GPU, frame by frame.
///
/// The picture may be split: levels on the left, full detail on the right, by one camera.
pub struct SchoolShow {
    film: Film,
    table: Arc<LevelTable>,
    selector: Selector,
    policy: PolicyName,
    full: Selector,
    with_levels: GpuFlock,
    in_full: GpuFlock,
    obstacles: GpuObstacles,
    placement: Placement,
    water: Backdrop,
    size: [u32; 2],
    frame: Option<(Flock, FlockCamera)>,
    /// Camera of the film in the frame.
    path: Option<FlockCamera>,
    clock: FilmClock,
    before: Option<Instant>,
    history: SchoolHistory,
    /// Limits of the policy, and the size below which members are impostors.
    pub budget: Budget,
    /// Part of the width, from the left, that shows levels, beside full detail; `None` for levels
    /// alone.
    pub split: Option<f32>,
    /// The school stands still, while levels are still chosen.
    pub is_paused: bool,
    /// Time passes as on the clock, in whole frames of the scenario; by default, one a frame.
    pub is_live: bool,
    /// Camera that moves along with the first school, its target relative to the leader, in body
    /// lengths; `None` for the camera of the film.
    pub orbit: Option<CameraRig>,
    /// Lighting of members and obstacles.
    pub lighting: Lighting,
}

/// Frames of which figures are kept.
const HISTORY: usize = 600;

impl SchoolShow {
    /// Starts a scenario with the levels of a model.
    ///
    /// # Errors
    /// What the scenario refuses, materials that do not match the table, and data beyond the limits
    /// of the GPU.
    pub fn new(
        renderer: &Renderer,
        scenario: Scenario,
        table: &Arc<LevelTable>,
        look: &Look,
        impostor: Option<&Impostor>,
    ) -> Result<Self, ViewError> {
        let mut with_levels = GpuFlock::new(renderer, table, look)?;
        if let Some(impostor) = impostor {
            with_levels = with_levels.with_impostor(renderer, impostor)?;
        }
        let water = renderer.backdrop(WATER);
        Ok(Self {
            obstacles: GpuObstacles::new(renderer, &scenario.obstacle_meshes())?,
            size: scenario.size,
            film: Film::new(scenario)?,
            table: table.clone(),
            selector: Selector::new(PolicyName::Ours, table.clone()),
            policy: PolicyName::Ours,
            full: Selector::new(PolicyName::None, table.clone()),
            in_full: with_levels.sharing(),
            with_levels,
            placement: renderer.placement(),
            water: water.ok_or_else(|| ViewError::Failed("water has a colour".into()))?,
            frame: None,
            path: None,
            clock: FilmClock::default(),
            before: None,
            history: SchoolHistory::new(HISTORY),
            budget: Budget::default(),
            split: None,
            is_paused: false,
            is_live: false,
            orbit: None,
            lighting: Lighting::Headlight,
        })
    }

    /// Returns the policy that chooses levels.
    pub fn policy(&self) -> PolicyName {
        self.policy
    }

    /// Lets another policy choose levels from the next frame on.
    pub fn set_policy(&mut self, policy: PolicyName) {
        if policy != self.policy {
            self.policy = policy;
            self.selector = Selector::new(policy, self.table.clone());
        }
    }

    /// Sets the size of the picture in pixels from the next frame on; no side may be 0.
    pub fn resize(&mut self, size: [u32; 2]) {
        self.size = size.map(|side| side.max(1));
    }

    /// Moves an obstacle, in body lengths; members make room for it.
    ///
    /// # Errors
    /// An obstacle that does not exist, or a place that is not finite or too far away; then nothing
    /// has moved.
    pub fn move_obstacle(&mut self, obstacle: usize, by: Vec3) -> Result<(), ViewError> {
        self.film.move_obstacle(obstacle, by)?;
        self.obstacles.translate(obstacle, by.as_dvec3().to_array());
        Ok(())
    }

    /// Returns the scenario, with the obstacles where they are now.
    pub fn scenario(&self) -> &Scenario {
        self.film.scenario()
    }

    /// Returns the flock and the camera of the frame, once there is one.
    pub fn frame(&self) -> Option<(&Flock, &FlockCamera)> {
        self.frame.as_ref().map(|(flock, camera)| (flock, camera))
    }

    /// Returns the figures of the last frames.
    pub fn history(&self) -> &SchoolHistory {
        &self.history
    }

    /// Makes the next frame: simulates, chooses levels, uploads, and counts.
    ///
    /// # Errors
    /// What the simulation and the camera refuse, and more members than the GPU can hold.
    pub fn advance(&mut self) -> Result<(), ViewError> {
        let start = Instant::now();
        let since = |start: Instant| 1e3 * start.elapsed().as_secs_f64();
        let frame_ms = self.before.replace(start).map_or(0.0, since);
        self.simulate()?;
        let Some((flock, camera)) = &self.frame else { return Ok(()) };
        let simulate_ms = since(start);
        let start = Instant::now();
        let levels = self.selector.select(flock, camera, &self.budget);
        let select_ms = since(start);
        self.with_levels.set(flock, levels, camera)?;
        let shown = levels.iter().filter(|level| **level != InstanceLevel::HIDDEN).count();
        if self.split.is_some() {
            let levels = self.full.select(flock, camera, &Budget::default());
            self.in_full.set(flock, levels, camera)?;
        }
        let [relative_speed, agreement] = cohesion(flock, &self.film.scenario().simulation.schools);
        self.history.push(SchoolFrame {
            triangles: self.with_levels.triangles(),
            full_triangles: (shown * self.table.triangle_count(0)) as u64,
            members: shown,
            simulate_ms,
            select_ms,
            frame_ms,
            relative_speed,
            agreement,
        });
        let shade = Shade { lighting: self.lighting, ..Shade::default() };
        let origin = self.with_levels.origin();
        self.placement.set(&camera.for_picture(), self.size, origin, &shade);
        self.obstacles.set(camera, self.size, &shade);
        Ok(())
    }

    /// Moves the school on unless it is paused, and fits the camera to the size of the picture.
    fn simulate(&mut self) -> Result<(), ViewError> {
        for _ in 0..self.film_frames() {
            let (flock, camera) = self.film.next_frame()?;
            self.path = Some(camera);
            match &mut self.frame {
                Some(frame) => frame.0.clone_from(flock),
                none => *none = Some((flock.clone(), camera)),
            }
        }
        if let (Some((flock, camera)), Some(path)) = (&mut self.frame, &self.path) {
            *camera = match &self.orbit {
                Some(rig) => follow::camera(rig, flock, self.size)?,
                None => follow::fitted(path, self.size)?,
            };
        }
        Ok(())
    }

    /// Returns the number of frames of the film that pass in this frame.
    fn film_frames(&mut self) -> usize {
        let elapsed_s = self.clock.lap();
        match (&self.frame, self.is_paused, self.is_live) {
            (None, ..) | (_, false, false) => 1,
            (_, true, _) => 0,
            (_, false, true) => self.clock.frames(elapsed_s, self.film.scenario().frame_s),
        }
    }

    /// Draws the frame into a pass of the size of the picture.
    pub fn draw(&self, renderer: &Renderer, pass: &mut RenderPass<'_>) {
        let [width, height] = self.size;
        let share = self.split.map_or(1.0, |share| if share >= 0.0 { share.min(1.0) } else { 0.0 });
        let left = (share * width as f32).round() as u32;
        let parts = [(&self.with_levels, 0..left), (&self.in_full, left..width)];
        for (flock, columns) in parts {
            if !columns.is_empty() {
                pass.set_scissor_rect(columns.start, 0, columns.len() as u32, height);
                flock.draw(renderer, pass, &self.placement);
            }
        }
        pass.set_scissor_rect(0, 0, width, height);
        self.obstacles.draw(renderer, pass);
        renderer.draw_backdrop(pass, &self.water);
    }
}
