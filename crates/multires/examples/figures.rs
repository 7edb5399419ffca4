//! Times and sizes of every encoding on a mesh.
//!
//! `cargo run --release -p meshlod-multires --example figures [MESH.ply [METHOD]]`; without a mesh it
//! is the shared dragon.

use std::error::Error;

use cpu_time::ThreadTime;
use meshlod_mesh::{Bounds, Mesh};
use meshlod_multires::{
    Camera, Cut, Effort, Explicit, Forest, Implicit, Model, Query, Recorder, Rule,
};
use meshlod_simplify::{Method, Options, Simplifier, Target};

/// The tolerances that are asked for.
const PIXELS: [f64; 5] = [1.0, 0.5, 0.25, 0.1, 0.02];

type Failure = Box<dyn Error + Send + Sync>;

fn main() -> Result<(), Failure> {
    let mut args = std::env::args().skip(1);
    let path = match args.next() {
        Some(path) => path.into(),
        None => meshlod_fixtures::shared_mesh("dragon.ply").ok_or("name a PLY file")?,
    };
    let method = args.next().map_or(Some(Method::Qem), |name| Method::by_name(&name));
    let options = Options { method: method.ok_or("no such method")?, ..Options::default() };
    let mesh = meshlod_io::ply::read(&std::fs::read(path)?)?;
    println!("{} vertices, {} faces", mesh.positions.len(), mesh.faces.len());
    let forest = record(&mesh, &options)?;
    let implicit = pack(&forest, mesh.positions.len())?;
    let bounds = mesh.bounds();
    exact(&implicit, &bounds)?;
    listed(&forest, &implicit, &bounds)?;
    motions(&implicit, &bounds)?;
    Ok(())
}

fn timed<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = ThreadTime::now();
    let result = work();
    (start.elapsed().as_secs_f64(), result)
}

/// The best of many runs: others share the machine.
fn best<T>(mut work: impl FnMut() -> T) -> (f64, T) {
    let mut best = timed(&mut work);
    let mut all = best.0;
    for _ in 0..50 {
        if all > 0.5 {
            break;
        }
        let next = timed(&mut work);
        all += next.0;
        best = if next.0 < best.0 { next } else { best };
    }
    best
}

fn record(mesh: &Mesh, options: &Options) -> Result<Forest, Failure> {
    let mut plain = Simplifier::new(mesh, options)?;
    let (bare, _) = timed(|| plain.run(Target::Faces(0), &mut ()));
    let mut simplifier = Simplifier::new(mesh, options)?;
    let (recorded, recorder) = timed(|| {
        let mut recorder = Recorder::new(&simplifier);
        simplifier.run(Target::Faces(0), &mut recorder).map(|_| recorder)
    });
    let forest = recorder?.into_forest()?;
    println!(
        "{}: to exhaustion {bare:.2} s, recorded {recorded:.2} s; {} updates",
        options.method.name(),
        forest.update_count(),
    );
    Ok(forest)
}

fn pack(forest: &Forest, vertices: usize) -> Result<Implicit, Failure> {
    let (seconds, implicit) = best(|| Implicit::new(forest));
    let implicit = implicit?;
    println!(
        "packed in {seconds:.3} s, {:.2} M updates/s; {:.1} bytes a vertex; base {} faces",
        implicit.update_count() as f64 / seconds * 1e-6,
        implicit.bytes() as f64 / vertices as f64,
        implicit.base_faces(),
    );
    let (seconds, certificate) = timed(|| implicit.certify());
    println!("certificate in {seconds:.2} s: {:?}", certificate?);
    let (seconds, explicit) = timed(|| Explicit::new(forest));
    println!(
        "explicit in {seconds:.2} s: {} triangles, {:.0} bytes a vertex",
        explicit.triangle_count(),
        explicit.bytes() as f64 / vertices as f64,
    );
    Ok(implicit)
}

fn camera(bounds: &Bounds, angle: f64, distance: f64) -> Camera {
    let center = bounds.center();
    let diagonal = bounds.diagonal();
    let (sin, cos) = angle.sin_cos();
    let eye =
        [center[0] + diagonal * distance * sin, center[1], center[2] + diagonal * distance * cos];
    Camera { eye, look: center, up: [0.0, 1.0, 0.0], fov_rad: 0.8, viewport: [1920, 1080] }
}

/// From the base, by splits alone.
fn exact(implicit: &Implicit, bounds: &Bounds) -> Result<(), Failure> {
    println!("exact, by splits from the base:");
    for pixels in [1.0, 0.5, 0.25, 0.1, 0.02] {
        let query = Query::pixels(camera(bounds, 0.0, 1.2), pixels);
        let (seconds, cut) = best(|| Cut::at(implicit, &query));
        report(&format!("{pixels} px"), seconds, cut?.face_count());
    }
    let (seconds, cut) = best(|| Cut::at(implicit, &Query::uniform(0.0)));
    report("all", seconds, cut?.face_count());
    Ok(())
}

/// By the face list, without looking at neighbours.
fn listed(forest: &Forest, implicit: &Implicit, bounds: &Bounds) -> Result<(), Failure> {
    let (seconds, model) = timed(|| Model::new(forest));
    let mut model = model?;
    let per_update = |bytes: usize| bytes as f64 / implicit.update_count() as f64;
    println!("all lists in {seconds:.3} s, bytes: {:?}", model.bytes());
    println!(
        "{:.1} bytes an update for faces, {:.1} for links",
        per_update(model.bytes().faces),
        per_update(model.bytes().links)
    );
    let weaker = Model::with_rule(forest, Rule::Wings)?;
    let of_links = per_update(weaker.bytes().links);
    println!("{of_links:.1} bytes an update for links by wings");
    for pixels in PIXELS {
        let slope = pixels * camera(bounds, 0.0, 1.2).pixel();
        let (seconds, done) = timed(|| model.saturate([slope / 2.0, slope * 2.0]));
        done?;
        println!("nested in {seconds:.2} s for {pixels} px");
    }
    let mut extractor = model.extractor();
    for pixels in PIXELS {
        let query = Query::pixels(camera(bounds, 0.0, 1.2), pixels);
        let strict = Cut::at(implicit, &query)?.face_count();
        for (rule, model) in [(Rule::Strict, &model), (Rule::Wings, &weaker)] {
            let mut extractor = model.extractor();
            let (seconds, faces) = best(|| extractor.exact(&query).map(|level| level.faces.len()));
            let folds = extractor.exact(&query)?.folds();
            report(&format!("{rule:?}, {pixels} px ({folds} folds)"), seconds, faces?);
        }
        let (seconds, more) = best(|| extractor.saturated(&query).map(|level| level.faces.len()));
        let more = more?;
        report(&format!("saturated, {pixels} px"), seconds, more);
        println!("    {:+.1} % faces", 100.0 * (more as f64 / strict as f64 - 1.0));
        let (seconds, faces) = best(|| extractor.at_most(more, &query).map(|l| l.faces.len()));
        report(&format!("at most {more}"), seconds, faces?);
    }
    let uniform = Query::uniform(0.0);
    let (seconds, faces) = best(|| extractor.at_most(500_000, &uniform).map(|l| l.faces.len()));
    report("at most 500000 of one tolerance", seconds, faces?);
    for part in [1e-1, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 0.0] {
        let tolerance = part * bounds.diagonal();
        let (seconds, faces) = best(|| extractor.uniform(tolerance).map(|level| level.faces.len()));
        report(&format!("uniform, {part:e} of the diagonal"), seconds, faces?);
    }
    Ok(())
}

fn report(what: &str, seconds: f64, faces: usize) {
    let rate = faces as f64 / seconds * 1e-6;
    println!("  {what}: {faces} faces in {:.2} ms, {rate:.1} M/s", seconds * 1e3);
}

/// Frames of an orbit and of a dolly.
fn motions(implicit: &Implicit, bounds: &Bounds) -> Result<(), Failure> {
    for pixels in [1.0, 0.2, 0.02] {
        for (name, turn, zoom) in [
            ("orbit 0.1°", 0.1f64.to_radians(), 1.0),
            ("orbit 1°", 1f64.to_radians(), 1.0),
            ("dolly", 0.0, 0.995),
        ] {
            let at = |frame: i32| {
                let distance = 1.2 * f64::powi(zoom, frame);
                Query::pixels(camera(bounds, turn * f64::from(frame), distance), pixels)
            };
            let mut cut = Cut::at(implicit, &at(0))?;
            let faces = cut.face_count();
            let mut times = Vec::new();
            let (mut changed, mut nodes, mut looks) = (0, 0, 0);
            for frame in 1..=100 {
                let query = at(frame);
                let (seconds, change) = timed(|| cut.update(&query, &Effort::default()));
                let change = change?;
                times.push(seconds * 1e6);
                nodes += change.splits + change.merges;
                looks += change.looks;
                changed += cut.patches().count();
            }
            let all: f64 = times.iter().sum();
            times.sort_by(f64::total_cmp);
            println!(
                "{name} at {pixels} px, {faces} faces: median {:.0} us, worst {:.0}; a frame {:.0} nodes, \
                 {:.0} looks, {:.0} triangles; {:.0} ns each",
                times[times.len() / 2],
                times[times.len() - 1],
                nodes as f64 / 100.0,
                looks as f64 / 100.0,
                changed as f64 / 100.0,
                all * 1e3 / f64::from(changed.max(1) as u32),
            );
        }
    }
    Ok(())
}
