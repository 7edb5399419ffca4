//! Measures what decoding in the vertex shader costs: draws a mesh as plain `f32` positions and as
//! parts, blocks and lattice of about 11 bits, in turn.
//!
//! `cargo run --release -p meshlod-view --example compressed_cost -- MESH... [SIDE]`; default: 512
//! pixels. Times are those of a submission until the GPU is done, medians of 21.

use std::error::Error;
use std::time::Instant;

use meshlod::Mesh;
use meshlod::codec::{
    Compressed, CompressionTarget, Partitioner, Reconstruction, Scheme, compress,
};
use meshlod::mesh::AttributeBounds;
use meshlod::picture::{Camera, View};
use meshlod_view::{Canvas, Gpu, GpuCompressed, Placement, Renderer, Shade, TargetFormat};

const TURNS: usize = 21;

fn main() -> Result<(), Box<dyn Error>> {
    let (sides, paths): (Vec<_>, Vec<_>) =
        std::env::args().skip(1).partition(|text| text.parse::<u32>().is_ok());
    let side = sides.first().map_or(Ok(512), |text| text.parse())?;
    let gpu = Gpu::headless()?;
    let renderer = Renderer::new(&gpu, TargetFormat::CANVAS);
    println!("{}, {side} x {side} pixels", gpu.name());
    println!("| | | ms | / plain | bytes a vertex | plain |\n|---|---|--:|--:|--:|--:|");
    for path in paths {
        let mut mesh = meshlod::read(&path, &Default::default())?.into_mesh();
        mesh.attributes = None;
        let name = path.rsplit('/').next().unwrap_or(&path);
        measure(&renderer, name.trim_end_matches(".ply"), &mesh, side)?;
    }
    Ok(())
}

/// Prints a row for each scheme, compared with the decoded mesh in the order of its faces.
fn measure(renderer: &Renderer, name: &str, mesh: &Mesh, side: u32) -> Result<(), Box<dyn Error>> {
    for (scheme, compressed) in schemes(mesh)? {
        let decoded = compressed.decode()?;
        let plain = GpuCompressed::uncompressed(renderer, &decoded)?;
        let packed = GpuCompressed::new(renderer, &compressed)?;
        let camera = Camera::fit_mesh(&decoded, &View::default());
        let both = [&plain, &packed];
        let placements = both.map(|drawn| {
            let placement = renderer.placement();
            placement.set(&camera, [side; 2], drawn.origin(), &Shade::default());
            placement
        });
        let canvas = Canvas::new(renderer.gpu(), [side; 2])?;
        let mut times = [Vec::new(), Vec::new()];
        for _ in 0..TURNS {
            for k in 0..2 {
                times[k].push(seconds(renderer, &canvas, both[k], &placements[k])?);
            }
        }
        let [plain_ms, packed_ms] = times.map(|times| 1e3 * median(times));
        let count = decoded.positions.len() as f64;
        println!(
            "| {name} | {scheme} | {packed_ms:.2} | {:.3} | {:.2} | {:.2} |",
            packed_ms / plain_ms,
            packed.vertex_bytes() as f64 / count,
            plain.vertex_bytes() as f64 / count,
        );
    }
    Ok(())
}

/// Compresses a mesh to about the error of 11 bits; parts to their usual reduction of 70 %.
fn schemes(mesh: &Mesh) -> Result<Vec<(&'static str, Compressed)>, Box<dyn Error>> {
    let bounds = AttributeBounds::default();
    let by = |scheme, target| compress(mesh, scheme, target, &bounds).map(|done| done.compressed);
    let eleven = CompressionTarget::Bits(11);
    // The best reduction that the mesh allows may be less.
    let reduction = Partitioner::new(mesh)?.within_reduction(0.7, Reconstruction::Centred);
    let reduction = reduction.map_or(0.5, |_| 0.7);
    let parts = Scheme::Parts(Reconstruction::Centred);
    Ok(vec![
        ("parts", by(parts, CompressionTarget::Reduction(reduction))?),
        ("blocks", by(Scheme::Blocks, eleven)?),
        ("lattice", by(Scheme::Lattice, eleven)?),
    ])
}

/// Draws once, and returns how long the GPU took.
fn seconds(
    renderer: &Renderer,
    canvas: &Canvas,
    drawn: &GpuCompressed,
    placement: &Placement,
) -> Result<f64, Box<dyn Error>> {
    let start = Instant::now();
    canvas.draw(|pass| drawn.draw(renderer, pass, placement));
    renderer.gpu().wait()?;
    Ok(start.elapsed().as_secs_f64())
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
