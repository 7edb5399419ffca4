//! Textures of whole tiles: what a place of the surface looks like is what it looked like.

mod common;

use std::fs;

use common::Kernel;
use meshlod_io::{Image, Material, Node, ReadOptions, Scene, SceneMesh, Weld};
use meshlod_mesh::{Attributes, Layer, LayerKind, Mesh, VertexId, WedgeId};
use meshlod_picture::{Picture, Texture};
use meshlod_tiles::Cell;
use meshlod_tiles::folder::Folder;
use meshlod_tiles::plan::{Look, Plan, TileOptions};
use meshlod_tiles::source::SceneSource;
use meshlod_tiles::task::run_task;
use meshlod_tiles::texture::repack;
use rayon::ThreadPoolBuilder;
use rayon::prelude::*;

/// Side of the image of the grid.
const SIDE: u32 = 256;

/// Number of squares along a side of the grid.
const SQUARES: u32 = 32;

/// Channel that goes up and down along a texture coordinate.
fn wave(x: f64) -> f64 {
    255.0 * ((8.0 * x).rem_euclid(2.0) - 1.0).abs()
}

/// Colour of the image, which repeats.
fn color([u, v]: [f64; 2]) -> [f64; 3] {
    [wave(u), wave(v + 0.05), 255.0 * (2.0 * u.rem_euclid(1.0) - 1.0).abs()]
}

/// Texture coordinates of the two halves of the grid; the right one lies across.
fn uv([x, y]: [f64; 2], is_right: bool) -> [f64; 2] {
    match is_right {
        false => [0.05 + 0.8 * x, 0.1 + 0.8 * y],
        true => [0.55 + 0.4 * y, 0.95 - 0.8 * (x - 0.5)],
    }
}

fn image() -> Image {
    let texels = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y)));
    let middle = |i: u32| (f64::from(i) + 0.5) / f64::from(SIDE);
    let rgba = texels.flat_map(|(x, y)| {
        let [r, g, b] = color([middle(x), 1.0 - middle(y)]).map(|value| value.round() as u8);
        [r, g, b, 255]
    });
    let bytes = Picture::new(SIDE, SIDE, rgba.collect()).unwrap().png();
    Image { name: "waves.png".into(), bytes }
}

/// Grid of squares, a little curved, in two charts, `left` columns of squares in the first.
fn grid(scale: f64, left: u32) -> Mesh {
    let part = |i: u32| f64::from(i) / f64::from(SQUARES);
    let row = SQUARES + 1;
    let height = |x: f64, y: f64| 0.02 * (x * (1.0 - x) + y * y);
    let places = (0..row).flat_map(|j| (0..row).map(move |i| [part(i), part(j)]));
    let places: Vec<[f64; 2]> = places.collect();
    let positions = places.iter().map(|&[x, y]| [x, y, height(x, y)]).collect();
    let (mut faces, mut corners) = (Vec::new(), Vec::new());
    for (i, j) in (0..SQUARES).flat_map(|j| (0..SQUARES).map(move |i| (i, j))) {
        let [a, b] = [j * row + i, (j + 1) * row + i];
        let own: [[u32; 3]; 2] = [[a, a + 1, b + 1], [a, b + 1, b]];
        let first = if i < left { 0 } else { row * row };
        faces.extend(own.map(|face| face.map(VertexId)));
        corners.extend(own.map(|face| face.map(|v| WedgeId(first + v))));
    }
    let halves = [false, true].into_iter();
    let uvs = halves.flat_map(|is_right| places.iter().map(move |&at| uv(at, is_right)));
    let values: Vec<f32> = uvs.flatten().map(|x| (scale * x) as f32).collect();
    let layer = Layer { kind: LayerKind::Uv(0), name: "uv".into(), width: 2, values };
    let wedge_count = 2 * places.len();
    let mut mesh = Mesh::new(positions, faces);
    mesh.attributes = Some(Attributes { corners, wedge_count, layers: vec![layer] });
    mesh.compact();
    mesh
}

fn textured(mesh: Mesh, image: Image) -> Scene {
    let material = Material { base_color_image: Some(0), ..Material::default() };
    Scene {
        meshes: vec![SceneMesh { mesh, materials: vec![Some(0)], ..SceneMesh::default() }],
        nodes: vec![Node { mesh: Some(0), ..Node::default() }],
        roots: vec![0],
        materials: vec![material],
        images: vec![image],
        ..Scene::default()
    }
}

/// Materials of a scene by the labels that its faces have when it is one mesh.
fn look(scene: &Scene) -> Look {
    let mut materials = scene.materials.clone();
    materials.push(Material::default());
    let labels = materials.iter().map(|material| material.name.clone()).collect();
    Look { labels, materials, images: scene.images.clone(), ..Look::default() }
}

/// Plan of the tiles of a scene in a folder; levels have errors that grow by 3.
fn planned(scene: Scene, look: &Look, most_faces: usize, folder: &Folder) -> Plan {
    let one = |i: usize| std::array::from_fn(|k| if i == k { 1.0 } else { 0.0 });
    let options = TileOptions {
        most_faces,
        meshopt: false,
        skirts: true,
        placement: [0, 1, 2, 3].map(one),
        is_z_up: false,
    };
    folder.make().unwrap();
    let plan = Plan::new(&SceneSource::new(scene), look, &options, &folder.scratch()).unwrap();
    let depth = i32::from(plan.tree.depth());
    let errors = (0..=depth).map(|at| if at == depth { 0.0 } else { 2e3 * 3f64.powi(depth - at) });
    Plan { errors: errors.collect(), ..plan }
}

/// Makes all tiles, leaves by some threads at once, and returns the content of each.
fn contents(scene: Scene, most_faces: usize, threads: usize) -> (Plan, Vec<(Cell, Vec<u8>)>) {
    let temporary = tempfile::tempdir().unwrap();
    let folder = Folder::new(temporary.path());
    let look = look(&scene);
    let plan = planned(scene, &look, most_faces, &folder);
    let content = |task: usize| {
        let record = run_task((&plan, &look), &folder, task, &Kernel).unwrap();
        (record.cell, fs::read(folder.content(record.cell)).unwrap())
    };
    let tasks = 0..plan.tasks.len();
    let leaves: Vec<usize> = tasks.clone().filter(|&task| plan.parts(task).is_empty()).collect();
    let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| leaves.into_par_iter().with_max_len(1).for_each(|leaf| drop(content(leaf))));
    let contents = tasks.map(content).collect();
    (plan, contents)
}

fn read(glb: &[u8]) -> Scene {
    meshlod_io::gltf::read(glb, &mut |_| None, Weld::Exact).unwrap()
}

/// Image in memory, sampled between its texels.
struct Sampler(Texture);

impl Sampler {
    fn of(image: &Image) -> Self {
        Self(Texture::decode(&image.bytes).unwrap())
    }

    fn at(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        let (width, height, texels) = self.0.levels().next().unwrap();
        let place = |x: f64, length: u32| {
            let at = x.rem_euclid(1.0) * f64::from(length) - 0.5;
            let wrap = |i: f64| i.rem_euclid(f64::from(length)) as usize;
            ([wrap(at.floor()), wrap(at.floor() + 1.0)], at - at.floor())
        };
        let (x, along) = place(u, width);
        let (y, down) = place(1.0 - v, height);
        let blend = |a: f64, b: f64, part: f64| a + part * (b - a);
        let texel = |i: usize, j: usize, k: usize| f64::from(texels[j * width as usize + i][k]);
        [0, 1, 2].map(|k| {
            let row = |j| blend(texel(x[0], j, k), texel(x[1], j, k), along);
            blend(row(y[0]), row(y[1]), down)
        })
    }
}

/// Texture coordinates in the middle of a face.
fn middle_uv(mesh: &Mesh, face: usize) -> [f64; 2] {
    let uvs = mesh.attributes.as_ref().unwrap().layer(LayerKind::Uv(0)).unwrap();
    let corners = mesh.corner_wedges(face).map(|wedge| uvs.of(wedge));
    [0, 1].map(|axis| corners.iter().map(|uv| f64::from(uv[axis])).sum::<f64>() / 3.0)
}

fn difference(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).abs()).fold(0.0, f64::max)
}

/// Checks the colours in the middle of all faces of all tiles, given how large the image is by
/// texture coordinates, and where the seam is.
fn check_colors(scale: f64, left: u32) {
    let seam = f64::from(left) / f64::from(SQUARES);
    let (plan, contents) = contents(textured(grid(scale, left), image()), 200, 2);
    assert!(plan.tree.depth() >= 2);
    for (cell, glb) in &contents {
        let scene = read(glb);
        assert_eq!(scene.images.len(), 1, "{cell}");
        let sampler = Sampler::of(&scene.images[0]);
        let [width, height] = sampler.0.image_size();
        let halvings = (plan.tree.deepest_in(*cell) - cell.depth).min(2);
        assert!(width * height <= (SIDE * SIDE) >> (2 * halvings), "{cell}: {width} x {height}");
        // Texels differ by 8 for each texture coordinate where the resolution is full.
        let bound = 16.0 + 12.0 * f64::from((1u32 << halvings) - 1);
        // Without the skirt.
        let surface = Scene { roots: scene.roots[..1].to_vec(), ..scene }.into_mesh();
        for face in 0..surface.faces.len() {
            // One as thin as the grid of its tile has a texel or two.
            if thickness(&surface, face) < 1e-5 {
                continue;
            }
            let [x, y] = middle(&plan, *cell, &surface, face);
            // A sliver at the seam may be of either chart.
            let is_near = |is_right: &bool| (x > seam) == *is_right || (x - seam).abs() < 1e-4;
            let found = sampler.at(middle_uv(&surface, face));
            let expected = |is_right| color(uv([x, y], is_right).map(|x| scale * x));
            let sides = [false, true].into_iter().filter(is_near);
            let off = sides.map(|side| difference(found, expected(side)));
            let off = off.fold(f64::INFINITY, f64::min);
            assert!(off <= bound, "{cell}, face {face} at {x}, {y}: {off} of {bound}");
        }
    }
}

/// Lesser extent of a face along the axes of the grid.
fn thickness(surface: &Mesh, face: usize) -> f64 {
    let corners = surface.faces[face].map(|v| surface.positions[v.index()]);
    let extent = |axis: usize| {
        let all = corners.map(|at| at[axis]);
        all.into_iter().fold(f64::MIN, f64::max) - all.into_iter().fold(f64::MAX, f64::min)
    };
    extent(0).min(extent(1))
}

/// Place of the middle of a face of a tile on the grid.
fn middle(plan: &Plan, cell: Cell, surface: &Mesh, face: usize) -> [f64; 2] {
    let place = plan.lattice.place(cell.middle().map(f64::from));
    let corners = surface.faces[face].map(|v| surface.positions[v.index()]);
    [0, 1].map(|axis| place[axis] + corners.iter().map(|at| at[axis]).sum::<f64>() / 3.0)
}

#[test]
fn places_of_all_tiles_have_their_colours() {
    check_colors(1.0, SQUARES / 2);
}

#[test]
fn they_have_them_where_the_image_repeats() {
    check_colors(3.0, SQUARES / 2);
}

#[test]
fn they_have_them_where_a_seam_crosses_the_sides_of_tiles() {
    for left in [3, 10, SQUARES / 4, SQUARES - 1] {
        check_colors(1.0, left);
    }
}

#[test]
fn tiles_are_the_same_for_any_number_of_threads() {
    for scale in [1.0, 3.0] {
        let of = |threads| contents(textured(grid(scale, SQUARES / 2), image()), 100, threads).1;
        assert!(of(1) == of(4));
    }
}

#[test]
fn an_image_that_is_damaged_is_left_out() {
    let (_, contents) =
        contents(textured(grid(1.0, SQUARES / 2), Image { bytes: vec![1; 9], ..image() }), 2000, 1);
    for (_, glb) in contents {
        let scene = read(&glb);
        assert!(scene.images.is_empty());
    }
}

/// Bytes of the images that tiles of a real model have, and how far colours in the middle of faces
/// are off on average.
fn real(name: &str, most_faces: usize) {
    let Some(path) = meshlod_fixtures::shared_mesh(name) else {
        return eprintln!("{name} is not there: nothing was tested");
    };
    let scene = meshlod_io::read(&path, &ReadOptions::default()).unwrap();
    let temporary = tempfile::tempdir().unwrap();
    let folder = Folder::new(temporary.path());
    let look = look(&scene);
    let plan = planned(scene, &look, most_faces, &folder);
    let whole: usize = look.images.iter().map(|image| image.bytes.len()).sum();
    let samplers: Vec<Sampler> = look.images.iter().map(Sampler::of).collect();
    let [mut tiles, mut bytes, mut faces] = [0; 3];
    let mut off = 0.0;
    for task in (0..plan.tasks.len()).filter(|&task| plan.parts(task).is_empty()) {
        let leaf = folder.leaf(&plan, task).unwrap();
        let mut mesh = leaf.mesh.clone();
        let tile = repack(&look, &mut mesh, 0);
        tiles += 1;
        bytes += tile.images.iter().map(|image| image.bytes.len()).sum::<usize>();
        let own: Vec<Sampler> = tile.images.iter().map(Sampler::of).collect();
        for face in 0..mesh.faces.len() {
            let label = mesh.materials.as_ref().unwrap().of(face);
            let images =
                [&look.materials, &tile.materials].map(|all| all[label as usize].base_color_image);
            let [Some(before), Some(after)] = images else { continue };
            let expected = samplers[before].at(middle_uv(&leaf.mesh, face));
            off += difference(own[after].at(middle_uv(&mesh, face)), expected);
            faces += 1;
        }
    }
    let mean = off / f64::from(faces as u32);
    eprintln!("{name}: {tiles} leaves, {whole} bytes of images, {bytes} in all leaves, {mean} off");
    assert!(mean < 4.0, "{name}: colours are {mean} off");
    assert!(bytes < whole * tiles / 2, "{name}: {bytes} bytes in {tiles} leaves, {whole} in all");
}

#[test]
fn leaves_of_the_duck_have_their_colours() {
    real("duck.glb", 800);
}

#[test]
fn leaves_of_the_helmet_have_their_colours() {
    real("flight-helmet/FlightHelmet.gltf", 10_000);
}
