//! Measures compressed files for transmission, by meshlod and Draco.

use anyhow::{Context, Result};
use meshlod::Mesh;
use meshlod::codec::{Transport, TransportFile, TransportOptions};

use crate::lab::table::Table;
use crate::{least_seconds, one_core};

/// Bytes per triangle of Draco with 11 bits and compression level 7, the whole mesh in one piece,
/// measured with its own program.
const DRACO: [(&str, f64); 10] = [
    ("squirrel-20k.obj", 1.210),
    ("fandisk-32k.ply", 0.985),
    ("bunny.ply", 0.676),
    ("horse.ply", 1.036),
    ("feline.ply", 0.970),
    ("nefertiti.ply", 0.977),
    ("dragon-100k.ply", 1.015),
    ("horse-97k.ply", 0.645),
    ("armadillo-173k.ply", 0.865),
    ("igea.ply", 0.567),
];
const ROUNDS: usize = 5;

/// Returns tables of file sizes by section, and of speed on one core.
pub fn table() -> Result<String> {
    let mut table = Table::new([
        "`.mlz`, 11 bits",
        "blocks",
        "positions, bytes per triangle",
        "faces",
        "headers",
        "total",
        "Draco, without blocks",
        "ratio",
        "encoded, M triangles/s",
        "decoded, MB/s of `f32` and `u32`",
    ]);
    let mut all = Vec::new();
    for (name, draco) in DRACO {
        let Some(mesh) = crate::read(name)? else { continue };
        // Draco was given neither attributes nor objects.
        let mesh = Mesh::new(mesh.positions, mesh.faces);
        let faces = mesh.faces.len() as f64;
        let options = TransportOptions::default();
        let mut done = None;
        let encode =
            one_core(|| least_seconds(ROUNDS, || done = Some(Transport::encode(&mesh, &options))));
        let done = done.context("the work has run")??;
        let file = TransportFile::open(&done.bytes)?;
        let (mut positions, mut indices) = (Vec::new(), Vec::new());
        let decode = one_core(|| {
            least_seconds(ROUNDS, || file.decode_into(&mut positions, &mut indices).is_ok())
        });
        let out = 12.0 * (positions.len() + indices.len()) as f64;
        let sizes = done.sizes;
        let each = [sizes.positions, sizes.connectivity, sizes.headers].map(|bytes| bytes / faces);
        let total = done.bytes.len() as f64 / faces;
        all.push(total);
        let mut row = vec![name.to_owned(), done.blocks.to_string()];
        row.extend(each.iter().map(|bytes| format!("{bytes:.3}")));
        row.push(format!("{total:.3}"));
        row.push(format!("{draco:.3}"));
        row.push(format!("{:.2}", total / draco));
        row.push(format!("{:.1}", faces / encode / 1e6));
        row.push(format!("{:.0}", out / decode / 1e6));
        table.row(row);
    }
    let mean = all.iter().sum::<f64>() / all.len().max(1) as f64;
    Ok(format!("{}The mean of the totals is {mean:.3} bytes per triangle.\n\n", table.markdown()))
}
