//! Measures compressed meshes: the paper's parts, every scheme at 11 bits, and rate-distortion
//! curves.

mod global;
mod rates;
mod sent;

use anyhow::{Context, Result};
use meshlod::Mesh;
use meshlod::codec::{
    Compression, CompressionTarget, Partitioner, Reconstruction, Scheme, compress,
};
use meshlod::measure::{Distance, DistanceOptions, distance};
use meshlod::mesh::AttributeBounds;

use self::global::{Rounding, global};
use crate::lab::folders::root;
use crate::lab::table::Table;
use crate::least_seconds;

/// The meshes of the paper, or meshes of the same size.
const PAPER_MESHES: [&str; 5] =
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

pub fn section() -> Result<String> {
    if let Some(drawing) = rates::drawing()? {
        let folder = root().join("docs/notes/compression");
        std::fs::create_dir_all(&folder)?;
        std::fs::write(folder.join("rates.svg"), drawing).context("rates.svg")?;
    }
    Ok(format!(
        "Distances are symmetric means (Metro's), 200,000 samples each way, relative to those of a global \
         grid of cubic cells with 2047 along the longest side. Sizes include everything that decoding \
         needs. Plotted in docs/notes/compression.md. To reproduce: `cargo xtask results \
         compression`.\n\n{}{}{}",
        paper_table()?,
        scheme_table()?,
        sent::table()?
    ))
}

fn distance_of(mesh: &Mesh, decoded: &Mesh) -> Result<Distance> {
    let options = DistanceOptions { samples: 200_000, ..DistanceOptions::default() };
    Ok(distance(mesh, decoded, &options)?)
}

/// Tables parts at a reduction of 70 %: truncated against truncated cells, centred against rounded.
fn paper_table() -> Result<String> {
    let mut table = Table::new([
        "parts at a reduction of 70 %",
        "parts",
        "duplicated vertices, %",
        "reduction, %",
        "truncated",
        "centred",
        "CPU s",
    ]);
    for name in PAPER_MESHES {
        let Some(mesh) = crate::read(name)? else { continue };
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
            let parts = parts.context("the work has run")??;
            if row.len() == 1 {
                row.push(parts.parts().len().to_string());
                row.push(format!("{:.1}", 100.0 * parts.overhead()));
                row.push(format!("{:.2}", 100.0 * parts.reduction()));
            }
            let whole = distance_of(&mesh, &global(&mesh, BITS, rounding))?;
            ratios.push(distance_of(&mesh, &parts.decode())?.mean() / whole.mean());
        }
        row.extend(ratios.iter().map(|ratio| format!("{ratio:.2}")));
        row.push(format!("{seconds:.1}"));
        table.row(row);
    }
    Ok(table.markdown())
}

/// Tables every scheme at a quality of 11 bits.
fn scheme_table() -> Result<String> {
    let mut table = Table::new([
        "at the quality of 11 bits",
        "reduction, %",
        "mean",
        "max",
        "flipped faces",
        "flipped by 11 bits",
        "positions, bytes per vertex",
        "faces, bytes per face",
        "total, bytes per face",
        "CPU s",
    ]);
    for name in MESHES {
        let Some(mesh) = crate::read(name)? else { continue };
        let rounded = global(&mesh, BITS, Rounding::Nearest);
        let whole = distance_of(&mesh, &rounded)?;
        for (title, scheme) in SCHEMES {
            let bounds = AttributeBounds::default();
            let mut done = None;
            let seconds = least_seconds(1, || {
                done = Some(compress(&mesh, scheme, CompressionTarget::Bits(BITS), &bounds));
            });
            let Compression { compressed, vertices, .. } = done.context("the work has run")??;
            let decoded = compressed.decode()?;
            let is = distance_of(&mesh, &decoded)?;
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
