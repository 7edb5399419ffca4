//! Rate-distortion plots of the compression schemes.

use anyhow::Result;
use meshlod::Mesh;
use meshlod::codec::{CompressionTarget, Reconstruction, Scheme, compress};
use meshlod::mesh::AttributeBounds;

use super::distance_of;
use super::global::{Rounding, global, numbers};
use crate::lab::plot::{Line, Plot, page};
use crate::peer::meshopt_codec;

const MESHES: [&str; 2] = ["bunny.ply", "horse.ply"];
const BITS: [u32; 5] = [8, 10, 11, 12, 14];

/// Plots bytes per vertex for positions, and bytes per face in total, against the bits of a global
/// grid of equal accuracy.
pub fn drawing() -> Result<Option<String>> {
    let mut plots = Vec::new();
    for file in MESHES {
        let Some(mesh) = crate::read(file)? else { return Ok(None) };
        let [positions, all] = lines(&mesh)?;
        let name = file.trim_end_matches(".ply");
        plots.push(plot(format!("{name}: positions, bytes per vertex"), positions));
        plots.push(plot(format!("{name}: total, bytes per face"), all));
    }
    Ok(Some(page(&plots)))
}

fn plot(caption: String, lines: Vec<Line>) -> Plot {
    Plot { caption, across: [6.0, 16.0], unit: "", up_from: None, low_key: false, lines }
}

fn lines(mesh: &Mesh) -> Result<[Vec<Line>; 2]> {
    let reference = distance_of(mesh, &global(mesh, 11, Rounding::Nearest))?.mean();
    let as_good = |mean: f64| 11.0 + (reference / mean).log2();
    let (vertices, faces) = (mesh.positions.len() as f64, mesh.faces.len() as f64);
    let (mut positions, mut all) = (Vec::new(), Vec::new());
    let schemes = [
        ("parts, as in the paper", "#999999", Scheme::Parts(Reconstruction::Truncated)),
        ("parts", "#d9822b", Scheme::Parts(Reconstruction::Centred)),
        ("blocks", "#c53030", Scheme::Blocks),
        ("lattice", "#2b6cb0", Scheme::Lattice),
    ];
    for (name, color, scheme) in schemes {
        let mut points = [Vec::new(), Vec::new()];
        for bits in BITS {
            let done =
                compress(mesh, scheme, CompressionTarget::Bits(bits), &AttributeBounds::default())?;
            let at = as_good(distance_of(mesh, &done.compressed.decode()?)?.mean());
            let sizes = done.compressed.sizes();
            points[0].push([at, sizes.positions as f64 / vertices]);
            points[1].push([at, sizes.total as f64 / faces]);
        }
        let [first, second] = points;
        positions.push(Line::new(name, color, first));
        all.push(Line::new(name, color, second));
    }
    let packed = BITS.map(|bits| [f64::from(bits), 3.0 * f64::from(bits) / 8.0]);
    positions.push(Line::new("global grid of as many bits", "#444444", packed.to_vec()).dashed());
    let peer = BITS.map(|bits| {
        let (cells, _) = numbers(mesh, bits, Rounding::Nearest);
        let cells: Vec<_> = cells.iter().map(|cell| cell.map(|x| x as u16)).collect();
        (f64::from(bits), meshopt_codec(&cells, &mesh.faces))
    });
    let peer_line = |points: Vec<[f64; 2]>| Line::new("meshoptimizer's codecs", "#7b4bb3", points);
    positions.push(peer_line(peer.map(|(bits, [p, _])| [bits, p as f64 / vertices]).to_vec()));
    all.push(peer_line(peer.map(|(bits, [p, i])| [bits, (p + i) as f64 / faces]).to_vec()));
    Ok([positions, all])
}
