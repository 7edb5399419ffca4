//! Times and sizes of the RTIN of a height field.
//!
//! `cargo run --release -p meshlod-multires --example rtin [MESH.ply]`; the default is the shared
//! terrain.

use std::error::Error;

use cpu_time::ThreadTime;
use meshlod_mesh::Bounds;
use meshlod_multires::{
    Focus, HeightField, HeightPrecision, Query, Rtin, RtinCut, RtinExtractor, SlotMesh, Tolerance,
    UpdateLimits, ViewCamera,
};

type Failure = Box<dyn Error + Send + Sync>;

fn main() -> Result<(), Failure> {
    let path = match std::env::args().nth(1) {
        Some(path) => path.into(),
        None => meshlod_fixtures::shared_mesh("terrain-jacksboro.ply").ok_or("name a PLY file")?,
    };
    let mesh = meshlod_io::ply::read(&std::fs::read(path)?)?;
    let (seconds, field) = best(|| HeightField::from_mesh(&mesh));
    let field = field?;
    let [columns, rows] = field.size();
    println!("{columns} x {rows}, {:?}; recognized in {:.1} ms", field.fit(), seconds * 1e3);
    let (seconds, model) = best(|| Rtin::new(&field));
    let vertices = field.heights().len() as f64;
    println!(
        "built in {:.1} ms, {:.2} M vertices/s; {:.1} bytes a vertex; {:?}",
        seconds * 1e3,
        vertices / seconds * 1e-6,
        model.bytes() as f64 / vertices,
        model.fit(),
    );
    let (seconds, sound) = best(|| model.certify());
    println!("certified {} in {:.1} ms", sound?, seconds * 1e3);
    sizes(&field)?;
    extractions(&model, &field.bounds())?;
    println!("following a flight over the field, a thousandth of the diagonal a frame:");
    [4.0, 1.0, 0.25].iter().try_for_each(|&pixels| follow(&model, &field.bounds(), pixels))
}

fn timed<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = ThreadTime::now();
    let result = work();
    (start.elapsed().as_secs_f64(), result)
}

/// Returns the fastest of many runs, as the machine is shared.
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

fn sizes(field: &HeightField) -> Result<(), Failure> {
    let diagonal = field.bounds().diagonal();
    let within = [1e-5, 5e-5, 1e-4, 1e-3].map(|part| HeightPrecision::Within(part * diagonal));
    for precision in [HeightPrecision::Exact].into_iter().chain(within) {
        let (packing, bytes) = best(|| field.to_bytes(precision));
        let bytes = bytes?;
        let (reading, read) = best(|| HeightField::from_bytes(&bytes));
        println!(
            "  {precision:?}: {:.3} bytes a vertex, written in {:.1} ms, read in {:.1} ms, off by {}",
            bytes.len() as f64 / field.heights().len() as f64,
            packing * 1e3,
            reading * 1e3,
            read?.fit().rounded,
        );
    }
    Ok(())
}

fn extractions(model: &Rtin, bounds: &Bounds) -> Result<(), Failure> {
    let mut extractor = RtinExtractor::new(model);
    let diagonal = bounds.diagonal();
    let [x, y, z] = bounds.center();
    // Above a corner, looking across the field.
    let eye = [bounds.min[0], bounds.min[1], z + 0.05 * diagonal];
    let (look, up) = ([x, y, z], [0.0, 0.0, 1.0]);
    let camera = ViewCamera { eye, look, up, fov_rad: 0.8, viewport: [1920, 1080] };
    let uniform = [0.1, 1e-2, 3e-3, 1e-3, 3e-4, 0.0];
    let uniform =
        uniform.map(|part| (format!("{part:e} of the diagonal"), Query::uniform(part * diagonal)));
    let pixels = [4.0, 2.0, 1.0, 0.5, 0.25];
    let everything = pixels.map(|most| (format!("{most} px"), Query::pixels(camera, most)));
    let seen = pixels.map(|most| {
        let tolerance = Tolerance::Pixels { camera, pixels: most };
        (format!("{most} px in the frustum"), Query { focus: Focus::Frustum(camera), tolerance })
    });
    for (name, query) in uniform.into_iter().chain(everything).chain(seen) {
        let (exact, smallest) = best(|| extractor.exact(&query).map(|level| level.faces.len()));
        let (saturated, faces) = best(|| extractor.saturated(&query).map(|l| l.faces.len()));
        let (smallest, faces) = (smallest?, faces?);
        let (budgeted, best) = best(|| extractor.at_most(smallest, &query).map(|l| l.faces.len()));
        let rate = |faces: usize, seconds: f64| faces as f64 / seconds * 1e-6;
        println!(
            "  {name}: exact {smallest}, {:.1} M/s; saturated {faces} ({:+.1} %), {:.1} M/s; at most {}, {:.1} ms",
            rate(smallest, exact),
            100.0 * (faces as f64 / smallest as f64 - 1.0),
            rate(faces, saturated),
            best?,
            budgeted * 1e3,
        );
    }
    Ok(())
}

/// Flies along the diagonal and prints medians over the frames: of a cut that follows, of
/// extraction anew, and of points located on the cut.
fn follow(model: &Rtin, bounds: &Bounds, pixels: f64) -> Result<(), Failure> {
    const FRAMES: u32 = 101;
    let ([x, y, z], diagonal) = (bounds.center(), bounds.diagonal());
    let camera = |frame: u32| {
        let along = (f64::from(frame) - 0.5 * f64::from(FRAMES)) * 1e-3 * diagonal;
        let eye = [x + 0.8 * along, y + 0.6 * along, z + 0.05 * diagonal];
        let look = [eye[0] + 0.8 * diagonal, eye[1] + 0.6 * diagonal, z];
        ViewCamera { eye, look, up: [0.0, 0.0, 1.0], fov_rad: 0.8, viewport: [1920, 1080] }
    };
    let mut extractor = RtinExtractor::new(model);
    let (start, mut cut) = timed(|| RtinCut::new(model));
    let (mut figures, mut first) = (Vec::new(), 0.0);
    for frame in 0..FRAMES {
        let query = Query::pixels(camera(frame), pixels);
        let (followed, change) = timed(|| cut.update(&query, &UpdateLimits::default()));
        let (change, slots) = (change?, cut.patches().count());
        let (extracted, level) = timed(|| extractor.exact(&query).map(|level| level.faces.len()));
        assert_eq!(level?, cut.face_count());
        let at = camera(frame).eye;
        let (located, _) = timed(|| cut.locate(at));
        match frame {
            0 => first = followed,
            _ => figures.push([
                (change.splits + change.merges) as f64,
                change.inspected as f64,
                slots as f64,
                followed * 1e3,
                extracted * 1e3,
                located * 1e6,
            ]),
        }
    }
    let median = |k: usize| {
        let mut all: Vec<f64> = figures.iter().map(|figure| figure[k]).collect();
        all.sort_by(f64::total_cmp);
        all[all.len() / 2]
    };
    println!(
        "  {pixels} px, {} faces: {} changes, {} inspected, {} slots; followed in {:.3} ms, extracted in \
         {:.2} ms; located in {:.1} us; started in {:.1} ms, first frame {:.1} ms",
        cut.face_count(),
        median(0),
        median(1),
        median(2),
        median(3),
        median(4),
        median(5),
        start * 1e3,
        first * 1e3,
    );
    Ok(())
}
