//! Looks for cracks: renders closed meshes with each part placed by its `f32` matrix, from all
//! around, and compares with the mesh that has every vertex once.
//!
//! `cargo run --release -p meshlod-codec --example cracks [VIEWS [SIDE]]`; default: 100 views at
//! 2048 × 2048.

use std::f64::consts::{FRAC_PI_4, PI};

use meshlod_codec::{Partitioner, Parts, Reconstruction};
use meshlod_mesh::{Bounds, Mesh, VertexId};
use meshlod_picture::{Camera, View, Visibility, visibility};

const MESHES: [&str; 5] =
    ["horse.ply", "feline.ply", "armadillo-173k.ply", "horse-97k.ply", "igea.ply"];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut numbers = std::env::args().skip(1).map(|text| text.parse::<u32>());
    let views = numbers.next().transpose()?.unwrap_or(100);
    let side = numbers.next().transpose()?.unwrap_or(2048);
    println!(
        "| | parts | background in {views} views | truncated, as in the paper | a grid per box |"
    );
    println!("|---|--:|--:|--:|--:|");
    for name in MESHES {
        let Some(path) = meshlod_fixtures::shared_mesh(name) else { continue };
        let mesh = meshlod_io::read(&path, &Default::default())?.into_mesh();
        let parting = Partitioner::new(&mesh)?;
        let mut row = Vec::new();
        let mut count = 0;
        for cells in [Reconstruction::Centred, Reconstruction::Truncated] {
            let parts = parting.within_reduction(0.7, cells)?;
            count = parts.parts().len();
            row.push(cracks(&parts.decode(), &drawn(&parts), views, side)?);
        }
        let naive = naive(&parting.within_reduction(0.7, Reconstruction::Centred)?, &mesh);
        row.push(cracks(&mesh, &naive, views, side)?);
        println!(
            "| {} | {count} | {} | {} | {} |",
            name.trim_end_matches(".ply"),
            row[0],
            row[1],
            row[2]
        );
    }
    Ok(())
}

/// Returns the parts as a GPU has them, each with its own vertices.
fn drawn(parts: &Parts) -> Mesh {
    let mut mesh = Mesh::default();
    for part in parts.parts() {
        let matrix = parts.matrix(part);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(part.positions.iter().map(|position| {
            let [x, y, z] = position.map(f32::from);
            matrix.map(|[a, b, c, d]| f64::from(a * x + b * y + c * z + d))
        }));
        mesh.faces.extend(part.faces.iter().map(|face| face.map(|v| VertexId(first + v))));
    }
    mesh
}

/// Returns the same parts, each with 256 cells along its own box, which cracks.
fn naive(parts: &Parts, mesh: &Mesh) -> Mesh {
    let mut naive = Mesh::default();
    for part in parts.parts() {
        let was = part.vertices.iter().map(|v| &mesh.positions[v.index()]);
        let bounds = Bounds::of(was.clone());
        let first = naive.positions.len() as u32;
        naive.positions.extend(was.map(|p| {
            [0, 1, 2].map(|k| {
                let cell = ((bounds.max[k] - bounds.min[k]) / 255.0).max(f64::MIN_POSITIVE);
                bounds.min[k] + ((p[k] - bounds.min[k]) / cell).round() * cell
            })
        }));
        naive.faces.extend(part.faces.iter().map(|face| face.map(|v| VertexId(first + v))));
    }
    naive
}

/// Counts the pixels of all views that show background in the parts, but a face in the whole mesh,
/// there and on all eight sides.
fn cracks(
    whole: &Mesh,
    parts: &Mesh,
    views: u32,
    side: u32,
) -> Result<usize, Box<dyn std::error::Error>> {
    let mut cracks = 0;
    for direction in all_round(views) {
        let up = if direction[1].abs() > 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
        let view = View { direction, up, fov_rad: FRAC_PI_4, fill: 0.95, aspect: 1.0 };
        let camera = Camera::fit_mesh(whole, &view);
        let [whole, parts] = [whole, parts].map(|mesh| visibility(mesh, &camera, [side; 2]));
        cracks += background(&whole?, &parts?, side as usize);
    }
    Ok(cracks)
}

fn background(whole: &Visibility, parts: &Visibility, side: usize) -> usize {
    let is_seen: Vec<bool> = whole.faces().map(|face| face.is_some()).collect();
    let is_within = |at: usize| {
        let (x, y) = (at % side, at / side);
        let is_inner = |c: usize| (1..side - 1).contains(&c);
        is_inner(x)
            && is_inner(y)
            && (y - 1..=y + 1).all(|y| is_seen[y * side + x - 1..=y * side + x + 1] == [true; 3])
    };
    parts.faces().enumerate().filter(|&(at, face)| face.is_none() && is_within(at)).count()
}

/// Returns evenly spread directions.
fn all_round(count: u32) -> impl Iterator<Item = [f64; 3]> {
    let golden = PI * (3.0 - 5f64.sqrt());
    (0..count).map(move |i| {
        let y = 1.0 - (2 * i + 1) as f64 / f64::from(count);
        let (around, radius) = (golden * f64::from(i), (1.0 - y * y).sqrt());
        [radius * around.cos(), y, radius * around.sin()]
    })
}
