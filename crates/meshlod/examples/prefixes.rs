//! Pictures of truncated multiresolution files, compared with the model they were built from.
//!
//! ```text
//! cargo run --release -p meshlod --example prefixes -- flight-helmet/FlightHelmet.gltf 2 5 20
//! ```
//! Takes the name of a shared model, and prefixes in percent of the file, which is built as `build`
//! does. Prints faces, previews and missing images, and FLIP over twelve views of 1024 pixels with
//! the textures that the prefix has.

use std::error::Error;

use meshlod::model::{ModelScene, place_scene};
use meshlod::multires::{Archive, Forest, Query, Storage, StoredErrors};
use meshlod::picture::{Paint, ReferenceImages, Style};
use meshlod::scene::{materials_of, single_sided_materials};
use meshlod::{Constraints, Options, ReadOptions, read};
use meshlod_fixtures::shared_mesh;

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let name = args.next().ok_or("give the name of a model")?;
    let path = shared_mesh(&name).ok_or("there is no such model")?;
    let scene = read(&path, &ReadOptions::default())?;
    let (materials, _) = materials_of(&scene);
    let single_sided = single_sided_materials(&scene);
    let mesh = scene.flatten();
    let style = Style::comparison_of(&mesh, &materials, &single_sided);
    let portrait = ReferenceImages::with_style(&mesh, style)?;

    let placed = place_scene(scene, &Constraints::default(), Options::default())?;
    let options = Forest::options(&placed.mesh, &placed.options);
    let mut forest = Forest::new(&placed.mesh, &options)?;
    forest.smooth_errors();
    let storage = Storage { errors: StoredErrors::Measured, ..Storage::default() };
    let archive = Archive::write(&forest, &storage)?.0;
    let rest = placed.rest.ok_or("the model is only a mesh")?;
    let resources = rest.resources(&archive.chunk_lengths());
    let bytes = archive.with_resources(&resources)?.into_source();

    println!("percent bytes faces previews missing FLIP");
    for percent in args {
        let part: f64 = percent.parse()?;
        let end = (bytes.len() as f64 * part / 100.0).round() as usize;
        let archive = Archive::open(bytes[..end.min(bytes.len())].to_vec())?;
        let level = archive.extract(&Query::uniform(0.0))?.level.mesh();
        let (model, faces) = (ModelScene::read(&archive)?, level.faces.len());
        let missing = model.missing;
        let scene = model.into_scene("prefix", level)?;
        let (materials, _) = materials_of(&scene);
        let mesh = scene.flatten();
        let flip = portrait.error_with(&mesh, &Paint::Materials(&materials))?.flip;
        println!("{percent} {end} {faces} {} {} {flip:.4}", missing.previews, missing.images);
    }
    Ok(())
}
