//! Quality of cuts: compared with plain simplification, by split rule, with estimates and bounds.
//!
//! `cargo run --release -p meshlod-multires --example quality [MESH.ply [METHOD]]`; the default is
//! the shared dragon.

use std::error::Error;

use cpu_time::ThreadTime;
use meshlod_measure::{Distance, DistanceOptions, PreparedSurface, surface_distance};
use meshlod_mesh::{Bounds, Mesh};
use meshlod_multires::{Forest, Model, Query, SplitRule, ViewCamera};
use meshlod_simplify::{Method, Options, Simplifier, Target};

type Failure = Box<dyn Error + Send + Sync>;

/// Tolerances of uniform cuts, in diagonals, finest first.
const TOLERANCES: [f64; 6] = [3e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2];

/// Bounds of the aspect ranges. A triangle's aspect is its longest side over the height on it,
/// relative to an equilateral triangle.
const ASPECTS: [f64; 5] = [1.5, 2.0, 4.0, 8.0, 16.0];

/// Enough samples for means within a quarter of a percent.
const MEASURE: DistanceOptions = DistanceOptions { samples: 200_000, seed: 0 };

fn main() -> Result<(), Failure> {
    let mut args = std::env::args().skip(1);
    let path = match args.next() {
        Some(path) => path.into(),
        None => meshlod_fixtures::shared_mesh("dragon.ply").ok_or("name a PLY file")?,
    };
    let method = args.next().map_or(Ok(Method::LindstromTurk), |name| name.parse())?;
    let options = Options { method, ..Options::default() };
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
    let mut smoothed = forest.clone();
    smoothed.smooth_errors();
    let original = PreparedSurface::new(&mesh)?;
    let plain = plain(&mesh, &options, &original)?;
    let models = [("estimates", &forest), ("smoothed", &smoothed), ("bounds", &bounded)];
    for (name, forest) in models {
        uniform(name, &Model::new(forest)?, &original, &plain)?;
    }
    by_rule(&forest, &mesh.bounds())
}

/// A level of plain simplification.
struct Plain {
    faces: f64,
    apart: Distance,
    aspects: String,
}

/// Returns levels in steps of three percent while the mean error is close to zero, then of ten
/// percent.
fn plain(
    mesh: &Mesh,
    options: &Options,
    original: &PreparedSurface<'_>,
) -> Result<Vec<Plain>, Failure> {
    let mut simplifier = Simplifier::new(mesh, options)?;
    let mut levels = Vec::new();
    let mut target = mesh.faces.len() as f64 * 0.98;
    while target > 250.0 {
        simplifier.run(Target::Faces(target as usize), &mut ())?;
        let level = simplifier.level();
        let apart = distance(original, &level)?;
        levels.push(Plain { faces: level.faces.len() as f64, apart, aspects: aspects(&level) });
        target *= if target > 0.7 * mesh.faces.len() as f64 { 0.97 } else { 0.9 };
    }
    Ok(levels)
}

fn distance(original: &PreparedSurface<'_>, level: &Mesh) -> Result<Distance, Failure> {
    Ok(surface_distance(original, &PreparedSurface::new(level)?, &MEASURE)?)
}

/// Interpolates the number of faces at which plain simplification reaches the given error.
fn as_good(levels: &[Plain], value: f64, of: impl Fn(&Distance) -> f64) -> Option<f64> {
    let worse = levels.iter().position(|level| of(&level.apart) > value)?;
    let [good, bad] = [worse.checked_sub(1)?, worse].map(|i| &levels[i]);
    let [from, to] = [good, bad].map(|level| of(&level.apart));
    let share = (value / from).ln() / (to / from).ln();
    Some(good.faces * (bad.faces / good.faces).powf(share))
}

/// Prints uniform cuts and the faces that plain simplification takes for the same error.
fn uniform(
    name: &str,
    model: &Model,
    original: &PreparedSurface<'_>,
    plain: &[Plain],
) -> Result<(), Failure> {
    println!("by {name}; aspects in % of the faces");
    let mut extractor = model.extractor();
    for part in TOLERANCES {
        let tolerance = part * original.diagonal();
        let cut = extractor.uniform(tolerance)?.mesh();
        let (faces, apart) = (cut.faces.len() as f64, distance(original, &cut)?);
        let by_mean = as_good(plain, apart.mean(), Distance::mean);
        let by_max = as_good(plain, apart.max(), Distance::max);
        let against = |plain: Option<f64>| match plain {
            Some(plain) => format!("{plain:.0}, ratio {:.3}", faces / plain),
            None => "nearly all".into(),
        };
        println!(
            "  {part:e}: {faces} faces, mean {:.4} %, max {:.4} %, tolerance / max {:.2}; plain to the \
             mean {}; to the max {}",
            apart.percent(apart.mean()),
            apart.percent(apart.max()),
            tolerance / apart.max(),
            against(by_mean),
            against(by_max),
        );
        println!("    aspects      {}", aspects(&cut));
        if let Some(near) = plain.iter().find(|level| Some(level.faces) <= by_mean) {
            println!("    of plain     {}", near.aspects);
        }
    }
    Ok(())
}

/// Returns the share of faces in each range of aspects.
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

/// Prints the faces that dependencies add to camera cuts.
fn by_rule(forest: &Forest, bounds: &Bounds) -> Result<(), Failure> {
    println!("camera cuts: the required updates alone, and with the dependencies of each rule");
    let models = [SplitRule::Strict, SplitRule::Wings].map(|rule| Model::with_rule(forest, rule));
    for pixels in [1.0, 0.5, 0.25, 0.1] {
        let query = Query::pixels(camera(bounds), pixels);
        let mut report = format!("{pixels} px:");
        for (rule, model) in ["strict", "wings"].into_iter().zip(&models) {
            let mut extractor = model.as_ref().map_err(Clone::clone)?.extractor();
            let required = extractor.required(&query)?.faces.len();
            let exact = extractor.exact(&query)?.faces.len();
            let more = 100.0 * (exact as f64 / required as f64 - 1.0);
            report += &format!(" required {required}, {rule} {exact}, {more:+.2} %;");
        }
        println!("{report}");
    }
    Ok(())
}

/// Returns the camera of the figures.
fn camera(bounds: &Bounds) -> ViewCamera {
    let center = bounds.center();
    let eye = [center[0], center[1], center[2] + 1.2 * bounds.diagonal()];
    ViewCamera { eye, look: center, up: [0.0, 1.0, 0.0], fov_rad: 0.8, viewport: [1920, 1080] }
}
