//! Measures the distance of simplified meshes from their originals, for meshlod and other programs.

use anyhow::Result;
use meshlod::measure::{Distance, DistanceOptions, PreparedSurface, surface_distance};
use meshlod::mesh::Mesh;
use meshlod::simplify::{Method, Options, Target, contract_to};

use crate::lab::table::Table;
use crate::peer::{Indexed, simplify_with_update};

/// A recorded result of another program: mean, RMS and maximum in percent of the diagonal.
struct Peer {
    file: &'static str,
    ratio: f64,
    name: &'static str,
    figures: [f64; 3],
}

const fn peer(file: &'static str, ratio: f64, name: &'static str, figures: [f64; 3]) -> Peer {
    Peer { file, ratio, name, figures }
}

const FILES: [&str; 4] = ["bunny.ply", "horse-97k.ply", "igea.ply", "dragon.ply"];
const RATIOS: [f64; 2] = [0.1, 0.01];

/// The best quadric program by mean error, and CGAL 5.5.1's Lindstrom–Turk. The others are VTK
/// 9.7.2, libigl 2.6.3 and Blender 5.0.1. Measured on 2026-11-21 with the same metric on the same
/// meshes.
const PEERS: [Peer; 16] = [
    peer("bunny.ply", 0.1, "VTK", [0.01908, 0.02491, 0.2318]),
    peer("bunny.ply", 0.1, "CGAL", [0.01424, 0.01923, 0.3285]),
    peer("bunny.ply", 0.01, "VTK", [0.13451, 0.17382, 0.9215]),
    peer("bunny.ply", 0.01, "CGAL", [0.09903, 0.13571, 1.8490]),
    peer("horse-97k.ply", 0.1, "libigl", [0.01004, 0.01315, 0.3987]),
    peer("horse-97k.ply", 0.1, "CGAL", [0.00721, 0.01012, 0.4025]),
    peer("horse-97k.ply", 0.01, "libigl", [0.08086, 0.10415, 0.7567]),
    peer("horse-97k.ply", 0.01, "CGAL", [0.05806, 0.08005, 1.0334]),
    peer("igea.ply", 0.1, "VTK", [0.00569, 0.00751, 0.0700]),
    peer("igea.ply", 0.1, "CGAL", [0.00437, 0.00610, 0.0944]),
    peer("igea.ply", 0.01, "Blender", [0.04018, 0.05360, 0.4265]),
    peer("igea.ply", 0.01, "CGAL", [0.03045, 0.04149, 0.3994]),
    peer("dragon.ply", 0.1, "VTK", [0.00339, 0.00463, 0.6704]),
    peer("dragon.ply", 0.1, "CGAL", [0.00264, 0.00368, 0.2018]),
    peer("dragon.ply", 0.01, "VTK", [0.02717, 0.03640, 1.7096]),
    peer("dragon.ply", 0.01, "CGAL", [0.02441, 0.03350, 0.7891]),
];

/// Largest number of faces for `pm`, which takes minutes beyond.
const MOST_FOR_PM: usize = 100_000;

/// Name of the default method with its option `polish`.
const POLISHED: &str = "lindstrom-turk --polish";

/// Returns tables of the mean, RMS and maximum distance by mesh, ratio and method.
pub fn section() -> Result<String> {
    let mut table = Table::new(["mesh, ratio, method", "faces", "mean %", "RMS %", "max %"]);
    for file in FILES {
        let Some(mesh) = crate::read(file)? else { continue };
        let surface = PreparedSurface::new(&mesh)?;
        for ratio in RATIOS {
            add_rows(&mut table, file, &mesh, &surface, ratio)?;
        }
    }
    Ok(format!(
        "Ours and meshoptimizer's simplify with update (crate meshopt 0.7.0) in this run; the best \
         quadric program and CGAL's Lindstrom–Turk as measured on 2026-11-21. To reproduce a row: \
         `meshlod simplify MESH out.ply --ratio R --method M`, `meshlod measure MESH out.ply`.\n\n{}",
        table.markdown()
    ))
}

fn add_rows(
    table: &mut Table,
    file: &str,
    mesh: &Mesh,
    surface: &PreparedSurface<'_>,
    ratio: f64,
) -> Result<()> {
    let what = |method: &str| format!("{file}, {:.0} %, {method}", ratio * 100.0);
    let plain = |method: Method| (method.name(), Options { method, ..Options::default() });
    let polish = Options { polish: true, ..Options::default() };
    for (name, options) in Method::ALL.map(plain).into_iter().chain([(POLISHED, polish)]) {
        if options.method == Method::Pm && mesh.faces.len() > MOST_FOR_PM {
            continue;
        }
        let (level, _) = contract_to(mesh, Target::Ratio(ratio), &options)?;
        table.row(row(&what(name), &level, surface)?);
    }
    let target = (mesh.faces.len() as f64 * ratio) as usize;
    let level = Mesh::from(&simplify_with_update(&Indexed::from(mesh), target));
    table.row(row(&what("meshoptimizer"), &level, surface)?);
    for peer in PEERS.iter().filter(|peer| (peer.file, peer.ratio) == (file, ratio)) {
        let [mean, rms, max] = peer.figures.map(|x| format!("{x:.5}"));
        table.row([what(&format!("{} (recorded)", peer.name)), "".to_owned(), mean, rms, max]);
    }
    Ok(())
}

fn row(what: &str, level: &Mesh, surface: &PreparedSurface<'_>) -> Result<[String; 5]> {
    let options = DistanceOptions::default();
    let d: Distance = surface_distance(surface, &PreparedSurface::new(level)?, &options)?;
    let figures = [d.mean(), d.rms(), d.max()].map(|x| format!("{:.5}", d.percent(x)));
    let [mean, rms, max] = figures;
    Ok([what.to_owned(), level.faces.len().to_string(), mean, rms, max])
}
