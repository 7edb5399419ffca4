//! Search for cracks: background that shows through a closed mesh.
//!
//! `MESHLOD_CRACK_VIEWS` and `MESHLOD_CRACK_SIDE` search in more views and pixels, and
//! `MESHLOD_CRACK_MESHES` in meshes of the shared folder, such as
//! `horse-97k.ply,armadillo-52k.ply`.

mod common;

use std::f64::consts::{FRAC_PI_4, PI};

use common::compressed::Stage;
use common::gpu;
use meshlod::Mesh;
use meshlod::codec::{Compressed, CompressionTarget, Reconstruction, Scheme, compress};
use meshlod::mesh::AttributeBounds;
use meshlod::picture::{Camera, Picture, View};
use meshlod::samples;
use meshlod_view::{CompressedOptions, GpuCompressed, Shade};

/// Returns evenly spread directions.
fn all_round(count: u32) -> impl Iterator<Item = [f64; 3]> {
    let golden = PI * (3.0 - 5f64.sqrt());
    (0..count).map(move |i| {
        let y = 1.0 - (2 * i + 1) as f64 / f64::from(count);
        let (around, radius) = (golden * f64::from(i), (1.0 - y * y).sqrt());
        [radius * around.cos(), y, radius * around.sin()]
    })
}

/// Counts the pixels within the silhouette through which background shows, be it in one of their
/// samples. A pixel is within if the whole mesh covers it and its eight neighbours in full.
fn cracks(whole: &Picture, drawn: &Picture, side: usize) -> usize {
    let alpha = |picture: &Picture, at: usize| picture.rgba()[4 * at + 3];
    let is_within = |at: usize| {
        let (x, y) = (at % side, at / side);
        let is_inner = |c: usize| (1..side - 1).contains(&c);
        let row = |y: usize| (x - 1..=x + 1).all(|x| alpha(whole, y * side + x) == 255);
        is_inner(x) && is_inner(y) && (y - 1..=y + 1).all(row)
    };
    (0..side * side).filter(|&at| alpha(drawn, at) < 255 && is_within(at)).count()
}

fn number(name: &str, default: u32) -> u32 {
    std::env::var(name).map_or(default, |text| text.parse().expect("a number"))
}

/// Meshes in which to look for cracks.
fn closed_meshes() -> Vec<(String, Mesh)> {
    let mut meshes: Vec<_> = match std::env::var("MESHLOD_CRACK_MESHES") {
        Ok(names) => {
            let found = |name: &str| Some((name.into(), meshlod_fixtures::shared_mesh(name)?));
            let all = names.split(',').filter_map(found);
            all.map(|(name, path)| (name, meshlod::read(&path, &Default::default()).unwrap()))
                .map(|(name, scene): (String, _)| (name, scene.into_mesh()))
                .collect()
        }
        Err(_) => ["sphere", "knot", "torus"]
            .map(|name| (name.to_string(), samples::by_name(name, Some(30_000)).unwrap()))
            .into(),
    };
    meshes.iter_mut().for_each(|(_, mesh)| mesh.attributes = None);
    meshes
}

/// Counts the cracks of all views as it is drawn by default, then by a matrix for each part if it
/// has parts; both with faces from behind and without them.
fn cracks_all_round(stage: &Stage<'_>, compressed: &Compressed) -> [[usize; 2]; 2] {
    cracks_in(stage, compressed, compressed)
}

/// Counts the cracks of a compressed mesh within the silhouette of another one.
fn cracks_in(stage: &Stage<'_>, compressed: &Compressed, whole: &Compressed) -> [[usize; 2]; 2] {
    let decoded = whole.decode().unwrap();
    let whole = GpuCompressed::uncompressed(&stage.renderer, &decoded).unwrap();
    let drawn = stage.compressed(compressed);
    let matrices = drawn.part_matrices(&stage.renderer);
    let ways = [Some(None), matrices.as_ref().map(Some)];
    let side = stage.canvas.size()[0] as usize;
    let mut count = [[0; 2]; 2];
    for direction in all_round(number("MESHLOD_CRACK_VIEWS", 6)) {
        let up = if direction[1].abs() > 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
        let view = View { direction, up, fov_rad: FRAC_PI_4, fill: 0.95, aspect: 1.0 };
        let camera = Camera::fit_mesh(&decoded, &view);
        let shade = Shade::default();
        let whole = stage.draw(&whole, &camera, &shade, &Default::default());
        for (count, way) in count.iter_mut().zip(ways) {
            let Some(part_matrices) = way else { continue };
            for (count, culls_back_faces) in count.iter_mut().zip([false, true]) {
                let options = CompressedOptions { culls_back_faces, part_matrices };
                let picture = stage.draw(&drawn, &camera, &shade, &options);
                *count += cracks(&whole, &picture, side);
            }
        }
    }
    count
}

/// Returns a mesh by all schemes; parts at the reduction that is asked for, or all that is
/// possible.
fn schemes_with_parts(mesh: &Mesh) -> Vec<(&'static str, Compressed)> {
    let by = |scheme, target| {
        compress(mesh, scheme, target, &AttributeBounds::default()).unwrap().compressed
    };
    let reduction = CompressionTarget::Reduction(if mesh.faces.len() > 40_000 { 0.7 } else { 0.6 });
    vec![
        ("parts", by(Scheme::Parts(Reconstruction::Centred), reduction)),
        ("truncated parts", by(Scheme::Parts(Reconstruction::Truncated), reduction)),
        ("blocks", by(Scheme::Blocks, CompressionTarget::Bits(11))),
        ("lattice", by(Scheme::Lattice, CompressionTarget::Bits(11))),
    ]
}

#[test]
fn no_background_shows_through() {
    let Some(gpu) = gpu() else { return };
    let stage = Stage::new(gpu, number("MESHLOD_CRACK_SIDE", 512));
    for (name, mesh) in closed_meshes() {
        for (scheme, compressed) in schemes_with_parts(&mesh) {
            let [added, by_matrix] = cracks_all_round(&stage, &compressed);
            let pieces = compressed.blocks();
            println!("{name}, {scheme}, {pieces} pieces: {added:?} cracks");
            if scheme.ends_with("parts") {
                println!("{name}, {scheme}, {pieces} pieces, a matrix each: {by_matrix:?} cracks");
            }
            assert_eq!(added, [0, 0], "{name}, {scheme}");
        }
    }
}

/// Moves the second part of an `.mlq` file by two cells.
fn misplaced(compressed: &Compressed) -> Compressed {
    let mut bytes = compressed.to_bytes();
    // After the header, flags, two counts and the cell: the number of nodes and three offsets each.
    let parts = 56 + 1 + 8 + 12;
    let offset = parts + 10 + 4;
    let x = i16::from_le_bytes([bytes[offset], bytes[offset + 1]]) + 2;
    bytes[offset..offset + 2].copy_from_slice(&x.to_le_bytes());
    Compressed::seal(&mut bytes);
    Compressed::from_bytes(&bytes).unwrap()
}

#[test]
fn a_misplaced_part_is_found_as_a_crack() {
    let Some(gpu) = gpu() else { return };
    let stage = Stage::new(gpu, 512);
    let mut mesh = samples::torus(20_000);
    mesh.attributes = None;
    let target = CompressionTarget::Reduction(0.6);
    let scheme = Scheme::Parts(Reconstruction::Centred);
    let done = compress(&mesh, scheme, target, &AttributeBounds::default()).unwrap();
    let [[all, culled], _] = cracks_in(&stage, &misplaced(&done.compressed), &done.compressed);
    println!("one of {} parts misplaced: {all} cracks, {culled} culled", done.compressed.blocks());
    assert!(culled > 20, "{culled}");
}
