//! Contents of a scene beside its surface: textures, skins, animations, instances and extensions.

use std::collections::BTreeSet;

use meshlod::Scene;
use meshlod::io::ImageHeader;
use meshlod::io::gltf::{AnimationFacts, FileFacts};
use serde_json::{Value, json};

use crate::numbers::{count, plural, value};

/// Contents of a scene beside its surface.
pub struct Contents {
    textures: Vec<Texture>,
    /// Number of joints of each skin.
    joints: Vec<usize>,
    animations: Vec<AnimationFacts>,
    /// Largest number of morph targets of a mesh.
    targets: usize,
    instances: usize,
    meshes: usize,
    cameras: usize,
    lights: usize,
    /// Extensions and bytes, of glTF only.
    file: Option<FileFacts>,
    /// Bytes of the file; `None` for a pipe.
    file_bytes: Option<u64>,
    /// True for files of our own.
    is_own: bool,
}

/// An image of a scene, without its pixels.
struct Texture {
    name: String,
    header: Option<ImageHeader>,
    /// Number of encoded bytes; 0 if the image was not found.
    bytes: usize,
}

impl Contents {
    /// Collects what a scene has. `file_bytes` is the length of its file, if it is in one, and
    /// `is_own` true if the file is one of our own, which stores geometry in its own way.
    pub fn of(scene: &Scene, file_bytes: Option<u64>, is_own: bool) -> Self {
        let source = scene.source.as_ref();
        let texture = |image: &meshlod::io::Image| Texture {
            name: image.name.clone(),
            header: image.header(),
            bytes: image.bytes.len(),
        };
        Self {
            textures: scene.images.iter().map(texture).collect(),
            joints: source.map(|source| source.joints()).unwrap_or_default(),
            animations: source.map(|source| source.animations()).unwrap_or_default(),
            targets: scene.meshes.iter().map(|mesh| targets(&mesh.mesh)).max().unwrap_or(0),
            instances: scene.instances().len(),
            meshes: scene.meshes.len(),
            cameras: source.map_or(0, |source| source.count("cameras")),
            lights: source.map_or(0, |source| source.lights()),
            file: source.map(|source| source.file_facts().clone()),
            file_bytes,
            is_own,
        }
    }

    /// Adds the contents to the JSON object of a file.
    pub fn add_to(&self, json: &mut Value) {
        let texture = |image: &Texture| {
            let header = image.header;
            let pixels = header.and_then(|header| header.pixels);
            json!({
                "name": image.name,
                "format": header.map(|header| header.format),
                "width": pixels.map(|pixels| pixels[0]),
                "height": pixels.map(|pixels| pixels[1]),
                "bytes": image.bytes,
            })
        };
        let animation = |animation: &AnimationFacts| {
            let AnimationFacts { name, channels, seconds } = animation;
            json!({ "name": name, "channels": channels, "seconds": seconds })
        };
        json["textures"] = self.textures.iter().map(texture).collect();
        json["skins"] = self.joints.iter().map(|joints| json!({ "joints": joints })).collect();
        json["animations"] = self.animations.iter().map(animation).collect();
        json["morph_targets"] = self.targets.into();
        json["instances"] = self.instances.into();
        json["cameras"] = self.cameras.into();
        json["lights"] = self.lights.into();
        let file = self.file.as_ref();
        json["extensions_used"] = json!(file.map_or(&[][..], |file| &file.extensions_used));
        json["extensions_required"] = json!(file.map_or(&[][..], |file| &file.extensions_required));
        json["bytes"] = json!({
            "file": self.file_bytes,
            "geometry": self.geometry_bytes(),
            "images": self.image_bytes(),
            "animation": file.map_or(0, |file| file.animation_bytes),
        });
    }

    /// Formats the contents as lines, one for each kind of which there is something.
    pub fn text(&self) -> String {
        let mut text = String::new();
        let mut line = |name: &str, number: usize, what: String| {
            if number > 0 {
                text += &format!("  {name:<10}  {what}\n");
            }
        };
        let textures: Vec<String> = self.textures.iter().map(texture_text).collect();
        line("textures", textures.len(), textures.join(", "));
        let joints: Vec<String> =
            self.joints.iter().map(|&n| format!("{} joint{}", count(n), plural(n))).collect();
        line("skins", joints.len(), joints.join(", "));
        let animations: Vec<String> = self.animations.iter().map(animation_text).collect();
        line("animations", animations.len(), animations.join(", "));
        line("targets", self.targets, format!("{} morph targets", count(self.targets)));
        let shown = (count(self.instances), count(self.meshes), plural(self.meshes));
        let several = if self.instances == self.meshes { 0 } else { 1 };
        line("instances", several, format!("{} of {} mesh{}", shown.0, shown.1, es(shown.2)));
        line("cameras", self.cameras, count(self.cameras));
        line("lights", self.lights, count(self.lights));
        let extensions = self.file.as_ref().map(extensions).unwrap_or_default();
        line("extensions", extensions.len(), extensions.join(", "));
        let kinds = [
            ("geometry", self.geometry_bytes()),
            ("images", Some(self.image_bytes())),
            ("animation", self.file.as_ref().map(|file| file.animation_bytes)),
        ];
        let kinds = kinds.into_iter().filter_map(|(kind, bytes)| Some((kind, bytes?)));
        let kinds = kinds.filter(|(_, bytes)| *bytes > 0);
        let kinds: Vec<String> =
            kinds.map(|(kind, bytes)| format!("{kind} {}", count(bytes as usize))).collect();
        line("bytes", kinds.len(), kinds.join(", "));
        text
    }

    /// Returns the bytes of geometry: in formats other than glTF, all of the file.
    fn geometry_bytes(&self) -> Option<u64> {
        let of_gltf = self.file.as_ref().map(|file| file.geometry_bytes);
        of_gltf.or(self.file_bytes).filter(|_| !self.is_own)
    }

    fn image_bytes(&self) -> u64 {
        self.textures.iter().map(|image| image.bytes as u64).sum()
    }
}

/// Returns the number of morph targets of a mesh.
fn targets(mesh: &meshlod::Mesh) -> usize {
    let layers = mesh.attributes.iter().flat_map(|attributes| &attributes.layers);
    let numbers = layers.filter_map(|layer| layer.name.strip_prefix("target ")?.split(' ').next());
    numbers.collect::<BTreeSet<_>>().len()
}

fn texture_text(image: &Texture) -> String {
    let bytes = count(image.bytes);
    let name = &image.name;
    match image.header {
        _ if image.bytes == 0 => format!("{name} (not found)"),
        None => format!("{name} (unknown type, {bytes} bytes)"),
        Some(header) => {
            let pixels =
                header.pixels.map_or("size unknown".to_owned(), |[w, h]| format!("{w} x {h}"));
            format!("{name} ({}, {pixels}, {bytes} bytes)", header.format)
        }
    }
}

fn animation_text(animation: &AnimationFacts) -> String {
    let AnimationFacts { name, channels, seconds } = animation;
    let name = if name.is_empty() { "unnamed" } else { name };
    format!("{name} ({} channel{}, {} s)", count(*channels), plural(*channels), value(*seconds))
}

/// Lists the extensions of a file, the required ones marked.
fn extensions(file: &FileFacts) -> Vec<String> {
    let required = |name: &String| file.extensions_required.contains(name);
    let used = file.extensions_used.iter();
    used.map(|name| if required(name) { format!("{name} (required)") } else { name.clone() })
        .collect()
}

/// Makes the plural ending of `mesh` from that of other words.
fn es(plural: &str) -> &'static str {
    if plural.is_empty() { "" } else { "es" }
}
