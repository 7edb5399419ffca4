//! How good cuts are: against simplifying straight, with and without rules, by estimates and bounds.
//!
//! `cargo run --release -p meshlod-multires --example quality [MESH.ply [METHOD]]`; without a mesh it
//! is the shared dragon.

use std::error::Error;

use cpu_time::ThreadTime;
use meshlod_measure::{Distance, DistanceOptions, Surface, surface_distance};
use meshlod_mesh::{Bounds, Mesh};
use meshlod_multires::{Forest, Model, Query, SplitRule, ViewCamera};
use meshlod_simplify::{Method, Options, Simplifier, Target};

type Failure = Box<dyn Error + Send + Sync>;

/// Tolerances of uniform cuts, in diagonals, finest first.
const TOLERANCES: [f64; 6] = [3e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2];

/// Where the ranges of aspects end. The aspect of a triangle is its longest side over the height on
/// it, in those of an equilateral one.
const ASPECTS: [f64; 5] = [1.5, 2.0, 4.0, 8.0, 16.0];

/// Enough for means within a quarter of a percent.
const MEASURE: DistanceOptions = DistanceOptions { samples: 200_000, seed: 0 };

fn main() -> Result<(), Failure> {
    let mut args = std::env::args().skip(1);
    let path = match args.next() {
        Some(path) => path.into(),
        None => meshlod_fixtures::shared_mesh("dragon.ply").ok_or("name a PLY file")?,
    };
    let method = args.next().map_or(Some(Method::LindstromTurk), |name| Method::by_name(&name));
    let method = method.ok_or("no such method")?;
    let options = Options { method: Some(method), ..Options::default() };
    let mesh = meshlod_io::ply::read(&std::fs::read(path)?)?;
    println!("{} vertices, {} faces", mesh.positions.len(), mesh.faces.len());
    let start = ThreadTime::now();
    let forest = Forest::new(&mesh, &options)?;
    let recorded = start.elapsed().as_secs_f64();
    let mut bounded = forest.clone();
    let start = ThreadTime::now();
    bounded.measure_bounds();
    let measured = start.elapsed().as_secs_f64();
    println!("{}: recorded in {recorded:.2} s, bounds in {measured:.2} s", method.name());
    let mut evened = forest.clone();
    evened.smooth_errors();
    let original = Surface::new(&mesh)?;
    let straight = straight(&mesh, &options, &original)?;
    let models = [("estimates", &forest), ("evened", &evened), ("bounds", &bounded)];
    for (name, forest) in models {
        uniform(name, &Model::new(forest)?, &original, &straight)?;
    }
    by_rule(&forest, &mesh.bounds())
}

/// A level of simplifying straight.
struct Straight {
    faces: f64,
    apart: Distance,
    aspects: String,
}

/// Levels in steps of three percent while the mean is still close to nothing, then of a tenth.
fn straight(
    mesh: &Mesh,
    options: &Options,
    original: &Surface<'_>,
) -> Result<Vec<Straight>, Failure> {
    let mut simplifier = Simplifier::new(mesh, options)?;
    let mut levels = Vec::new();
    let mut target = mesh.faces.len() as f64 * 0.98;
    while target > 250.0 {
        simplifier.run(Target::Faces(target as usize), &mut ())?;
        let level = simplifier.level();
        let apart = distance(original, &level)?;
        levels.push(Straight { faces: level.faces.len() as f64, apart, aspects: aspects(&level) });
        target *= if target > 0.7 * mesh.faces.len() as f64 { 0.97 } else { 0.9 };
    }
    Ok(levels)
}

fn distance(original: &Surface<'_>, level: &Mesh) -> Result<Distance, Failure> {
    Ok(surface_distance(original, &Surface::new(level)?, &MEASURE)?)
}

/// How many faces simplifying straight takes, by what it is measured by: between the last level that
/// is as good and the next.
fn as_good(levels: &[Straight], value: f64, of: impl Fn(&Distance) -> f64) -> Option<f64> {
    let worse = levels.iter().position(|level| of(&level.apart) > value)?;
    let [good, bad] = [worse.checked_sub(1)?, worse].map(|i| &levels[i]);
    let [from, to] = [good, bad].map(|level| of(&level.apart));
    let share = (value / from).ln() / (to / from).ln();
    Some(good.faces * (bad.faces / good.faces).powf(share))
}

/// Uniform cuts: what tolerances come to, and what simplifying straight takes to come to the same.
fn uniform(
    name: &str,
    model: &Model,
    original: &Surface<'_>,
    straight: &[Straight],
) -> Result<(), Failure> {
    println!("by {name}; aspects in % of the faces");
    let mut extractor = model.extractor();
    for part in TOLERANCES {
        let tolerance = part * original.diagonal();
        let cut = extractor.uniform(tolerance)?.mesh();
        let (faces, apart) = (cut.faces.len() as f64, distance(original, &cut)?);
        let by_mean = as_good(straight, apart.mean(), Distance::mean);
        let by_max = as_good(straight, apart.max(), Distance::max);
        let against = |straight: Option<f64>| match straight {
            Some(straight) => format!("{straight:.0}, ratio {:.3}", faces / straight),
            None => "nearly all".into(),
        };
        println!(
            "  {part:e}: {faces} faces, mean {:.4} %, max {:.4} %, tolerance / max {:.2}; straight to the \
             mean {}; to the max {}",
            apart.percent(apart.mean()),
            apart.percent(apart.max()),
            tolerance / apart.max(),
            against(by_mean),
            against(by_max),
        );
        println!("    aspects      {}", aspects(&cut));
        if let Some(near) = straight.iter().find(|level| Some(level.faces) <= by_mean) {
            println!("    of straight  {}", near.aspects);
        }
    }
    Ok(())
}

/// How many faces are in each range of aspects.
fn aspects(mesh: &Mesh) -> String {
    let mut counts = [0; ASPECTS.len() + 1];
    for &face in &mesh.faces {
        let [a, b, c] = mesh.triangle(face);
        let sides = [b - a, c - b, a - c].map(|side| side.length_squared());
        let twice_area = (b - a).cross(c - a).length();
        let aspect = 0.75f64.sqrt() * sides.into_iter().fold(0.0, f64::max) / twice_area;
        counts[ASPECTS.iter().take_while(|&&end| aspect > end).count()] += 1;
    }
    let percent = counts.map(|count| 100.0 * f64::from(count) / mesh.faces.len() as f64);
    let starts = [1.0].into_iter().chain(ASPECTS);
    let columns = starts.zip(percent).map(|(start, percent)| format!("{start}+: {percent:.1}"));
    columns.collect::<Vec<_>>().join(", ")
}

/// What needs cost where a camera asks.
fn by_rule(forest: &Forest, bounds: &Bounds) -> Result<(), Failure> {
    println!("camera cuts: what is wanted alone, and with what each rule needs");
    let models = [SplitRule::Strict, SplitRule::Wings].map(|rule| Model::with_rule(forest, rule));
    for pixels in [1.0, 0.5, 0.25, 0.1] {
        let query = Query::pixels(camera(bounds), pixels);
        let mut report = format!("{pixels} px:");
        for (rule, model) in ["strict", "wings"].into_iter().zip(&models) {
            let mut extractor = model.as_ref().map_err(Clone::clone)?.extractor();
            let wanted = extractor.wanted(&query)?.faces.len();
            let exact = extractor.exact(&query)?.faces.len();
            let more = 100.0 * (exact as f64 / wanted as f64 - 1.0);
            report += &format!(" wanted {wanted}, {rule} {exact}, {more:+.2} %;");
        }
        println!("{report}");
    }
    Ok(())
}

/// Where figures are taken from.
fn camera(bounds: &Bounds) -> ViewCamera {
    let center = bounds.center();
    let eye = [center[0], center[1], center[2] + 1.2 * bounds.diagonal()];
    ViewCamera { eye, look: center, up: [0.0, 1.0, 0.0], fov_rad: 0.8, viewport: [1920, 1080] }
}
