//! Cost of the rounding of a multiresolution file in image error, and of finer rounding in bytes.
//!
//! ```text
//! cargo run --release -p meshlod --example rounding -- flight-helmet/FlightHelmet.gltf fish-bream.obj
//! ```
//! Takes names of shared models. The topology is kept, so that cuts and levels have the same components.
//! Bytes are those of the surface, without images. FLIP of levels of 25 and 10 % of the faces, over
//! twelve views of 1024 pixels with the model's textures, is that of `simplify` in the first row, then
//! that of cuts; positions are rounded in % of the diagonal, normals in radians.

use std::error::Error;

use meshlod::jobs::{Aim, SimplifyRequest, simplify};
use meshlod::mesh::{AttributeBounds, Mesh};
use meshlod::model::{ModelScene, place_scene};
use meshlod::multires::{Archive, Forest, Query, Storage, StoredErrors};
use meshlod::picture::{ReferenceImages, Style};
use meshlod::scene::{materials_of, single_sided_materials};
use meshlod::simplify::Target;
use meshlod::{Constraints, Options, ReadOptions, Topology, read};
use meshlod_fixtures::shared_mesh;

const PARTS: [f64; 2] = [0.25, 0.1];

/// Rounding of positions in % of the diagonal, of texture coordinates and of normals.
const STEPS: [[f64; 3]; 8] = [
    [0.005, 1.0 / 8192.0, 0.006],
    [0.00125, 1.0 / 8192.0, 0.006],
    [0.005, 1.0 / 8192.0, 0.0015],
    [0.0025, 1.0 / 16_384.0, 0.006],
    [0.005, 1.0 / 32_768.0, 0.006],
    [0.005, 1.0 / 32_768.0, 0.003],
    [0.00125, 1.0 / 32_768.0, 0.0015],
    [0.0001, 1e-6, 1e-4],
];

fn main() -> Result<(), Box<dyn Error>> {
    println!("| model | positions, % | uvs | normals | bytes | FLIP |");
    println!("|---|--:|--:|--:|--:|--:|");
    std::env::args().skip(1).try_for_each(|name| measure(&name))
}

fn measure(name: &str) -> Result<(), Box<dyn Error>> {
    let path = shared_mesh(name).ok_or("there is no such model")?;
    let scene = read(&path, &ReadOptions::default())?;
    let (materials, _) = materials_of(&scene);
    let single_sided = single_sided_materials(&scene);
    let mesh = scene.flatten();
    let style = Style::comparison_of(&mesh, &materials, &single_sided);
    let portrait = ReferenceImages::with_style(&mesh, style)?;
    let counts = PARTS.map(|part| Target::Ratio(part).faces_of(mesh.faces.len()));
    let flips = |levels: [Mesh; 2]| -> Result<String, Box<dyn Error>> {
        let [fine, coarse] = [portrait.error_of(&levels[0])?, portrait.error_of(&levels[1])?];
        Ok(format!("{:.4} {:.4}", fine.flip, coarse.flip))
    };

    let level = |faces: usize| -> Result<Mesh, Box<dyn Error>> {
        let constraints = Constraints { topology: Topology::Keep, ..Constraints::default() };
        let target = Aim::Faces(faces);
        let request = SimplifyRequest { target, constraints, ..SimplifyRequest::default() };
        Ok(simplify(scene.clone(), &request, &())?.0.flatten())
    };
    println!("| {name} | | | | | {} |", flips([level(counts[0])?, level(counts[1])?])?);

    let constraints = Constraints { topology: Topology::Keep, ..Constraints::default() };
    let placed = place_scene(scene.clone(), &constraints, Options::default())?;
    let mut forest = Forest::new(&placed.mesh, &placed.options)?;
    forest.smooth_errors();
    let diagonal = placed.mesh.bounds().diagonal();
    for [positions, uv, direction_rad] in STEPS {
        let storage = Storage {
            rounding: Some(positions * 0.01 * diagonal),
            errors: StoredErrors::Measured,
            attributes: AttributeBounds { uv, direction_rad, ..AttributeBounds::default() },
            ..Storage::default()
        };
        let bytes = Archive::write(&forest, &storage)?.0.into_source();
        let size = bytes.len();
        let mut archive = Archive::open(bytes)?;
        if let Some(rest) = &placed.rest {
            let resources = rest.resources(&archive.chunk_lengths());
            archive = archive.with_resources(&resources)?;
        }
        let cut = |faces: usize| -> Result<Mesh, Box<dyn Error>> {
            let level = archive.extract_at_most(faces, &Query::uniform(diagonal))?.level.mesh();
            Ok(match placed.rest {
                Some(_) => ModelScene::read(&archive)?.into_scene("", level)?.flatten(),
                None => level,
            })
        };
        let flips = flips([cut(counts[0])?, cut(counts[1])?])?;
        println!("| | {positions} | {uv:.1e} | {direction_rad} | {size} | {flips} |");
    }
    Ok(())
}
