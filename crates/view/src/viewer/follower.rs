//! Cut of a multiresolution model that follows a query on a thread of its own.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::time::{Duration, Instant};

use meshlod::OwnedPaint;
use meshlod::multires::{Cut, Focus, Model, Query, Tolerance, UpdateLimits, ViewCamera};
use meshlod::picture::Normals;

use crate::Renderer;
use crate::stage::{Loaded, Subject};

/// Thread that owns a cut. Of the queries that arrive while it works only the last one counts.
#[derive(Debug)]
pub(crate) struct LevelFollower {
    wishes: Sender<(CutQuery, Arc<Renderer>)>,
    cuts: Receiver<(Subject, CutFacts)>,
    last: Option<CutQuery>,
}

/// Query for a cut.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CutQuery {
    pub focus: CutFocus,
    pub tolerance: CutTolerance,
}

/// Region in which a cut is fine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum CutFocus {
    Everything,
    View(ViewCamera),
    Point([f64; 3]),
    Box([[f64; 3]; 2]),
    Sphere([f64; 3], f64),
}

/// How fine a cut is in its focus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum CutTolerance {
    /// Error in model units.
    Length(f64),
    /// Error in pixels of a camera.
    Pixels(ViewCamera, f64),
}

/// What an update of the cut did.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CutFacts {
    pub faces: usize,
    pub splits: usize,
    pub merges: usize,
    /// Time of the update alone.
    pub update: Duration,
    /// Time with making and uploading the mesh.
    pub total: Duration,
}

impl LevelFollower {
    pub fn new(model: Arc<Model>, wake: &egui::Context) -> Self {
        let (wishes, wished) = channel();
        let (made, cuts) = channel();
        let wake = wake.clone();
        // It ends when this value is dropped and its channels close.
        std::thread::spawn(move || follow(&model, &wished, &made, &wake));
        Self { wishes, cuts, last: None }
    }

    /// Asks for a cut, unless it is the one asked for last.
    pub fn ask(&mut self, query: CutQuery, renderer: &Arc<Renderer>) {
        if self.last.as_ref() != Some(&query) {
            self.last = Some(query.clone());
            // A thread that ended has said so by a closed channel; there is nobody to ask.
            let _ = self.wishes.send((query, Arc::clone(renderer)));
        }
    }

    /// Returns the latest cut that was made since the last call.
    pub fn poll(&mut self) -> Option<(Subject, CutFacts)> {
        self.cuts.try_iter().last()
    }
}

fn follow(
    model: &Model,
    wished: &Receiver<(CutQuery, Arc<Renderer>)>,
    made: &Sender<(Subject, CutFacts)>,
    wake: &egui::Context,
) {
    let mut cut = model.cut();
    while let Ok(mut wish) = wished.recv() {
        loop {
            match wished.try_recv() {
                Ok(later) => wish = later,
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => return,
            }
        }
        let (query, renderer) = wish;
        if let Some(answer) = update(&mut cut, &query, &renderer) {
            if made.send(answer).is_err() {
                return;
            }
            wake.request_repaint();
        }
    }
}

/// Updates the cut and uploads it; `None` for a query without an answer.
fn update(cut: &mut Cut<'_>, query: &CutQuery, renderer: &Renderer) -> Option<(Subject, CutFacts)> {
    let start = Instant::now();
    let change = cut.update(&query.query(), &UpdateLimits::default()).ok()?;
    let updated = start.elapsed();
    let loaded = Loaded::from_mesh("cut", cut.level().mesh(), Arc::new(OwnedPaint::CLAY));
    let loaded = Loaded { normals: Normals::Smooth, ..loaded };
    let subject = Subject::new(renderer, &loaded).ok()?;
    let facts = CutFacts {
        faces: loaded.mesh.faces.len(),
        splits: change.splits,
        merges: change.merges,
        update: updated,
        total: start.elapsed(),
    };
    Some((subject, facts))
}

impl CutQuery {
    fn query(&self) -> Query<'static> {
        let focus = match self.focus {
            CutFocus::Everything => Focus::Everything,
            CutFocus::View(camera) => Focus::Frustum(camera),
            CutFocus::Point(point) => Focus::Point(point),
            CutFocus::Box(corners) => Focus::Box(corners),
            CutFocus::Sphere(center, radius) => Focus::Sphere { center, radius },
        };
        let tolerance = match self.tolerance {
            CutTolerance::Length(most) => Tolerance::Uniform(most),
            CutTolerance::Pixels(camera, pixels) => Tolerance::Pixels { camera, pixels },
        };
        Query { focus, tolerance }
    }
}

/// Returns a camera of pictures as queries take it, for a picture of a size in pixels.
pub(crate) fn view_camera(camera: &meshlod::picture::Camera, size: [u32; 2]) -> ViewCamera {
    let [_, up, forward] = camera.axes();
    let eye = camera.eye();
    let size = size.map(|side| side.max(1));
    let shorter = f64::from(size[0].min(size[1]));
    let tangent = camera.tan_half_fov() * f64::from(size[1]) / shorter;
    let look = [0, 1, 2].map(|k| eye[k] + forward[k]);
    ViewCamera { eye, look, up, fov_rad: 2.0 * tangent.atan(), viewport: size }
}
