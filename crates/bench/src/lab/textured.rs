//! Measures image errors of simplified textured meshes, for meshlod and meshoptimizer's
//! simplification with attributes.

use anyhow::{Context, Result};
use meshlod::jobs::{Aim, SimplifyRequest, simplify};
use meshlod::mesh::Mesh;
use meshlod::model::{ModelScene, place_scene};
use meshlod::multires::{Archive, Forest, Query, Storage, StoredErrors};
use meshlod::picture::{ImageError, ReferenceImages, Style};
use meshlod::scene::{materials_of, single_sided_materials};
use meshlod::simplify::{Method, Options, Target};
use meshlod::{Constraints, Scene, Topology};

use crate::lab::table::Table;
use crate::peer::{Settings, SimplifyOptions, Update, simplify_with_attributes};

/// Models with charts or materials.
pub const MODELS: [&str; 5] =
    ["flight-helmet/FlightHelmet.gltf", "duck.glb", "pirate.obj", "spot.obj", "fish-bream.obj"];
/// The most accurate methods, and one that moves no vertex, as meshoptimizer does.
const METHODS: [Method; 3] = [Method::Qem, Method::LindstromTurk, Method::QemEndpoint];
const RATIOS: [f64; 2] = [0.25, 0.1];

/// The best settings of meshoptimizer over the five models; see docs/notes/image-error.md.
pub const PEER: Settings = Settings {
    normal_weight: 0.1,
    uv_weight: 2.0,
    options: SimplifyOptions::Permissive,
    update: Update::Nothing,
};

/// Returns a table of the image errors FLIP and SSIM by model, ratio and method.
pub fn section() -> Result<String> {
    Ok(format!(
        "Mean FLIP (0 is best) and SSIM (1 is best) over twelve views of 1024 by 1024, over the pixels \
         covered by the original or the level, with the model's textures, or a checkerboard in uv \
         space if it has none. Our levels have the face count of meshoptimizer's simplify with \
         attributes. To reproduce a model: `cargo xtask textured MODEL`.\n\n{}",
        table(&MODELS)?
    ))
}

/// Prints only the table, for the models whose name contains one of `names`, or for all models if
/// `names` is empty.
///
/// # Errors
/// No model matches.
pub fn print(names: &[String]) -> Result<()> {
    let named = |model: &&str| names.iter().any(|name| model.contains(name.as_str()));
    let models: Vec<&str> = MODELS.into_iter().filter(|m| names.is_empty() || named(m)).collect();
    anyhow::ensure!(
        !models.is_empty(),
        "no model has such a name; the models are {}",
        MODELS.join(", ")
    );
    print!("{}", table(&models)?);
    Ok(())
}

fn table(models: &[&str]) -> Result<String> {
    let mut table = Table::new(["model, ratio, method", "faces", "FLIP", "SSIM"]);
    for model in models {
        let Some(scene) = crate::read_scene(model)? else { continue };
        let (materials, _) = materials_of(&scene);
        let mesh = scene.flatten();
        let single_sided = single_sided_materials(&scene);
        let style = Style::comparison_of(&mesh, &materials, &single_sided);
        let portrait = ReferenceImages::with_style(&mesh, style)?;
        for ratio in RATIOS {
            for (method, level) in levels(&scene, &mesh, ratio)? {
                let ImageError { flip, ssim, .. } =
                    portrait.error_of(&level).with_context(|| model.to_string())?;
                let what = format!("{model}, {:.0} %, {method}", ratio * 100.0);
                let faces = level.faces.len().to_string();
                table.row([what, faces, format!("{flip:.4}"), format!("{ssim:.4}")]);
            }
        }
    }
    Ok(table.markdown())
}

/// Makes the levels of all methods and of meshoptimizer, with their names.
fn levels(scene: &Scene, mesh: &Mesh, ratio: f64) -> Result<Vec<(&'static str, Mesh)>> {
    let faces = Target::Ratio(ratio).faces_of(mesh.faces.len());
    let peer = simplify_with_attributes(mesh, faces, &PEER);
    let updated = Settings { update: Update::All, ..PEER };
    let mut levels = Vec::new();
    for method in METHODS {
        let target = Aim::Faces(peer.faces.len());
        let request = SimplifyRequest { target, method, ..Default::default() };
        let (level, _) = simplify(scene.clone(), &request, &())?;
        levels.push((method.name(), level.flatten()));
    }
    levels.push(("cut of a multiresolution file", cut(scene, peer.faces.len())?));
    levels.push(("meshoptimizer with attributes", peer));
    levels.push(("meshoptimizer with update", simplify_with_attributes(mesh, faces, &updated)));
    Ok(levels)
}

/// Returns the cut of at most `faces` faces of a multiresolution file of a scene, as `build` and
/// `extract` make it.
fn cut(scene: &Scene, faces: usize) -> Result<Mesh> {
    let constraints = Constraints { topology: Topology::Keep, ..Constraints::default() };
    let placed = place_scene(scene.clone(), &constraints, Options::default())?;
    let mut forest = Forest::new(&placed.mesh, &placed.options)?;
    forest.smooth_errors();
    let storage = Storage { errors: StoredErrors::Measured, ..Storage::default() };
    let mut archive = Archive::write(&forest, &storage)?.0;
    if let Some(rest) = &placed.rest {
        let resources = rest.resources(&archive.chunk_lengths());
        archive = archive.with_resources(&resources)?;
    }
    let everywhere = Query::uniform(placed.mesh.bounds().diagonal());
    let level = archive.extract_at_most(faces, &everywhere)?.level.mesh();
    match placed.rest {
        Some(_) => Ok(ModelScene::read(&archive)?.into_scene("", level)?.flatten()),
        None => Ok(level),
    }
}
