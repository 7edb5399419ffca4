//! Extracts by errors in % of the diagonal and measures what comes out.
//!
//! `cargo run --release -p meshlod --example verify IN.mlod ORIGINAL .3 .1`

use std::error::Error;
use std::fs::File;

use meshlod::measure::{CertifiedOptions, certified_distance};
use meshlod::multires::{ModelFile, Query};
use meshlod::{ReadOptions, extract_verified, read};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [input, original, errors @ ..] = &arguments[..] else {
        return Err("give IN.mlod ORIGINAL ERROR...".into());
    };
    let file = ModelFile::open(File::open(input)?)?;
    let original = read(original.as_ref(), &ReadOptions::default())?.into_mesh();
    for error in errors {
        let tolerance = error.parse::<f64>()? / 100.0 * file.diagonal();
        let found = extract_verified(&file, &Query::uniform(tolerance))?;
        let (mesh, proof) = (found.extract.level.mesh(), found.verification);
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
    }
    Ok(())
}
