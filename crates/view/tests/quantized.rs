//! Compressed geometry drawn as it is stored, against the decoded mesh.

mod common;

use common::compressed::{Stage, by_schemes};
use common::{difference, gpu};
use meshlod::codec::Compressed;
use meshlod::mesh::{Attributes, Layer, LayerKind, WedgeId};
use meshlod::picture::{Camera, Normals, View};
use meshlod::samples;
use meshlod_view::{GpuCompressed, Shade};

/// Asserts that a compressed mesh is drawn as the decoded one: a few pixels at edges may differ,
/// where positions that are rounded elsewhere cover another sample.
fn assert_as_decoded(name: &str, stage: &Stage<'_>, compressed: &Compressed, normals: Normals) {
    let decoded = compressed.decode().unwrap();
    let camera = Camera::fit_mesh(&decoded, &View { aspect: 1.0, ..View::default() });
    let expected = stage.draw_mesh(&decoded, normals, &camera);
    let drawn = stage.compressed(compressed);
    assert_eq!(drawn.faces(), decoded.faces.len());
    let picture = stage.draw(&drawn, &camera, &Shade::default(), &Default::default());
    let (far, mean) = difference(&picture, &expected, 8);
    println!("{name}: {:.3} % differ by more than 8 levels, mean {mean:.4}", 100.0 * far);
    assert!(far < 0.002 && mean < 0.05, "{name}: {far} {mean}");
    let covered = picture.rgba().chunks_exact(4).filter(|pixel| pixel[3] > 0).count();
    assert!(covered > 5_000, "{name}: {covered} pixels are covered");
}

#[test]
fn every_scheme_draws_the_decoded_mesh() {
    let Some(gpu) = gpu() else { return };
    let stage = Stage::new(gpu, 320);
    for name in ["sphere", "knot", "gyroid", "fish", "torus"] {
        let mut mesh = samples::by_name(name, Some(8_000)).unwrap();
        mesh.attributes = None;
        for bits in [8, 11] {
            for (scheme, compressed) in by_schemes(&mesh, bits) {
                let name = format!("{name}, {scheme}, {bits} bits");
                assert_as_decoded(&name, &stage, &compressed, Normals::Flat);
            }
        }
    }
}

#[test]
fn coordinates_in_the_millions_lose_nothing() {
    let Some(gpu) = gpu() else { return };
    let stage = Stage::new(gpu, 320);
    let mut knot = samples::knot(8_000);
    knot.attributes = None;
    // Large enough for the cells of parts, which cannot be finer than f32 is at the farthest vertex.
    for position in &mut knot.positions {
        *position = [1e3 * position[0] + 4.5e6, 1e3 * position[1] - 3.2e6, 1e3 * position[2] + 1e6];
    }
    for (scheme, compressed) in by_schemes(&knot, 10) {
        assert_as_decoded(&format!("far, {scheme}"), &stage, &compressed, Normals::Flat);
    }
}

#[test]
fn normals_and_seams_are_those_of_the_file() {
    let Some(gpu) = gpu() else { return };
    let stage = Stage::new(gpu, 320);
    let mut mesh = samples::torus(6_000);
    // Half of the corners lean, so that vertices have two wedges each.
    let count = mesh.positions.len();
    let normal = |at: usize| {
        let [x, y, z] = mesh.positions[at % count];
        let lean = if at < count { 0.0 } else { 0.4 };
        let long = (x * x + y * y + z * z).sqrt().max(1e-9);
        [x / long + lean, y / long, z / long - lean].map(|x| x as f32)
    };
    let values = (0..2 * count).flat_map(normal).collect();
    let name = "normal".to_string();
    let layer = Layer { kind: LayerKind::Normal, name, width: 3, values };
    let corners = mesh.faces.iter().enumerate().map(|(face, corners)| {
        corners.map(|v| WedgeId::new(v.index() + if face % 3 == 0 { count } else { 0 }))
    });
    let corners = corners.collect();
    mesh.attributes = Some(Attributes { corners, wedge_count: 2 * count, layers: vec![layer] });
    for (scheme, compressed) in by_schemes(&mesh, 9) {
        assert_as_decoded(&format!("normals, {scheme}"), &stage, &compressed, Normals::FromMesh);
    }
}

#[test]
fn colours_tell_pieces_apart() {
    let Some(gpu) = gpu() else { return };
    let stage = Stage::new(gpu, 200);
    let mut mesh = samples::sphere(5_000);
    mesh.attributes = None;
    let lighting = meshlod::picture::Lighting::Unlit;
    let shade = Shade { face_colors: true, lighting, ..Shade::default() };
    for (scheme, compressed) in by_schemes(&mesh, 9) {
        let drawn = stage.compressed(&compressed);
        let camera = Camera::fit_mesh(&mesh, &View::default());
        let picture = stage.draw(&drawn, &camera, &shade, &Default::default());
        let mut colors: Vec<_> = picture.rgba().as_chunks::<4>().0.to_vec();
        colors.sort_unstable();
        let colors = colors.chunk_by(|a, b| a == b).filter(|same| same.len() > 20).count();
        // Those that are seen, and the background; colours may meet.
        assert!(colors > (compressed.blocks() / 4).clamp(2, 20), "{scheme}: {colors}");
    }
}

#[test]
fn an_empty_file_draws_nothing() {
    let Some(gpu) = gpu() else { return };
    let stage = Stage::new(gpu, 64);
    let mut bytes = Compressed::MAGIC.to_vec();
    // Version 1, parts, no layers; the lengths of the sections, with room for the checksums.
    bytes.extend([1, 0, 0, 0, 0, 0, 0, 0]);
    for length in [21u64, 8, 0] {
        bytes.extend(length.to_le_bytes());
        bytes.extend([0; 4]);
    }
    bytes.extend([0; 4]);
    // No flags, vertices, or parts; cells of one. No bits of faces, no exceptions.
    bytes.extend([0; 9]);
    bytes.extend([1f32; 3].iter().flat_map(|side| side.to_le_bytes()));
    bytes.extend([0; 8]);
    Compressed::seal(&mut bytes);
    let drawn = stage.compressed(&Compressed::from_bytes(&bytes).unwrap());
    let camera = Camera::fit_mesh(&samples::sphere(100), &View::default());
    let picture = stage.draw(&drawn, &camera, &Shade::default(), &Default::default());
    assert_eq!(drawn.faces(), 0);
    assert!(picture.rgba().iter().all(|&level| level == 0));
}

#[test]
fn single_faces_are_drawn_and_damage_does_no_harm() {
    let Some(gpu) = gpu() else { return };
    let stage = Stage::new(gpu, 64);
    let mut one = samples::sphere(8);
    one.attributes = None;
    one.faces.truncate(1);
    for (scheme, compressed) in by_schemes(&one, 4) {
        let drawn = stage.compressed(&compressed);
        assert_eq!(drawn.faces(), 1, "{scheme}");
        let camera = Camera::fit_mesh(&compressed.decode().unwrap(), &View::default());
        stage.draw(&drawn, &camera, &Shade::default(), &Default::default());
        stage.gpu.wait().unwrap();
    }
    // Damage that the checksums do not catch gives an error or a picture, not a panic.
    for (_, compressed) in by_schemes(&samples::gyroid(400), 6) {
        let bytes = compressed.to_bytes();
        for bit in (0..8 * bytes.len()).step_by(1 + bytes.len() / 8) {
            let mut damaged = bytes.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            Compressed::seal(&mut damaged);
            let Ok(read) = Compressed::from_bytes(&damaged) else { continue };
            let Ok(drawn) = GpuCompressed::new(&stage.renderer, &read) else { continue };
            let camera = Camera::fit_mesh(&one, &View::default());
            stage.draw(&drawn, &camera, &Shade::default(), &Default::default());
        }
    }
}
