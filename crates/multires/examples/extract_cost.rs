//! Measures what attributes cost when levels are extracted: the speed beside the bare model, and memory.
//!
//! `cargo run --release -p meshlod-multires --example extract_cost [MESH]`; the default is the shared
//! igea. The mesh gets normals and six charts of texture coordinates, and comes back from a file. The
//! figures are the processor's time of one thread.

use std::error::Error;

use cpu_time::ThreadTime;
use glam::DVec3;
use meshlod_io::ReadOptions;
use meshlod_mesh::{Layer, LayerKind, Mesh};
use meshlod_multires::{Archive, Extractor, Forest, Implicit, Model, Query, Storage, ViewCamera};
use meshlod_simplify::Options;

type Failure = Box<dyn Error + Send + Sync>;

const ROUNDS: u32 = 15;
const PIXELS: f64 = 0.5;
const VIEWPORT: [u32; 2] = [1920, 1080];
const FOV_RAD: f64 = 0.8;

fn main() -> Result<(), Failure> {
    let path = std::env::args().nth(1).map(Into::into);
    let path = path.or_else(|| meshlod_fixtures::shared_mesh("igea.ply")).ok_or("name a mesh")?;
    let scene = meshlod_io::read(&path, &ReadOptions::default())?;
    let bare = &scene.meshes.first().ok_or("the file has no mesh")?.mesh;
    let bare = Mesh { attributes: None, materials: None, objects: None, ..bare.clone() };
    let textured = with_normals(meshlod_fixtures::charted(&bare));
    let models = [model(&bare)?, model(&textured)?];
    let bytes = models.each_ref().map(|model| model.bytes().implicit);
    let wedges = textured.attributes.as_ref().map_or(1, |all| all.wedge_count);
    println!("{} bytes for each of {wedges} wedges", (bytes[1] - bytes[0]) as f64 / wedges as f64);
    let (slope, query) = camera(&bare);
    let [mut bare, mut textured] = models;
    for model in [&mut bare, &mut textured] {
        model.saturate([slope / 2.0, slope * 2.0])?;
    }
    println!("| | faces | million faces / s, bare | with attributes | ratio |");
    println!("|---|--:|--:|--:|--:|");
    type Extract = fn(&mut Extractor<'_>, &Query<'_>) -> usize;
    let all: [(&str, Extract); 3] = [
        ("exact", |of, query| of.exact(query).map_or(0, |level| level.faces.len())),
        ("saturated", |of, query| of.saturated(query).map_or(0, |level| level.faces.len())),
        ("one tolerance", |of, _| of.uniform(1e-4).map_or(0, |level| level.faces.len())),
    ];
    for (name, extract) in all {
        let [a, b] = [&bare, &textured].map(|model| speed(model, &query, extract));
        println!("| {name} | {} | {:.1} | {:.1} | {:.2} |", a.0, a.1, b.1, b.1 / a.1);
    }
    let [bare, textured] = [&bare, &textured].map(|model| to_mesh(model, &query));
    println!("the exact level becomes a mesh in {bare:.2} ms bare, {textured:.2} with attributes");
    Ok(())
}

fn model(mesh: &Mesh) -> Result<Model, Failure> {
    let forest = Forest::new(mesh, &Options::default())?;
    let file = Archive::write(&forest, &Storage::default())?.0.into_source();
    let read: Implicit = Archive::open(file)?.read()?.0;
    let mut model = Model::from_implicit(&read)?;
    if !model.compact() {
        return Err("the model has no compact form".into());
    }
    Ok(model)
}

/// Returns the query of a camera that sees the mesh, and its tolerance for each unit of distance.
fn camera(mesh: &Mesh) -> (f64, Query<'static>) {
    let bounds = mesh.bounds();
    let middle = bounds.center();
    let eye = [middle[0], middle[1], middle[2] + 1.1 * bounds.diagonal()];
    let (look, up) = (middle, [0.0, 1.0, 0.0]);
    let camera = ViewCamera { eye, look, up, fov_rad: FOV_RAD, viewport: VIEWPORT };
    (PIXELS * camera.pixel(), Query::pixels(camera, PIXELS))
}

/// Returns faces, and the median of million faces a second.
fn speed(
    model: &Model,
    query: &Query<'_>,
    extract: fn(&mut Extractor<'_>, &Query<'_>) -> usize,
) -> (usize, f64) {
    let (mut extractor, mut faces) = (model.extractor(), 0);
    let round = |_| {
        let start = ThreadTime::now();
        faces = extract(&mut extractor, query);
        faces as f64 / start.elapsed().as_secs_f64() / 1e6
    };
    let mut speeds: Vec<f64> = (0..ROUNDS).map(round).collect();
    speeds.sort_by(f64::total_cmp);
    (faces, speeds[speeds.len() / 2])
}

/// Returns the milliseconds in which the exact level becomes a mesh with its attributes.
fn to_mesh(model: &Model, query: &Query<'_>) -> f64 {
    let mut extractor = model.extractor();
    let Ok(level) = extractor.exact(query) else { return f64::NAN };
    let round = |_| {
        let start = ThreadTime::now();
        std::hint::black_box(level.mesh());
        start.elapsed().as_secs_f64() * 1e3
    };
    let mut times: Vec<f64> = (0..ROUNDS).map(round).collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// Gives each wedge the mean normal of the faces around its vertex, by their areas.
fn with_normals(mut mesh: Mesh) -> Mesh {
    let mut sums = vec![DVec3::ZERO; mesh.positions.len()];
    for &face in &mesh.faces {
        let [a, b, c] = mesh.triangle(face);
        face.iter().for_each(|v| sums[v.index()] += (b - a).cross(c - a));
    }
    let unit = |sum: DVec3| sum.normalize_or_zero().as_vec3().to_array();
    if let Some(attributes) = &mut mesh.attributes {
        let mut values = vec![0.0; 3 * attributes.wedge_count];
        for (face, corners) in mesh.faces.iter().zip(&attributes.corners) {
            for (v, wedge) in face.iter().zip(corners) {
                values[3 * wedge.index()..][..3].copy_from_slice(&unit(sums[v.index()]));
            }
        }
        let (kind, name) = (LayerKind::Normal, "NORMAL".to_owned());
        attributes.layers.push(Layer { kind, name, width: 3, values });
    }
    mesh
}
