//! A camera flies past a model in a `.mlod` file, and a cut follows it: one pixel of error in every
//! frame, and only the triangles that changed are touched.
//!
//! `cargo run --release -p meshlod --example follow`

use std::error::Error;

use meshlod::jobs::{BuildRequest, build};
use meshlod::multires::{ModelFile, Query, UpdateLimits, ViewCamera};
use meshlod::{Scene, samples};

fn main() -> Result<(), Box<dyn Error>> {
    let knot = samples::knot(40_000);
    let scene = Scene::from_mesh("knot", knot.clone());
    let (file, _) = build(scene, &BuildRequest::default(), &())?;
    let model = ModelFile::open(file)?.read()?;

    let diagonal = knot.bounds().diagonal();
    let mut cut = model.cut();
    println!("{:>5}  {:>8}  {:>7}  {:>7}", "frame", "distance", "faces", "changed");
    for frame in 0..12 {
        let distance = diagonal * (0.6 + 0.4 * f64::from(frame));
        let eye = [0.2 * distance, 0.1 * distance, distance];
        let (look, up) = ([0.0; 3], [0.0, 1.0, 0.0]);
        let camera = ViewCamera { eye, look, up, fov_rad: 0.8, viewport: [1280, 720] };
        cut.update(&Query::pixels(camera, 1.0), &UpdateLimits::default())?;
        // A renderer would write these slots of its index buffer.
        let changed = cut.slot_mesh().patches().count();
        println!("{frame:>5}  {distance:>8.2}  {:>7}  {changed:>7}", cut.slot_mesh().face_count());
    }
    Ok(())
}
