//! Film of a script: every frame of a stage as a picture, with its figures.

use std::time::Instant;

use meshlod::mesh::Bounds;
use meshlod::multires::Focus;
use meshlod::picture::Picture;
use serde::Serialize;

use super::Script;
use super::key::Pose;
use crate::stage::{CameraRig, LevelsSubject, Loaded, RigPose, Stage, Subject, SubjectId};
use crate::{Canvas, CutQuery, CutTolerance, Gpu, Renderer, TargetFormat, ViewError, view_camera};

/// Film of a file, drawn frame by frame without a window.
#[derive(Debug)]
pub struct ScriptFilm {
    script: Script,
    renderer: Renderer,
    canvas: Canvas,
    stage: Stage,
    subject: SubjectId,
    /// Pose in which the model fills the picture.
    framed: RigPose,
    bounds: Bounds,
    frame: u32,
}

/// Picture of a film, with its figures; serde writes only the figures.
#[derive(Debug, Serialize)]
pub struct ScriptFrame {
    /// Number of the frame, from 0.
    pub frame: u32,
    /// The picture.
    #[serde(skip)]
    pub picture: Picture,
    /// Number of faces drawn.
    pub faces: usize,
    /// Bytes that were sent to the GPU for this frame: changes of a cut.
    pub sent_bytes: u64,
    /// Size of the cut in the index buffer, in bytes; 0 without a cut.
    pub index_bytes: u64,
    /// Time that the cut took to change, in milliseconds; 0 without a cut.
    pub cut_ms: f64,
    /// Time of uploading and drawing, until the GPU was done, in milliseconds.
    pub draw_ms: f64,
}

/// Default error of a cut, in pixels.
const PIXELS: f64 = 1.0;

impl ScriptFilm {
    /// Uploads a file for a script.
    ///
    /// # Errors
    /// A file or a size beyond the limits of the GPU.
    pub fn new(gpu: &Gpu, script: Script, loaded: &Loaded) -> Result<Self, ViewError> {
        let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
        let canvas = Canvas::new(gpu, script.size)?;
        let mut rig = CameraRig::new(script.up());
        rig.set_fov_rad(script.fov.to_radians());
        let [width, height] = script.size.map(f64::from);
        rig.frame(&loaded.bounds, width / height);
        let framed = rig.pose();
        let mut stage = Stage::default();
        (stage.rig, stage.display) = (rig, script.display());
        let mut subject = Subject::new(&renderer, loaded)?;
        let wanted = stage.display.coloring;
        if let Subject::Mesh(mesh) = &mut subject {
            mesh.color_faces(&renderer, &loaded.mesh, wanted)?;
        }
        if !subject.has(wanted) {
            return Err(ViewError::NoColors(wanted.name()));
        }
        let subject = stage.add(subject);
        stage.show(&[subject]);
        let bounds = loaded.bounds;
        Ok(Self { script, renderer, canvas, stage, subject, framed, bounds, frame: 0 })
    }

    /// Draws the next frame; `None` at the end.
    ///
    /// # Errors
    /// A query that a cut refuses, or a GPU that was lost.
    pub fn next_frame(&mut self) -> Option<Result<ScriptFrame, ViewError>> {
        let frame = self.frame;
        self.frame += 1;
        (frame < self.script.frames).then(|| self.draw(frame))
    }

    fn draw(&mut self, frame: u32) -> Result<ScriptFrame, ViewError> {
        let pose = self.script.pose(frame);
        self.stage.rig.set_pose(RigPose {
            target: pose.target.unwrap_or(self.framed.target),
            distance: self.framed.distance * pose.distance,
            yaw_rad: pose.yaw.to_radians(),
            pitch_rad: pose.pitch.to_radians(),
        });
        let query = self.query(&pose);
        let (mut sent_bytes, mut index_bytes, mut cut_ms) = (0, 0, 0.0);
        if let Some(Subject::Levels(levels)) = self.stage.subject_mut(self.subject) {
            cut_ms = follow(levels, query)?;
            (sent_bytes, index_bytes) = (levels.take_uploaded(), levels.cut().index_bytes());
        }
        self.stage.prepare(&self.renderer)?;
        let start = Instant::now();
        let (stage, renderer, size) = (&mut self.stage, &self.renderer, self.canvas.size());
        self.canvas.draw(|pass| stage.draw(renderer, pass, size));
        self.renderer.gpu().wait()?;
        let draw_ms = start.elapsed().as_secs_f64() * 1e3;
        let faces = self.stage.subject(self.subject).map_or(0, Subject::faces);
        let picture = self.canvas.read()?;
        Ok(ScriptFrame { frame, picture, faces, sent_bytes, index_bytes, cut_ms, draw_ms })
    }

    /// Returns the query of a cut: by faces or by error where the script gives one, else by pixels.
    fn query(&self, pose: &Pose) -> CutQuery {
        let camera = view_camera(&self.stage.rig.camera(), self.script.size);
        let tolerance = match (pose.faces, pose.error) {
            (Some(faces), _) => CutTolerance::Faces(faces as usize),
            (None, Some(part)) => CutTolerance::Uniform(part * self.bounds.diagonal()),
            (None, None) => CutTolerance::Pixels { camera, pixels: pose.pixels.unwrap_or(PIXELS) },
        };
        CutQuery { focus: pose.focus(Focus::Frustum(camera)), tolerance }
    }
}

/// Changes the cut until it answers a query, and returns the time in milliseconds.
fn follow(levels: &mut LevelsSubject, query: CutQuery) -> Result<f64, ViewError> {
    let start = Instant::now();
    levels.ask(query);
    levels.finish()?;
    Ok(start.elapsed().as_secs_f64() * 1e3)
}
