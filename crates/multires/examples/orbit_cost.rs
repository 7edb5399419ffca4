//! Measures what an orbit costs the processor: a cut that changes at once, and one whose vertices move.
//! Of the latter either what has turned is written for the GPU, which blends by the time, or the values
//! of everything that moves.
//!
//! `cargo run --release -p meshlod-multires --example orbit_cost -- MODEL.mlod [PIXELS]`; without a file
//! the fish sample with normals and texture coordinates, as it comes back from a file. The camera turns
//! by a tenth of a degree in each of 200 frames. The figures are the processor's time of one thread; for
//! counts of instructions, `valgrind --tool=callgrind --toggle-collect='orbit_cost::turn'`.

use std::error::Error;
use std::time::Duration;

use cpu_time::ThreadTime;
use glam::DVec3;
use meshlod_mesh::{Attributes, Layer, LayerKind, Mesh, WedgeId};
use meshlod_multires::{
    Archive, Cut, Forest, Geomorph, Hierarchy, Implicit, ModelFile, Query, SlotMesh, Storage,
    UpdateLimits, VertexValues, ViewCamera,
};
use meshlod_simplify::Options;

type Failure = Box<dyn Error + Send + Sync>;

const FACES: usize = 900_000;
const FOV_RAD: f64 = 0.8;
const STEP_DEGREES: f64 = 0.1;
const FRAMES: u32 = 200;
/// Time that a vertex moves, and between two frames.
const BLEND: Duration = Duration::from_millis(250);
const FRAME: Duration = Duration::from_micros(16_667);

fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let mt = match arguments.next() {
        Some(path) => match ModelFile::open(std::fs::read(path)?)?.read()? {
            Hierarchy::Contractions(mt) => mt,
            Hierarchy::RightTriangles(_) => return Err("height fields have no geomorph".into()),
        },
        None => sample()?,
    };
    let pixels = arguments.next().map_or(Ok(0.0015), |pixels| pixels.parse())?;
    let orbit = Orbit::around(&mt, pixels);
    println!("| changes | faces | ms | at most | vertices that move |");
    println!("|---|--:|--:|--:|--:|");
    let mut cut = Cut::new(&mt);
    let frames = orbit.follow(|query, _| {
        cut.update(query, &UpdateLimits::default())?;
        Ok(cut.touched_slots().count() as f32)
    })?;
    print("at once", cut.face_count(), frames, 0);
    let mut staging = Staging::default();
    let mut morph = Geomorph::new(&mt, BLEND)?;
    let frames = orbit.follow(|query, elapsed| {
        staging.clear();
        morph.advance(elapsed);
        morph.turned().for_each(|node| staging.write_motion(&morph, node));
        morph.update(query, &UpdateLimits::default())?;
        morph.turned().for_each(|node| staging.write_motion(&morph, node));
        Ok(staging.numbers.len() as f32)
    })?;
    morph.advance(Duration::ZERO);
    print("moving: motions", morph.face_count(), frames, morph.moved().count());
    let mut morph = Geomorph::new(&mt, BLEND)?;
    let mut moved: Vec<u32> = Vec::new();
    let frames = orbit.follow(|query, elapsed| {
        staging.clear();
        moved.clear();
        morph.advance(elapsed);
        moved.extend(morph.moved());
        morph.update(query, &UpdateLimits::default())?;
        moved.extend(morph.moved());
        moved.sort_unstable();
        moved.dedup();
        moved.iter().for_each(|&node| staging.write_values(&morph, node));
        Ok(staging.numbers.len() as f32)
    })?;
    print("moving: values", morph.face_count(), frames, moved.len());
    Ok(())
}

/// Numbers of 32 bits that a frame sends to the GPU.
#[derive(Default)]
struct Staging {
    numbers: Vec<f32>,
    now: VertexValues,
}

impl Staging {
    fn clear(&mut self) {
        self.numbers.clear();
    }

    /// Writes both ends of a vertex's motion and when it set out, or what it is where the model has it.
    fn write_motion(&mut self, morph: &Geomorph<'_>, node: u32) {
        let Some(motion) = morph.motion(node) else {
            return if morph.shows(node) {
                self.write_values(morph, node)
            };
        };
        let begun = motion.begun.map_or(-1.0, |begun| begun.as_secs_f32());
        self.numbers.extend([f32::from_bits(node), begun]);
        for (place, values) in motion.positions.into_iter().zip(motion.values) {
            self.numbers.extend(place.map(|x| x as f32));
            self.numbers.extend_from_slice(values);
        }
    }

    /// Writes what a vertex is now.
    fn write_values(&mut self, morph: &Geomorph<'_>, node: u32) {
        morph.values(node, &mut self.now);
        self.numbers.push(f32::from_bits(node));
        self.numbers.extend(self.now.position.map(|x| x as f32));
        self.numbers.extend_from_slice(&self.now.values);
    }
}

/// Orbit around a model, at a tolerance in pixels.
struct Orbit {
    middle: [f64; 3],
    radius: f64,
    pixels: f64,
}

impl Orbit {
    fn around(mt: &Implicit, pixels: f64) -> Self {
        let nodes = (0..mt.node_count() as u32).map(|node| mt.position(node));
        let places: Vec<[f64; 3]> = nodes.collect();
        let ends = [0, 1, 2].map(|k| {
            let along = places.iter().map(|place| place[k]);
            [along.clone().fold(f64::INFINITY, f64::min), along.fold(f64::NEG_INFINITY, f64::max)]
        });
        let diagonal = ends.iter().map(|[a, b]| (b - a).powi(2)).sum::<f64>().sqrt();
        Self { middle: ends.map(|[a, b]| (a + b) / 2.0), radius: 1.1 * diagonal, pixels }
    }

    fn query(&self, frame: u32) -> Query<'static> {
        let (sin, cos) = (STEP_DEGREES * f64::from(frame)).to_radians().sin_cos();
        let [x, y, z] = self.middle;
        let eye = [x + self.radius * sin, y + 0.2 * self.radius, z + self.radius * cos];
        let (look, up, viewport) = (self.middle, [0.0, 1.0, 0.0], [1920, 1080]);
        Query::pixels(ViewCamera { eye, look, up, fov_rad: FOV_RAD, viewport }, self.pixels)
    }

    /// Follows the orbit, and returns the milliseconds of each frame after the first two, when vertices
    /// of the first cut have arrived.
    fn follow(
        &self,
        mut step: impl FnMut(&Query<'_>, Duration) -> Result<f32, Failure>,
    ) -> Result<Vec<f64>, Failure> {
        step(&self.query(0), FRAME)?;
        step(&self.query(1), Duration::MAX)?;
        (2..=FRAMES).map(|frame| turn(&self.query(frame), &mut step)).collect()
    }
}

/// Does a step of the orbit, and returns its milliseconds.
#[inline(never)]
fn turn(
    query: &Query<'_>,
    step: &mut impl FnMut(&Query<'_>, Duration) -> Result<f32, Failure>,
) -> Result<f64, Failure> {
    let start = ThreadTime::now();
    std::hint::black_box(step(query, FRAME)?);
    Ok(start.elapsed().as_secs_f64() * 1e3)
}

fn print(name: &str, faces: usize, mut frames: Vec<f64>, moved: usize) {
    frames.sort_by(f64::total_cmp);
    let (median, most) = (frames[frames.len() / 2], frames[frames.len() - 1]);
    println!("| {name} | {faces} | {median:.3} | {most:.2} | {moved} |");
}

/// Returns the levels of the fish, with normals and texture coordinates around its long axis.
fn sample() -> Result<Implicit, Failure> {
    let mut mesh = meshlod_samples::fish(FACES);
    let normals = normals(&mesh).into_iter().flatten().collect();
    let uv = |place: &[f64; 3]| {
        let turn = place[2].atan2(place[1]) / std::f64::consts::TAU + 0.5;
        [place[0] as f32, turn as f32]
    };
    let uvs = mesh.positions.iter().flat_map(uv).collect();
    let layer = |kind, width, values| Layer { kind, name: String::new(), width, values };
    mesh.attributes = Some(Attributes {
        corners: mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect(),
        wedge_count: mesh.positions.len(),
        layers: vec![layer(LayerKind::Normal, 3, normals), layer(LayerKind::Uv(0), 2, uvs)],
    });
    read_back(&mesh)
}

/// Returns the mean normal of the faces around each vertex, by their areas.
fn normals(mesh: &Mesh) -> Vec<[f32; 3]> {
    let mut sums = vec![DVec3::ZERO; mesh.positions.len()];
    for &face in &mesh.faces {
        let [a, b, c] = mesh.triangle(face);
        face.iter().for_each(|v| sums[v.index()] += (b - a).cross(c - a));
    }
    sums.into_iter().map(|sum| sum.normalize_or_zero().as_vec3().to_array()).collect()
}

fn read_back(mesh: &Mesh) -> Result<Implicit, Failure> {
    let forest = Forest::new(mesh, &Options::default())?;
    let file = Archive::write(&forest, &Storage::default())?.0.into_source();
    Ok(Archive::open(file)?.read()?.0)
}
