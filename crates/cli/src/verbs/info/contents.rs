//! Contents of a scene beside its surface: textures, skins, animations, instances and extensions.

use std::collections::BTreeSet;

use meshlod::Scene;
use meshlod::io::Image;
use meshlod::io::gltf::AnimationFacts;
use serde::Serialize;

use crate::text::numbers::{count, plural, value};

/// Contents of a scene beside its surface, under the keys of JSON.
#[derive(Serialize)]
pub struct Contents {
    textures: Vec<Texture>,
    skins: Vec<Skin>,
    animations: Vec<AnimationFacts>,
    /// Largest number of morph targets of a mesh.
    morph_targets: usize,
    instances: usize,
    cameras: usize,
    lights: usize,
    /// Extensions of glTF; none in other formats.
    extensions_used: Vec<String>,
    extensions_required: Vec<String>,
    bytes: Bytes,
    #[serde(skip)]
    meshes: usize,
}

/// An image of a scene, without its pixels.
#[derive(Serialize)]
struct Texture {
    name: String,
    format: Option<&'static str>,
    width: Option<u32>,
    height: Option<u32>,
    /// Number of encoded bytes; 0 if the image was not found.
    bytes: usize,
}

#[derive(Serialize)]
struct Skin {
    joints: usize,
}

/// Bytes of a file by kind.
#[derive(Serialize)]
struct Bytes {
    /// `None` for a pipe.
    file: Option<u64>,
    /// In formats other than glTF, all of the file; `None` for files of our own, which store
    /// geometry in their own way.
    geometry: Option<u64>,
    images: u64,
    animation: u64,
}

impl Contents {
    /// Collects what a scene has. `file_bytes` is the length of its file, if it is in one, and
    /// `is_own` true if the file is one of our own.
    pub fn of(scene: &Scene, file_bytes: Option<u64>, is_own: bool) -> Self {
        let source = scene.source.as_ref();
        let facts = source.map(|source| source.file_facts().clone());
        let geometry = facts.as_ref().map(|facts| facts.geometry_bytes).or(file_bytes);
        let bytes = Bytes {
            file: file_bytes,
            geometry: geometry.filter(|_| !is_own),
            images: scene.images.iter().map(|image| image.bytes.len() as u64).sum(),
            animation: facts.as_ref().map_or(0, |facts| facts.animation_bytes),
        };
        let joints = source.map(|source| source.joints()).unwrap_or_default();
        let facts = facts.unwrap_or_default();
        Self {
            textures: scene.images.iter().map(Texture::of).collect(),
            skins: joints.into_iter().map(|joints| Skin { joints }).collect(),
            animations: source.map(|source| source.animations()).unwrap_or_default(),
            morph_targets: scene.meshes.iter().map(|mesh| targets(&mesh.mesh)).max().unwrap_or(0),
            instances: scene.instances().len(),
            cameras: source.map_or(0, |source| source.count("cameras")),
            lights: source.map_or(0, |source| source.lights()),
            extensions_used: facts.extensions_used,
            extensions_required: facts.extensions_required,
            bytes,
            meshes: scene.meshes.len(),
        }
    }

    /// Formats the contents as lines, one for each kind of which there is something.
    pub fn text(&self) -> String {
        let mut text = String::new();
        let mut line = |name: &str, number: usize, what: String| {
            if number > 0 {
                text += &format!("  {name:<10}  {what}\n");
            }
        };
        let textures: Vec<String> = self.textures.iter().map(Texture::text).collect();
        line("textures", textures.len(), textures.join(", "));
        let joints = |&Skin { joints }: &Skin| format!("{} joint{}", count(joints), plural(joints));
        let joints: Vec<String> = self.skins.iter().map(joints).collect();
        line("skins", joints.len(), joints.join(", "));
        let animations: Vec<String> = self.animations.iter().map(animation_text).collect();
        line("animations", animations.len(), animations.join(", "));
        let targets = format!("{} morph targets", count(self.morph_targets));
        line("targets", self.morph_targets, targets);
        let shown = (count(self.instances), count(self.meshes), plural(self.meshes));
        let several = if self.instances == self.meshes { 0 } else { 1 };
        line("instances", several, format!("{} of {} mesh{}", shown.0, shown.1, es(shown.2)));
        line("cameras", self.cameras, count(self.cameras));
        line("lights", self.lights, count(self.lights));
        let extensions = self.extensions();
        line("extensions", extensions.len(), extensions.join(", "));
        let kinds = [
            ("geometry", self.bytes.geometry.unwrap_or(0)),
            ("images", self.bytes.images),
            ("animation", self.bytes.animation),
        ];
        let kinds = kinds.into_iter().filter(|(_, bytes)| *bytes > 0);
        let kinds: Vec<String> =
            kinds.map(|(kind, bytes)| format!("{kind} {}", count(bytes as usize))).collect();
        line("bytes", kinds.len(), kinds.join(", "));
        text
    }

    /// Lists the extensions of the file, the required ones marked.
    fn extensions(&self) -> Vec<String> {
        let marked = |name: &String| match self.extensions_required.contains(name) {
            true => format!("{name} (required)"),
            false => name.clone(),
        };
        self.extensions_used.iter().map(marked).collect()
    }
}

impl Texture {
    fn of(image: &Image) -> Self {
        let header = image.header();
        let pixels = header.and_then(|header| header.pixels);
        Self {
            name: image.name.clone(),
            format: header.map(|header| header.format),
            width: pixels.map(|[width, _]| width),
            height: pixels.map(|[_, height]| height),
            bytes: image.bytes.len(),
        }
    }

    fn text(&self) -> String {
        let (name, bytes) = (&self.name, count(self.bytes));
        match (self.format, self.width.zip(self.height)) {
            _ if self.bytes == 0 => format!("{name} (not found)"),
            (None, _) => format!("{name} (unknown type, {bytes} bytes)"),
            (Some(format), None) => format!("{name} ({format}, size unknown, {bytes} bytes)"),
            (Some(format), Some((w, h))) => format!("{name} ({format}, {w} x {h}, {bytes} bytes)"),
        }
    }
}

/// Returns the number of morph targets of a mesh.
fn targets(mesh: &meshlod::Mesh) -> usize {
    let layers = mesh.attributes.iter().flat_map(|attributes| &attributes.layers);
    let numbers = layers.filter_map(|layer| layer.name.strip_prefix("target ")?.split(' ').next());
    numbers.collect::<BTreeSet<_>>().len()
}

fn animation_text(animation: &AnimationFacts) -> String {
    let AnimationFacts { name, channels, seconds } = animation;
    let name = if name.is_empty() { "unnamed" } else { name };
    format!("{name} ({} channel{}, {} s)", count(*channels), plural(*channels), value(*seconds))
}

/// Makes the plural ending of `mesh` from that of other words.
fn es(plural: &str) -> &'static str {
    if plural.is_empty() { "" } else { "es" }
}
