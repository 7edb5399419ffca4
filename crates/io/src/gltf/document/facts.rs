//! Facts about a glTF file beyond its scene: extensions, bytes by use, animations.

use serde::Serialize;
use serde_json::Value;

use super::entries::entries;

/// Extensions of a glTF file, and its bytes by use before decompression.
///
/// Each buffer view counts once: as an image, else as animation if key frames use it, else as
/// geometry. Images in separate files are not counted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FileFacts {
    /// Names of the used extensions.
    pub extensions_used: Vec<String>,
    /// Names of the required extensions.
    pub extensions_required: Vec<String>,
    /// Bytes of meshes, skins and instances.
    pub geometry_bytes: u64,
    /// Bytes of the key frames of animations.
    pub animation_bytes: u64,
    /// Bytes of embedded images.
    pub image_bytes: u64,
}

/// Size of an animation.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct AnimationFacts {
    /// Name of the animation; empty if it has none.
    pub name: String,
    /// Number of channels; each animates one property of one node.
    pub channels: usize,
    /// Time of the last key frame in seconds, as declared in the file; 0 if it is not.
    pub seconds: f64,
}

impl FileFacts {
    /// Collects the facts of a document before decompression. Damaged parts count as absent.
    pub(crate) fn of(json: &Value) -> Self {
        let names = |key: &str| {
            entries(json, key).filter_map(|name| name.as_str().map(str::to_owned)).collect()
        };
        let mut facts = Self {
            extensions_used: names("extensionsUsed"),
            extensions_required: names("extensionsRequired"),
            ..Self::default()
        };
        let [animation, image] = [animated_views(json), image_views(json)];
        for (index, view) in entries(json, "bufferViews").enumerate() {
            let compressed = view["extensions"].as_object().into_iter().flatten();
            let stored = compressed.filter_map(|(_, extension)| extension["byteLength"].as_u64());
            let bytes = stored.min().or(view["byteLength"].as_u64()).unwrap_or(0);
            let sum = if image.binary_search(&index).is_ok() {
                &mut facts.image_bytes
            } else if animation.binary_search(&index).is_ok() {
                &mut facts.animation_bytes
            } else {
                &mut facts.geometry_bytes
            };
            *sum = sum.saturating_add(bytes);
        }
        facts
    }
}

/// Lists the animations of a document with their numbers of channels and durations.
pub(crate) fn animations(json: &Value) -> Vec<AnimationFacts> {
    let end = |sampler: &Value| {
        let input = sampler["input"].as_u64()? as usize;
        json["accessors"][input]["max"][0].as_f64()
    };
    let facts = |animation: &Value| AnimationFacts {
        name: animation["name"].as_str().unwrap_or_default().to_owned(),
        channels: entries(animation, "channels").count(),
        seconds: entries(animation, "samplers").filter_map(end).fold(0.0, f64::max),
    };
    entries(json, "animations").map(facts).collect()
}

/// Returns the number of joints of each skin.
pub(crate) fn joints(json: &Value) -> Vec<usize> {
    entries(json, "skins").map(|skin| entries(skin, "joints").count()).collect()
}

/// Returns the number of nodes with a light.
pub(crate) fn lights(json: &Value) -> usize {
    let has_light = |node: &&Value| node.pointer("/extensions/KHR_lights_punctual/light").is_some();
    entries(json, "nodes").filter(has_light).count()
}

/// Lists the buffer views of key frames.
fn animated_views(json: &Value) -> Vec<usize> {
    let samplers = entries(json, "animations").flat_map(|all| entries(all, "samplers"));
    let accessors = samplers.flat_map(|sampler| [&sampler["input"], &sampler["output"]]);
    let mut views: Vec<usize> = accessors
        .filter_map(|accessor| {
            json["accessors"][accessor.as_u64()? as usize]["bufferView"].as_u64()
        })
        .map(|view| view as usize)
        .collect();
    views.sort_unstable();
    views.dedup();
    views
}

fn image_views(json: &Value) -> Vec<usize> {
    let views = entries(json, "images").filter_map(|image| image["bufferView"].as_u64());
    let mut views: Vec<usize> = views.map(|view| view as usize).collect();
    views.sort_unstable();
    views
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn bytes_are_counted_by_use() {
        let json = json!({
            "extensionsUsed": ["A", "B"],
            "extensionsRequired": ["B"],
            "bufferViews": [
                { "byteLength": 100, "extensions": { "B": { "byteLength": 10 } } },
                { "byteLength": 20 },
                { "byteLength": 7 },
            ],
            "accessors": [{ "bufferView": 0 }, { "bufferView": 1, "max": [2.5] }],
            "images": [{ "bufferView": 2 }, { "uri": "a.png" }],
            "animations": [{
                "name": "run",
                "channels": [{}, {}],
                "samplers": [{ "input": 1, "output": 1 }, { "input": 9 }],
            }],
        });
        let facts = FileFacts::of(&json);
        assert_eq!(facts.extensions_used, ["A", "B"]);
        assert_eq!(facts.extensions_required, ["B"]);
        let bytes = [facts.geometry_bytes, facts.animation_bytes, facts.image_bytes];
        assert_eq!(bytes, [10, 20, 7]);
        let run = AnimationFacts { name: "run".into(), channels: 2, seconds: 2.5 };
        assert_eq!(animations(&json), [run]);
    }

    #[test]
    fn a_damaged_document_has_fewer_facts() {
        for json in [json!({}), json!([]), json!({ "bufferViews": 3, "animations": [7] })] {
            let facts = FileFacts::of(&json);
            assert_eq!(facts, FileFacts::default());
            assert!(animations(&json).iter().all(|animation| animation.channels == 0));
        }
    }
}
