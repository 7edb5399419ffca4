//! Extracts by errors in % of the diagonal, everywhere and in a box of half the width, and measures
//! what comes out: certified bounds of its distance from the original over the error, and the faces
//! that are farther than the error in the box.
//!
//! `cargo run --release -p meshlod --example verify IN.mlod ORIGINAL .3 .1`

use std::error::Error;
use std::fs::File;

use meshlod::jobs::{
    ErrorLimit, ExtractRequest, FocusRequest, KnownError, QueryRequest, QueryTarget, extract,
};
use meshlod::measure::{
    BeyondOptions, CertifiedOptions, PreparedSurface, certified_distance, faces_beyond,
};
use meshlod::mesh::Bounds;
use meshlod::multires::{Focus, ModelFile};
use meshlod::{Bound, Mesh, ReadOptions, read};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [input, original, errors @ ..] = &arguments[..] else {
        return Err("give IN.mlod ORIGINAL ERROR...".into());
    };
    let file = ModelFile::open(File::open(input)?)?;
    let original = read(original, &ReadOptions::default())?.into_mesh();
    for error in errors {
        let tolerance = error.parse::<f64>()? / 100.0 * file.diagonal();
        let (scene, report) = extract(&file, &within(tolerance, FocusRequest::Everything), &())?;
        let KnownError::Verified(proof) = report.error.known else { unreachable!("asked for") };
        let mesh = scene.into_mesh();
        let apart = certified_distance(&original, &mesh, &CertifiedOptions::default())?;
        let [lower, upper] = [apart.symmetric().lower, apart.symmetric().upper];
        println!(
            "{error} %: {} faces, {} added in {} rounds, {:.3} to {:.3} of that",
            mesh.faces.len(),
            proof.added,
            proof.rounds,
            lower / tolerance,
            upper / tolerance,
        );
        in_box(&file, &original, tolerance)?;
    }
    Ok(())
}

fn within(tolerance: f64, focus: FocusRequest) -> ExtractRequest {
    let target = QueryTarget::Error(ErrorLimit::Length(Bound::Length(tolerance)));
    let query = QueryRequest { target, focus, ..QueryRequest::default() };
    ExtractRequest { query, ..ExtractRequest::default() }
}

/// Extracts the lower half along x, and lists the faces that are too far there.
fn in_box(file: &ModelFile<File>, original: &Mesh, tolerance: f64) -> Result<(), Box<dyn Error>> {
    let Bounds { min, max } = original.bounds();
    let (middle, wide) = (0.5 * (min[0] + max[0]), original.bounds().diagonal());
    // The cut may reach beyond the box of the original, and the focus shall hold all of its half.
    let focus = Focus::Box([min.map(|x| x - wide), [middle, max[1] + wide, max[2] + wide]]);
    let request = within(tolerance, FocusRequest::Region(focus));
    let cut = extract(file, &request, &())?.0.into_mesh();
    let limit = |corners: [[f64; 3]; 3]| {
        let is_in = corners.iter().any(|corner| corner[0] <= middle);
        if is_in { 1.01 * tolerance } else { f64::INFINITY }
    };
    let [a, b] = [PreparedSurface::new(original)?, PreparedSurface::new(&cut)?];
    let options = BeyondOptions::default();
    let beyond =
        [(&a, &b), (&b, &a)].map(|(a, b)| faces_beyond(a, b, &limit, &options).faces.len());
    println!("  in the box: {} faces, beyond {beyond:?}", cut.faces.len());
    Ok(())
}
