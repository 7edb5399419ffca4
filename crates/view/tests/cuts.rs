//! Cuts on the GPU: their uploads, and that they have no cracks.

mod common;

use std::sync::Arc;

use common::cracks::cracks;
use common::{bumpy, gpu};
use meshlod::Mesh;
use meshlod::model::SceneLayout;
use meshlod::multires::{Focus, Forest, HeightField, Hierarchy, Implicit, Rtin, ViewCamera};
use meshlod::picture::{Camera, Picture, View};
use meshlod::samples;
use meshlod_view::{
    Canvas, CutFollower, CutModel, CutQuery, CutTolerance, FollowOptions, Gpu, GpuCut, Renderer,
    Shade, TargetFormat, Transition,
};

/// A cut and the thread that follows its queries.
struct Subject {
    renderer: Renderer,
    cut: GpuCut,
    follower: CutFollower,
}

impl Subject {
    fn new(gpu: &Gpu, model: Arc<CutModel>) -> Self {
        let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
        let cut = GpuCut::new(&renderer, &model).unwrap();
        Self { renderer, cut, follower: CutFollower::start(model, FollowOptions::default()) }
    }

    fn follow(&mut self, focus: Focus, tolerance: CutTolerance, transition: Transition) {
        self.follower.ask(CutQuery { focus, tolerance });
        let step = self.follower.wait().unwrap().unwrap();
        assert!(step.is_done);
        self.cut.apply(&step, transition);
    }

    /// Draws the cut, and what dissolves in it after a share `t` of the transition.
    fn draw(&self, canvas: &Canvas, camera: &Camera, t: f32) -> Picture {
        let [whole, going, coming] = [1.0, t - 1.0, t].map(|shown| {
            let placement = self.renderer.placement();
            let shade = Shade { shown, ..Shade::default() };
            placement.set(camera, canvas.size(), self.cut.origin(), &shade);
            placement
        });
        canvas.draw(|pass| {
            self.cut.draw(&self.renderer, pass, &whole);
            self.cut.draw_fade(&self.renderer, pass, [&going, &coming]);
        });
        canvas.read().unwrap()
    }
}

fn of(levels: Hierarchy) -> Arc<CutModel> {
    Arc::new(CutModel::new(levels, &SceneLayout::default()).unwrap())
}

fn model(mesh: &Mesh) -> Arc<CutModel> {
    let forest = Forest::new(mesh, &Default::default()).unwrap();
    of(Implicit::new(&forest).unwrap().into())
}

fn view_camera(eye: [f64; 3], size: [u32; 2]) -> ViewCamera {
    ViewCamera { eye, look: [0.0; 3], up: [0.0, 1.0, 0.0], fov_rad: 0.8, viewport: size }
}

fn on_circle(angle: f64, radius: f64) -> [f64; 3] {
    [radius * angle.sin(), 0.3 * radius, radius * angle.cos()]
}

#[test]
fn a_small_orbit_uploads_little() {
    let Some(gpu) = gpu() else { return };
    let mut subject = Subject::new(gpu, model(&samples::knot(12_000)));
    let tolerance = |angle: f64| CutTolerance::Pixels {
        camera: view_camera(on_circle(angle, 9.0), [1920, 1080]),
        pixels: 1.0,
    };
    subject.follow(Focus::Everything, tolerance(0.0), Transition::Immediate);
    let all = subject.cut.take_uploaded();
    assert_eq!(all, 12 * subject.cut.faces() as u64, "the first cut as a whole");
    let step = 0.1f64.to_radians();
    for frame in 1..=20 {
        subject.follow(
            Focus::Everything,
            tolerance(step * f64::from(frame)),
            Transition::Immediate,
        );
        let part = subject.cut.take_uploaded() as f64 / subject.cut.index_bytes() as f64;
        assert!(part < 0.05, "{part} of the index buffer");
    }
}

#[test]
fn a_flight_over_a_height_field_uploads_little() {
    let Some(gpu) = gpu() else { return };
    let field = HeightField::from_mesh(&samples::terrain(12_000)).unwrap();
    let mut subject = Subject::new(gpu, of(Rtin::new(&field).into()));
    let tolerance = |angle: f64| CutTolerance::Pixels {
        camera: view_camera(on_circle(angle, 2.0), [1920, 1080]),
        pixels: 1.0,
    };
    subject.follow(Focus::Everything, tolerance(0.0), Transition::Immediate);
    assert!(subject.cut.take_uploaded() >= 12 * subject.cut.faces() as u64);
    for frame in 1..=20 {
        let angle = (0.1 * f64::from(frame)).to_radians();
        subject.follow(Focus::Everything, tolerance(angle), Transition::Immediate);
        let part = subject.cut.take_uploaded() as f64 / subject.cut.index_bytes() as f64;
        assert!(part < 0.05, "{part} of the index buffer");
    }
}

#[test]
fn no_cut_has_a_crack() {
    let Some(gpu) = gpu() else { return };
    let mut subject = Subject::new(gpu, model(&bumpy(12_000)));
    let canvas = Canvas::new(gpu, [512, 512]).unwrap();
    for (i, error) in [0.2, 0.03, 0.004, 0.0].into_iter().enumerate() {
        let near = Focus::Sphere { center: [1.0, 0.0, 0.0], radius: 0.7 };
        for focus in [Focus::Everything, near] {
            subject.follow(focus, CutTolerance::Uniform(error), Transition::Immediate);
            let eye = on_circle(1.7 * i as f64, 4.0);
            let camera = Camera::look_at(eye, [0.0; 3], [0.0, 1.0, 0.0], 0.8);
            let picture = subject.draw(&canvas, &camera, 1.0);
            assert_eq!(cracks(&picture), 0, "at {error}");
        }
    }
}

#[test]
fn a_transition_ends_where_an_immediate_change_does() {
    let Some(gpu) = gpu() else { return };
    let mesh = bumpy(6_000);
    let camera = Camera::fit_mesh(&mesh, &View::default());
    let canvas = Canvas::new(gpu, [256, 256]).unwrap();
    let mut subject = Subject::new(gpu, model(&mesh));
    let everything = || Focus::Everything;
    subject.follow(everything(), CutTolerance::Uniform(0.1), Transition::Immediate);
    let coarse = subject.draw(&canvas, &camera, 1.0);
    subject.follow(everything(), CutTolerance::Uniform(0.0), Transition::Dithered);
    assert!(subject.cut.is_fading());
    assert!(subject.draw(&canvas, &camera, 0.0) == coarse);
    let between = subject.draw(&canvas, &camera, 0.5);
    let end = subject.draw(&canvas, &camera, 1.0);
    assert!(between != coarse && between != end);
    let covers = |picture: &Picture, at: usize| picture.rgba()[4 * at + 3] == 255;
    let in_both = (0..256 * 256).filter(|&at| covers(&coarse, at) && covers(&end, at));
    assert_eq!(in_both.filter(|&at| !covers(&between, at)).count(), 0, "no hole opens meanwhile");
    subject.cut.finish_fade();
    assert!(subject.draw(&canvas, &camera, 1.0) == end);
    subject.follow(everything(), CutTolerance::Uniform(0.1), Transition::Immediate);
    subject.follow(everything(), CutTolerance::Uniform(0.0), Transition::Immediate);
    assert!(subject.draw(&canvas, &camera, 1.0) == end);
}
