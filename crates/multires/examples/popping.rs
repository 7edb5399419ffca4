//! Measures how much the picture jumps when a cut follows an orbit, with and without a geomorph.
//!
//! `cargo run --release -p meshlod-multires --example popping [MESH…]`; the default is the shared
//! bunny. Between two cuts the camera stands still: it is the later one's. Cuts change by a degree at
//! a pixel, in pictures of 512 by 512.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Duration;

use meshlod_io::ReadOptions;
use meshlod_mesh::{LayerKind, Mesh};
use meshlod_multires::{Forest, Geomorph, Implicit, Query, SlotMesh, UpdateLimits, ViewCamera};
use meshlod_picture::{Camera, Normals, Paint, Picture, Style, flip, render};
use meshlod_simplify::Options;

type Failure = Box<dyn Error + Send + Sync>;

const SIDE: u32 = 512;
const FOV_RAD: f64 = std::f64::consts::FRAC_PI_4;
const STEP_RAD: f64 = std::f64::consts::PI / 180.0;
const STEPS: u32 = 40;

/// Time that a vertex moves.
const BLEND: Duration = Duration::from_millis(250);
/// Time between two pictures of the blend.
const FRAME: Duration = Duration::from_micros(16_667);

fn main() -> Result<(), Failure> {
    let mut paths: Vec<PathBuf> = std::env::args().skip(1).map(PathBuf::from).collect();
    if paths.is_empty() {
        paths.push(meshlod_fixtures::shared_mesh("bunny.ply").ok_or("name a mesh")?);
    }
    println!("| mesh | changed triangles | pop: FLIP, levels | first frame: FLIP, levels |");
    println!("|---|--:|--:|--:|");
    paths.iter().try_for_each(|path| measure(path))
}

/// Sums over an orbit.
#[derive(Default)]
struct Jumps {
    changed: usize,
    /// Perceived difference and levels of 255, by pixels, from the cut before to the cut after.
    pop: [f64; 2],
    /// The difference to the first frame of the blend.
    first: [f64; 2],
}

fn measure(path: &Path) -> Result<(), Failure> {
    let scene = meshlod_io::read(path, &ReadOptions::default())?;
    let mesh = &scene.meshes.first().ok_or("the file has no mesh")?.mesh;
    let mt = Implicit::new(&Forest::new(mesh, &Options::default())?)?;
    let mut morph = Geomorph::new(&mt, BLEND)?;
    let uv = mesh.attributes.as_ref().and_then(|all| all.layer(LayerKind::Uv(0)));
    // Smooth normals would be those of other vertices once one is split, even where it has not moved.
    let style = Style {
        size: [SIDE; 2],
        normals: Normals::Flat,
        paint: if uv.is_some() { Paint::Checker { squares: 16 } } else { Paint::default() },
        ..Style::comparison()
    };
    let mut jumps = Jumps::default();
    for step in 0..=STEPS {
        let (view, camera) = cameras(mesh, f64::from(step) * STEP_RAD);
        let before = render(&morph.mesh(), &camera, &style)?;
        morph.update(&Query::pixels(view, 1.0), &UpdateLimits::default())?;
        let changed = morph.goal().patches().count();
        morph.advance(FRAME);
        let first = render(&morph.mesh(), &camera, &style)?;
        morph.advance(BLEND);
        let after = render(&morph.mesh(), &camera, &style)?;
        // The first cut comes from the base mesh.
        if step > 0 {
            jumps.changed += changed;
            add(&mut jumps.pop, difference(&before, &after)?);
            add(&mut jumps.first, difference(&before, &first)?);
        }
    }
    let per = |sums: [f64; 2]| sums.map(|sum| sum / jumps.changed.max(1) as f64);
    let ([pop, pop_levels], [first, first_levels]) = (per(jumps.pop), per(jumps.first));
    println!(
        "| {} | {} | {pop:.3}, {pop_levels:.2} | {first:.3}, {first_levels:.2} |",
        path.file_stem().unwrap_or_default().to_string_lossy(),
        jumps.changed,
    );
    Ok(())
}

fn add(sums: &mut [f64; 2], more: [f64; 2]) {
    sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
}

/// Returns the cameras of the query and of the picture, at an angle around the model.
fn cameras(mesh: &Mesh, angle: f64) -> (ViewCamera, Camera) {
    let bounds = mesh.bounds();
    let (look, up) = (bounds.center(), [0.0, 1.0, 0.0]);
    let distance = 0.6 * bounds.diagonal() / (FOV_RAD / 2.0).tan();
    let eye = [look[0] + distance * angle.sin(), look[1], look[2] + distance * angle.cos()];
    let view = ViewCamera { eye, look, up, fov_rad: FOV_RAD, viewport: [SIDE; 2] };
    (view, Camera::look_at(eye, look, up, FOV_RAD))
}

/// Returns the perceived difference of two pictures and the mean one of a channel in levels of 255,
/// as sums over the pixels.
fn difference(before: &Picture, after: &Picture) -> Result<[f64; 2], Failure> {
    let perceived = flip(before, after)?.iter().map(|&error| f64::from(error)).sum();
    let channels = before.rgba().iter().zip(after.rgba());
    let levels: f64 = channels.map(|(a, b)| f64::from(a.abs_diff(*b))).sum();
    Ok([perceived, levels / 3.0])
}
