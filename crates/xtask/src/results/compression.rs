//! Compressed meshes: the paper's parts, every scheme at 11 bits, and rates against distortion.

mod global;
mod rates;
mod sent;

use anyhow::{Context, Result};
use meshlod::Mesh;
use meshlod::codec::{
    AttributeBounds, Compression, CompressionTarget, Partitioner, Reconstruction, Scheme, compress,
};
use meshlod::measure::{Distance, DistanceOptions, distance};
use meshlod_bench::least_seconds;

use self::global::{Rounding, global};
use crate::project::Project;
use crate::table::Table;

/// The meshes of the paper, or of their sizes.
const OF_PAPER: [&str; 5] =
    ["horse.ply", "feline.ply", "squirrel-20k.obj", "armadillo-173k.ply", "dragon-100k.ply"];
const MESHES: [&str; 10] = [
    "squirrel-20k.obj",
    "fandisk-32k.ply",
    "bunny.ply",
    "horse.ply",
    "feline.ply",
    "nefertiti.ply",
    "dragon-100k.ply",
    "horse-97k.ply",
    "armadillo-173k.ply",
    "igea.ply",
];
const SCHEMES: [(&str, Scheme); 3] = [
    ("parts", Scheme::Parts(Reconstruction::Centred)),
    ("blocks", Scheme::Blocks),
    ("lattice", Scheme::Lattice),
];
const BITS: u32 = 11;

pub fn section(project: &Project) -> Result<String> {
    if let Some(drawing) = rates::drawing()? {
        let folder = project.root().join("docs/notes/compression");
        std::fs::create_dir_all(&folder)?;
        std::fs::write(folder.join("rates.svg"), drawing).context("rates.svg")?;
    }
    Ok(format!(
        "Distances are means of both ways (Metro's), 200,000 samples each, in parts of those of cubic cells for the whole \
         mesh, 2047 along the longest side. Sizes are all that decoding needs. Drawn in docs/notes/compression.md. Again: \
         `cargo xtask results compression`.\n\n{}{}{}",
        of_paper()?,
        schemes()?,
        sent::table()?
    ))
}

fn apart(mesh: &Mesh, decoded: &Mesh) -> Result<Distance> {
    let options = DistanceOptions { samples: 200_000, ..DistanceOptions::default() };
    Ok(distance(mesh, decoded, &options)?)
}

/// Parts at a reduction of 70 %, truncated against truncated and centred against rounded.
fn of_paper() -> Result<String> {
    let mut table = Table::new([
        "parts at a reduction of 70 %",
        "parts",
        "stored again, %",
        "reduction, %",
        "truncated",
        "centred",
        "CPU s",
    ]);
    for name in OF_PAPER {
        let Some(mesh) = meshlod_bench::read(name)? else { continue };
        let parting = Partitioner::new(&mesh)?;
        let mut row = vec![name.to_owned()];
        let mut ratios = Vec::new();
        let mut seconds = 0.0;
        for (cells, rounding) in [
            (Reconstruction::Truncated, Rounding::Down),
            (Reconstruction::Centred, Rounding::Nearest),
        ] {
            let mut parts = None;
            seconds = least_seconds(1, || parts = Some(parting.within_reduction(0.7, cells)));
            let parts = parts.context("it has run")??;
            if row.len() == 1 {
                row.push(parts.parts().len().to_string());
                row.push(format!("{:.1}", 100.0 * parts.overhead()));
                row.push(format!("{:.2}", 100.0 * parts.reduction()));
            }
            let whole = apart(&mesh, &global(&mesh, BITS, rounding))?;
            ratios.push(apart(&mesh, &parts.decode())?.mean() / whole.mean());
        }
        row.extend(ratios.iter().map(|ratio| format!("{ratio:.2}")));
        row.push(format!("{seconds:.1}"));
        table.row(row);
    }
    Ok(table.markdown())
}

/// Every scheme as good as 11 bits.
fn schemes() -> Result<String> {
    let mut table = Table::new([
        "as good as 11 bits",
        "reduction, %",
        "mean",
        "most",
        "faces turned over",
        "by 11 bits",
        "positions, bytes a vertex",
        "faces, bytes each",
        "all, bytes a face",
        "CPU s",
    ]);
    for name in MESHES {
        let Some(mesh) = meshlod_bench::read(name)? else { continue };
        let rounded = global(&mesh, BITS, Rounding::Nearest);
        let whole = apart(&mesh, &rounded)?;
        for (title, scheme) in SCHEMES {
            let bounds = AttributeBounds::default();
            let mut done = None;
            let seconds = least_seconds(1, || {
                done = Some(compress(&mesh, scheme, CompressionTarget::Bits(BITS), &bounds));
            });
            let Compression { compressed, vertices, .. } = done.context("it has run")??;
            let decoded = compressed.decode()?;
            let is = apart(&mesh, &decoded)?;
            let mut moved = Mesh::new(mesh.positions.clone(), mesh.faces.clone());
            for (vertex, place) in vertices.iter().zip(&decoded.positions) {
                moved.positions[vertex.index()] = *place;
            }
            let sizes = compressed.sizes();
            let each = |bytes: usize, of: usize| format!("{:.3}", bytes as f64 / of as f64);
            table.row([
                format!("{name}, {title}"),
                format!("{:.1}", 100.0 * compressed.reduction()),
                format!("{:.2}", is.mean() / whole.mean()),
                format!("{:.2}", is.max() / whole.max()),
                global::turned_over(&mesh, &moved).to_string(),
                global::turned_over(&mesh, &rounded).to_string(),
                each(sizes.positions, compressed.vertices()),
                each(sizes.connectivity, compressed.faces()),
                each(sizes.total, compressed.faces()),
                format!("{seconds:.2}"),
            ]);
        }
    }
    Ok(table.markdown())
}
