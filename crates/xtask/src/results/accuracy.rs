//! How near the levels are to their meshes, beside the peers.

use anyhow::Result;
use meshlod::measure::{Distance, DistanceOptions, Surface, surface_distance};
use meshlod::mesh::Mesh;
use meshlod::simplify::{Method, Options, Target, simplify};
use meshlod_bench::peer::{Indexed, simplify_with_update};

use super::table::Table;
use crate::project::Project;

/// Mean, RMS and maximum, in % of the diagonal, at a ratio.
struct Peer {
    ratio: f64,
    mean: f64,
    rms: f64,
    max: f64,
    name: &'static str,
}

/// The best quadric peer by mean error at 10 % and 1 %: VTK 9.7.2, libigl 2.6.3, Blender 5.0.1,
/// measured on 2026-11-21 with the same metric on the same meshes.
const PEERS: [(&str, [Peer; 2]); 4] = [
    (
        "bunny.ply",
        [
            Peer { ratio: 0.1, mean: 0.01908, rms: 0.02491, max: 0.2318, name: "VTK" },
            Peer { ratio: 0.01, mean: 0.13451, rms: 0.17382, max: 0.9215, name: "VTK" },
        ],
    ),
    (
        "horse-97k.ply",
        [
            Peer { ratio: 0.1, mean: 0.01004, rms: 0.01315, max: 0.3987, name: "libigl" },
            Peer { ratio: 0.01, mean: 0.08086, rms: 0.10415, max: 0.7567, name: "libigl" },
        ],
    ),
    (
        "igea.ply",
        [
            Peer { ratio: 0.1, mean: 0.00569, rms: 0.00751, max: 0.0700, name: "VTK" },
            Peer { ratio: 0.01, mean: 0.04018, rms: 0.05360, max: 0.4265, name: "Blender" },
        ],
    ),
    (
        "dragon.ply",
        [
            Peer { ratio: 0.1, mean: 0.00339, rms: 0.00463, max: 0.6704, name: "VTK" },
            Peer { ratio: 0.01, mean: 0.02717, rms: 0.03640, max: 1.7096, name: "VTK" },
        ],
    ),
];

/// A table of mean, RMS and maximum per mesh, ratio and method.
pub fn section(_: &Project) -> Result<String> {
    let mut table = Table::new(["mesh, ratio, method", "faces", "mean %", "RMS %", "max %"]);
    for (file, peers) in &PEERS {
        let Some(mesh) = meshlod_bench::read(file)? else { continue };
        let surface = Surface::new(&mesh)?;
        for peer in peers {
            add_rows(&mut table, file, &mesh, &surface, peer)?;
        }
    }
    Ok(format!(
        "Ours and meshoptimizer's simplify with update (crate meshopt 0.7.0) in this run; the best \
         quadric peer as measured on 2026-11-21. Any row again: `meshlod simplify MESH out.ply \
         --ratio R --method M`, `meshlod measure MESH out.ply`.\n\n{}",
        table.markdown()
    ))
}

fn add_rows(
    table: &mut Table,
    file: &str,
    mesh: &Mesh,
    surface: &Surface<'_>,
    peer: &Peer,
) -> Result<()> {
    let what = |method: &str| format!("{file}, {:.0} %, {method}", peer.ratio * 100.0);
    for method in Method::ALL {
        let options = Options { method, ..Options::default() };
        let (level, _) = simplify(mesh, Target::Ratio(peer.ratio), &options)?;
        table.row(row(&what(method.name()), &level, surface)?);
    }
    let target = (mesh.faces.len() as f64 * peer.ratio) as usize;
    let level = Mesh::from(&simplify_with_update(&Indexed::from(mesh), target));
    table.row(row(&what("meshoptimizer"), &level, surface)?);
    let [mean, rms, max] = [peer.mean, peer.rms, peer.max].map(|x| format!("{x:.5}"));
    table.row([what(&format!("{} (recorded)", peer.name)), "".to_owned(), mean, rms, max]);
    Ok(())
}

fn row(what: &str, level: &Mesh, surface: &Surface<'_>) -> Result<[String; 5]> {
    let options = DistanceOptions::default();
    let d: Distance = surface_distance(surface, &Surface::new(level)?, &options)?;
    let figures = [d.mean(), d.rms(), d.max()].map(|x| format!("{:.5}", d.percent(x)));
    let [mean, rms, max] = figures;
    Ok([what.to_owned(), level.faces.len().to_string(), mean, rms, max])
}
