//! Compressed geometry drawn as it is stored, against the decoded mesh; and a search for cracks.
//!
//! `MESHLOD_CRACK_VIEWS` and `MESHLOD_CRACK_SIDE` search in more views and pixels, and
//! `MESHLOD_CRACK_MESHES` in meshes of the shared folder, such as `horse-97k.ply,armadillo-52k.ply`.

mod common;

use std::f64::consts::{FRAC_PI_4, PI};

use common::{difference, gpu};
use meshlod::Mesh;
use meshlod::codec::{
    AttributeBounds, Compressed, CompressionTarget, Reconstruction, Scheme, compress,
};
use meshlod::mesh::{Attributes, Layer, LayerKind, WedgeId};
use meshlod::picture::{Camera, Normals, Paint, Picture, View};
use meshlod::samples;
use meshlod_view::{
    Canvas, CompressedOptions, Gpu, GpuCompressed, GpuMesh, Renderer, Shade, TargetFormat,
};

const CLAY: Paint<'static> = Paint::Plain([226, 208, 186]);

/// Returns a mesh by all schemes, with cells of about a number of bits for the whole mesh.
fn by_schemes(mesh: &Mesh, bits: u32) -> Vec<(&'static str, Compressed)> {
    let by = |scheme| {
        let target = CompressionTarget::Bits(bits);
        compress(mesh, scheme, target, &AttributeBounds::default()).unwrap().compressed
    };
    vec![
        ("parts", by(Scheme::Parts(Reconstruction::Centred))),
        ("truncated parts", by(Scheme::Parts(Reconstruction::Truncated))),
        ("blocks", by(Scheme::Blocks)),
        ("lattice", by(Scheme::Lattice)),
    ]
}

/// How a test draws.
struct Stage<'g> {
    renderer: Renderer,
    canvas: Canvas,
    gpu: &'g Gpu,
}

impl<'g> Stage<'g> {
    fn new(gpu: &'g Gpu, side: u32) -> Self {
        let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
        Self { renderer, canvas: Canvas::new(gpu, [side; 2]).unwrap(), gpu }
    }

    fn compressed(&self, compressed: &Compressed) -> GpuCompressed {
        GpuCompressed::new(&self.renderer, compressed).unwrap()
    }

    fn draw(
        &self,
        drawn: &GpuCompressed,
        camera: &Camera,
        shade: &Shade,
        options: &CompressedOptions<'_>,
    ) -> Picture {
        let placement = self.renderer.placement();
        placement.set(camera, self.canvas.size(), drawn.origin(), shade);
        if let Some(matrices) = options.part_matrices {
            matrices.set(camera, self.canvas.size());
        }
        self.canvas.draw(|pass| drawn.draw_with(&self.renderer, pass, &placement, options));
        self.canvas.read().unwrap()
    }

    /// Draws a mesh by the pipelines of meshes.
    fn draw_mesh(&self, mesh: &Mesh, normals: Normals, camera: &Camera) -> Picture {
        let drawn = GpuMesh::new(&self.renderer, mesh, &CLAY, normals).unwrap();
        let placement = self.renderer.placement();
        placement.set(camera, self.canvas.size(), drawn.origin(), &Shade::default());
        self.canvas.draw(|pass| drawn.draw(&self.renderer, pass, &placement));
        self.canvas.read().unwrap()
    }
}

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
fn broken_parts_are_refused_and_small_meshes_drawn() {
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

/// Number of cracks in all views: with faces from behind, and without them.
fn cracks_all_round(
    stage: &Stage<'_>,
    drawn: &GpuCompressed,
    whole: &GpuCompressed,
    mesh: &Mesh,
    by_matrix: bool,
) -> [usize; 2] {
    let matrices = drawn.part_matrices(&stage.renderer).filter(|_| by_matrix);
    let mut count = [0; 2];
    for direction in all_round(number("MESHLOD_CRACK_VIEWS", 6)) {
        let up = if direction[1].abs() > 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
        let view = View { direction, up, fov_rad: FRAC_PI_4, fill: 0.95, aspect: 1.0 };
        let camera = Camera::fit_mesh(mesh, &view);
        let shade = Shade::default();
        let whole = stage.draw(whole, &camera, &shade, &Default::default());
        for (count, culls_back_faces) in count.iter_mut().zip([false, true]) {
            let options = CompressedOptions { culls_back_faces, part_matrices: matrices.as_ref() };
            let picture = stage.draw(drawn, &camera, &shade, &options);
            *count += cracks(&whole, &picture, stage.canvas.size()[0] as usize);
        }
    }
    count
}

#[test]
fn no_background_shows_through() {
    let Some(gpu) = gpu() else { return };
    let stage = Stage::new(gpu, number("MESHLOD_CRACK_SIDE", 512));
    for (name, mesh) in closed_meshes() {
        let mut meshes = by_schemes(&mesh, 9);
        let bounds = AttributeBounds::default();
        for (scheme, cells) in
            [("parts", Reconstruction::Centred), ("truncated parts", Reconstruction::Truncated)]
        {
            let target = CompressionTarget::Reduction(0.6);
            let done = compress(&mesh, Scheme::Parts(cells), target, &bounds).unwrap();
            meshes.push((scheme, done.compressed));
        }
        for (scheme, compressed) in meshes {
            let decoded = compressed.decode().unwrap();
            let whole = GpuCompressed::uncompressed(&stage.renderer, &decoded).unwrap();
            let drawn = stage.compressed(&compressed);
            let found = cracks_all_round(&stage, &drawn, &whole, &decoded, false);
            let pieces = compressed.blocks();
            println!("{name}, {scheme}, {pieces} pieces: {found:?} cracks");
            if scheme.ends_with("parts") {
                let found = cracks_all_round(&stage, &drawn, &whole, &decoded, true);
                println!("{name}, {scheme}, {pieces} pieces, a matrix each: {found:?} cracks");
            }
            assert_eq!(found, [0, 0], "{name}, {scheme}");
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
    let decoded = done.compressed.decode().unwrap();
    let whole = GpuCompressed::uncompressed(&stage.renderer, &decoded).unwrap();
    let drawn = stage.compressed(&misplaced(&done.compressed));
    let [all, culled] = cracks_all_round(&stage, &drawn, &whole, &decoded, false);
    println!(
        "{} parts, one of them misplaced: {all} cracks, {culled} culled",
        done.compressed.blocks()
    );
    assert!(culled > 20, "{culled}");
}
