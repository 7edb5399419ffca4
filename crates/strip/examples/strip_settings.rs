//! Compares strip settings on whole meshes: vertices and indices per face, ACMR, overdraw and
//! seconds. docs/notes/strips.md has the figures of `cargo xtask results strips`, whose settings
//! differ a little.
//!
//! `cargo run --release -p meshlod-strip --example strip_settings -- bunny.ply fandisk.off`, with meshes of
//! the shared folder; put `--thorough` in front for the slow settings too.

use std::time::Instant;

use meshlod_fixtures::shared_mesh;
use meshlod_mesh::{Mesh, VertexId};
use meshlod_strip::{
    CacheAware, Prices, StripOptions, StripQuality, StripStatistics, difference, overdraw, stripify,
};

fn main() {
    let (flags, names): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|argument| argument.starts_with("--"));
    let thorough = flags.iter().any(|flag| flag == "--thorough");
    println!(
        "| mesh | setting | v/t | idx | stitched | strips | swaps | ACMR-16 | -32 | overdraw | s |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    for name in &names {
        let Some(path) = shared_mesh(name) else { continue };
        match meshlod_io::read(&path, &Default::default()) {
            Ok(scene) => figures(name, &scene.flatten(), thorough),
            Err(error) => eprintln!("{error}"),
        }
    }
}

fn figures(name: &str, mesh: &Mesh, thorough: bool) {
    let best = |moves_per_face| StripQuality::Best { moves_per_face };
    let row = |setting: &str, options: &StripOptions| {
        let start = Instant::now();
        let strips = stripify(&mesh.faces, options);
        let seconds = start.elapsed().as_secs_f64();
        assert_eq!(difference(&strips, &mesh.faces), Default::default(), "{setting}");
        let s = StripStatistics::new(&strips);
        let by_face = |count: usize| count as f64 / s.triangles as f64;
        let triangles: Vec<[VertexId; 3]> = strips.triangles().collect();
        println!(
            "| {name} | {setting} | {:.4} | {:.4} | {:.4} | {} | {} | {:.3} | {:.3} | {:.3} | {seconds:.3} |",
            by_face(s.vertices_sent),
            by_face(s.indices_with_restart),
            by_face(s.indices_stitched),
            s.strips,
            s.swaps,
            s.acmr16,
            s.acmr32,
            overdraw(triangles.iter().copied(), &mesh.positions),
        );
    };
    let fast = StripOptions { quality: StripQuality::Fast, ..StripOptions::default() };
    row("fast", &fast);
    eprintln!("{name}: fast, {:.1} million faces a second", rate(&mesh.faces, &fast) * 1e-6);
    let moves: &[f64] = if thorough { &[20.0, 60.0, 300.0, 1500.0] } else { &[20.0, 60.0] };
    for &moves in moves {
        let options = StripOptions { quality: best(moves), ..StripOptions::default() };
        row(&format!("best, {moves} moves"), &options);
        let options = StripOptions { prices: Prices::with_restarts(), ..options };
        row(&format!("best, {moves} moves, restarts priced"), &options);
    }
    for longest in [10, 12, 14, 16, 20, 24, 32, 48, 96] {
        let cache = Some(CacheAware { longest, ..CacheAware::default() });
        let options = StripOptions { quality: best(60.0), cache, ..StripOptions::default() };
        row(&format!("cache-aware, {longest} faces at most"), &options);
    }
}

/// Faces per second, the best of 50 runs.
fn rate(faces: &[[VertexId; 3]], options: &StripOptions) -> f64 {
    let seconds = |_| {
        let start = Instant::now();
        std::hint::black_box(stripify(faces, options));
        start.elapsed().as_secs_f64()
    };
    faces.len() as f64 / (0..50).map(seconds).fold(f64::INFINITY, f64::min)
}
