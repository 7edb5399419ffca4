//! Textured models of many parts, beside meshoptimizer's simplification with attributes.

use anyhow::Result;
use meshlod::Scene;
use meshlod::jobs::{Aim, SimplifyRequest, simplify};
use meshlod::mesh::Mesh;
use meshlod::picture::{Materials, ReferenceImages, Style};
use meshlod::scene::{materials_of, single_sided_materials};
use serde_json::{Value, json};

use super::Tools;
use super::cache::Cache;
use crate::lab::table::Table;
use crate::lab::textured::PEER;
use crate::peer::{Settings, SimplifyOptions, Update, simplify_with_attributes};

const MODELS: [&str; 8] = [
    "pirate.obj",
    "flight-helmet/FlightHelmet.gltf",
    "city.glb",
    "cesium-milk-truck.glb",
    "dragon-attenuation.glb",
    "cesium-man.glb",
    "fish-bream.obj",
    "duck.glb",
];
const PERCENTS: [usize; 3] = [50, 25, 10];
const UPDATES: [(&str, Update); 2] = [("attributes", Update::Nothing), ("update", Update::All)];
/// Part of its number of faces by which a peer may miss the number wanted and still be compared
/// with our level of that number.
const MISS: f64 = 0.01;

/// Returns a table of image errors by model and ratio, with a count of those that fall short.
pub fn table(_: &Tools) -> Result<String> {
    let mut table = Table::new([
        "model, ratio",
        "faces wanted",
        "ours",
        "at its faces",
        "meshoptimizer with attributes",
        "with update",
        "short of",
    ]);
    let (mut count, mut reached, mut short) = (0, 0, 0);
    for name in MODELS {
        let Some(model) = TexturedModel::read(name)? else { continue };
        let single_sided = single_sided_materials(&model.scene);
        let style = Style::comparison_of(&model.mesh, &model.materials, &single_sided);
        let references = ReferenceImages::with_style(&model.mesh, style)?;
        for percent in PERCENTS {
            eprintln!("  {name}, {percent} % …");
            let wanted = model.mesh.faces.len() * percent / 100;
            let row = LooksRow::measure(&model, &references, wanted)?;
            count += 1;
            reached += usize::from(row.is_reached());
            short += usize::from(row.fault().is_some());
            table.row(row.cells(&format!("{name}, {percent} %")));
        }
    }
    Ok(format!(
        "Of {count} levels, {reached} reach the number of faces, and {short} fall short.\n\n{}",
        table.markdown()
    ))
}

/// A model as it is read, and as one mesh.
struct TexturedModel {
    scene: Scene,
    mesh: Mesh,
    materials: Materials,
}

impl TexturedModel {
    /// Reads a model; `None` if it is not available.
    fn read(name: &str) -> Result<Option<Self>> {
        let Some(scene) = crate::read_scene(name)? else { return Ok(None) };
        let mesh = scene.flatten();
        let (materials, _) = materials_of(&scene);
        Ok(Some(Self { scene, mesh, materials }))
    }

    /// Opens the figures of the peers for this model: they depend on its mesh and its images.
    fn cache(&self) -> Result<Cache> {
        let shape = format!("{PEER:?}{:?}{:?}", self.mesh, self.scene.materials);
        let images = self.scene.images.iter().map(|image| &image.bytes[..]);
        Cache::open(images.chain([shape.as_bytes()]))
    }

    fn simplified(&self, faces: usize) -> Result<Mesh> {
        let request = SimplifyRequest { target: Aim::Faces(faces), ..Default::default() };
        Ok(simplify(self.scene.clone(), &request, &())?.0.flatten())
    }
}

/// Faces of a level, and its FLIP.
type Looks = (usize, f64);

struct LooksRow {
    wanted: usize,
    ours: Looks,
    /// Our level with as many faces as the better of theirs, where these are more than wanted.
    at_theirs: Option<Looks>,
    theirs: [Looks; 2],
}

impl LooksRow {
    fn measure(
        model: &TexturedModel,
        references: &ReferenceImages<'_>,
        wanted: usize,
    ) -> Result<Self> {
        let looks = |level: &Mesh| -> Result<Looks> {
            Ok((level.faces.len(), references.error_of(level)?.flip))
        };
        let mut cache = model.cache()?;
        let mut theirs = [(0, 0.0); 2];
        for (place, (name, update)) in theirs.iter_mut().zip(UPDATES) {
            let name = format!("{name}-{wanted}");
            *place = match cache.get(&name).and_then(from_json) {
                Some(known) => known,
                None => {
                    let options = PEER.options | SimplifyOptions::Prune;
                    let settings = Settings { update, options, ..PEER };
                    let made = looks(&simplify_with_attributes(&model.mesh, wanted, &settings))?;
                    cache.set(name, json!({ "faces": made.0, "flip": made.1 }))?;
                    made
                }
            };
        }
        let ours = looks(&model.simplified(wanted)?)?;
        let (faces, _) = better(theirs);
        let is_more = faces as f64 > wanted as f64 * (1.0 + MISS);
        let at_theirs =
            is_more.then(|| model.simplified(faces).and_then(|level| looks(&level))).transpose()?;
        Ok(Self { wanted, ours, at_theirs, theirs })
    }

    fn is_reached(&self) -> bool {
        self.ours.0 <= self.wanted
    }

    fn fault(&self) -> Option<String> {
        if !self.is_reached() {
            return Some("not reached".to_owned());
        }
        let (ours, theirs) = (self.at_theirs.unwrap_or(self.ours).1, better(self.theirs).1);
        (ours > theirs).then(|| format!("FLIP {:.2} ×", ours / theirs))
    }

    fn cells(&self, what: &str) -> [String; 7] {
        let cell = |(faces, flip): Looks| match faces > self.wanted {
            true => format!("{faces} faces: {flip:.4}"),
            false => format!("{flip:.4}"),
        };
        let [attributes, update] = self.theirs.map(cell);
        [
            what.to_owned(),
            self.wanted.to_string(),
            cell(self.ours),
            self.at_theirs.map(cell).unwrap_or_default(),
            attributes,
            update,
            self.fault().unwrap_or_default(),
        ]
    }
}

fn better([a, b]: [Looks; 2]) -> Looks {
    if a.1 <= b.1 { a } else { b }
}

fn from_json(json: &Value) -> Option<Looks> {
    Some((json["faces"].as_u64()? as usize, json["flip"].as_f64()?))
}
