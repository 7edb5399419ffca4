//! Contents of 3D tiles: a batched model (b3dm) around a GLB, and centres far from the origin.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Value, json};

use super::mended::{index, parents, shown_scene};
use crate::error::ParseError;
use crate::gltf::document::entries::{entries, extend};
use crate::gltf::document::extensions::{drop_entry, forget_names};
use crate::notes::Note;

/// Extension for a centre far from the origin.
pub(crate) const RTC: &str = "CESIUM_RTC";

/// Bytes before the tables of a batched model: its name, its version, its length, and the lengths of
/// a feature table and a batch table, each in JSON and binary.
const HEADER: usize = 28;

/// A GLB, with what a batched model has around it.
#[derive(Debug, PartialEq)]
pub(crate) struct Tile<'b> {
    pub(super) gltf: &'b [u8],
    /// Position of its origin, with z up.
    center: Option<[f64; 3]>,
    has_batches: bool,
}

/// Takes the GLB out of a batched model; any other file stays whole.
///
/// # Errors
/// A header or a centre that makes no sense, and other kinds of tiles.
pub(super) fn unwrap(bytes: &[u8]) -> Result<Tile<'_>, ParseError> {
    let other = |kind: &str| {
        let reason = format!("a 3D tile of kind {kind}, which is not supported; b3dm and GLB are");
        Err(ParseError::byte(0, reason))
    };
    match bytes.get(..4) {
        Some(b"b3dm") => batched(bytes),
        Some(b"i3dm") => other("i3dm (instances)"),
        Some(b"pnts") => other("pnts (points)"),
        Some(b"cmpt") => other("cmpt (several tiles)"),
        _ => Ok(Tile::plain(bytes)),
    }
}

fn batched(bytes: &[u8]) -> Result<Tile<'_>, ParseError> {
    let word = |at: usize| {
        let word = bytes.get(at..at + 4)?.try_into().ok()?;
        Some(u32::from_le_bytes(word) as usize)
    };
    let ends = || ParseError::byte(bytes.len(), "the file ends inside a b3dm header");
    let lengths: Option<Vec<usize>> = (0..4).map(|i| word(12 + 4 * i)).collect();
    let lengths = lengths.ok_or_else(ends)?;
    let start = lengths.iter().try_fold(HEADER, |sum, &length| sum.checked_add(length));
    let gltf = start.and_then(|start| bytes.get(start..)).ok_or_else(ends)?;
    if !gltf.starts_with(b"glTF") {
        let reason = "no GLB follows the tables of the b3dm";
        return Err(ParseError::byte(bytes.len() - gltf.len(), reason));
    }
    let (features, rest) = bytes[HEADER..].split_at(lengths[0]);
    let features: Value = match features.trim_ascii() {
        [] => Value::Null,
        text => serde_json::from_slice(text)
            .map_err(|error| ParseError::part("feature table", error.to_string()))?,
    };
    let center = features.get("RTC_CENTER").map(|center| {
        let binary = center.get("byteOffset").map(|at| binary(&rest[..lengths[1]], at));
        let found = binary.unwrap_or_else(|| numbers(center));
        found.ok_or_else(|| ParseError::part("RTC_CENTER", THREE))
    });
    Ok(Tile { gltf, center: center.transpose()?, has_batches: lengths[2] > 0 })
}

/// Reason why a centre is refused.
const THREE: &str = "must be three finite numbers";

impl<'b> Tile<'b> {
    /// Takes a file that is no tile.
    pub(crate) fn plain(gltf: &'b [u8]) -> Self {
        Self { gltf, center: None, has_batches: false }
    }

    /// Moves the nodes of its document to their centre, and notes what is left out.
    ///
    /// # Errors
    /// A centre that is not three numbers, or nodes that cannot be moved.
    pub(super) fn apply_to(&self, json: &mut Value) -> Result<Option<Note>, ParseError> {
        let own = json.pointer("/extensions/CESIUM_RTC").map(|rtc| {
            let found = rtc.get("center").and_then(numbers);
            found.ok_or_else(|| ParseError::part("CESIUM_RTC", THREE))
        });
        for center in [self.center, own.transpose()?].into_iter().flatten() {
            move_to(json, center)?;
        }
        drop_entry(json, RTC);
        forget_names(json, &[RTC]);
        let note = Note::left_out(1, "batch table of a 3D tile", "batch tables of 3D tiles");
        Ok(self.has_batches.then_some(note))
    }
}

/// Puts the roots of every scene under nodes at a center, given with z up.
fn move_to(json: &mut Value, [x, y, z]: [f64; 3]) -> Result<(), ParseError> {
    let parents = parents(json);
    if json.get("scenes").is_none_or(|scenes| *scenes == json!([])) {
        // Then all nodes are shown.
        let roots: Vec<usize> = (0..parents.len()).filter(|&i| parents[i].is_none()).collect();
        json["scenes"] = json!([{ "nodes": roots }]);
    }
    let shown = shown_scene(json);
    let scenes = json.get_mut("scenes").and_then(Value::as_array_mut);
    let Some(scenes) = scenes.filter(|scenes| scenes.get(shown).is_some_and(Value::is_object))
    else {
        return Err(ParseError::part("scenes", "there is no scene to move"));
    };
    let groups = groups_of_roots(scenes, &parents)?;
    let mut above = vec![None; parents.len()];
    for (group, roots) in groups.iter().enumerate() {
        roots.iter().for_each(|&root| above[root] = Some(parents.len() + group));
    }
    scenes.iter_mut().for_each(|scene| list_instead(scene, &above));
    if !groups.is_empty() {
        let node = |roots| json!({ "translation": [x, z, -y], "children": roots });
        extend(json, "nodes", groups.into_iter().map(node).collect());
    }
    Ok(())
}

/// Groups the roots by the scenes that list them, so that none gets two parents. A node that is the
/// child of another is left out, as it moves with that one.
fn groups_of_roots(
    scenes: &[Value],
    parents: &[Option<usize>],
) -> Result<Vec<Vec<usize>>, ParseError> {
    let mut scenes_of = vec![Vec::new(); parents.len()];
    let mut order = Vec::new();
    for (at, scene) in scenes.iter().enumerate() {
        for root in entries(scene, "nodes").filter_map(index) {
            let Some(parent) = parents.get(root) else {
                let reason = format!("list node {root}, but there are only {}", parents.len());
                return Err(ParseError::part("scenes", reason));
            };
            if parent.is_some() || scenes_of[root].last() == Some(&at) {
                continue;
            }
            if scenes_of[root].is_empty() {
                order.push(root);
            }
            scenes_of[root].push(at);
        }
    }
    let mut groups: BTreeMap<_, Vec<usize>> = BTreeMap::new();
    for root in order {
        groups.entry(std::mem::take(&mut scenes_of[root])).or_default().push(root);
    }
    Ok(groups.into_values().collect())
}

/// Makes a scene list the node above each of its roots, once, instead of the root.
fn list_instead(scene: &mut Value, above: &[Option<usize>]) {
    let Some(listed) = scene.get_mut("nodes").and_then(Value::as_array_mut) else { return };
    let mut added = BTreeSet::new();
    listed.retain_mut(|root| {
        let Some(node) = index(root).and_then(|root| above[root]) else { return true };
        *root = node.into();
        added.insert(node)
    });
}

fn numbers(value: &Value) -> Option<[f64; 3]> {
    let numbers: Option<Vec<f64>> = value.as_array()?.iter().map(Value::as_f64).collect();
    numbers?.try_into().ok().filter(|all: &[f64; 3]| all.iter().all(|x| x.is_finite()))
}

/// Reads three floats at an offset into the binary part of a feature table.
fn binary(table: &[u8], offset: &Value) -> Option<[f64; 3]> {
    let at = usize::try_from(offset.as_u64()?).ok()?;
    let bytes = table.get(at..at.checked_add(12)?)?;
    let float = |k: usize| bytes[4 * k..].first_chunk().map(|chunk| f32::from_le_bytes(*chunk));
    let floats = [float(0)?, float(1)?, float(2)?].map(f64::from);
    floats.iter().all(|x| x.is_finite()).then_some(floats)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tile(features: &str, batches: &str, gltf: &[u8]) -> Vec<u8> {
        let mut bytes = b"b3dm\x01\0\0\0".to_vec();
        let lengths = [0, features.len(), 0, batches.len(), 0];
        bytes.extend(lengths.iter().flat_map(|&length| (length as u32).to_le_bytes()));
        [&bytes, features.as_bytes(), batches.as_bytes(), gltf].concat()
    }

    #[test]
    fn a_tile_is_moved_to_its_center() {
        let bytes = tile(r#"{"RTC_CENTER": [1.5, 2, 3]}  "#, "{}", b"glTF rest");
        let found = unwrap(&bytes).unwrap();
        assert_eq!(found.gltf, b"glTF rest");
        let mut json = json!({
            "extensionsRequired": [RTC], "extensions": {RTC: {"center": [10, 20, 30]}},
            "scenes": [{"nodes": [0]}], "nodes": [{}],
        });
        assert!(found.apply_to(&mut json).unwrap().is_some());
        let expected = json!({
            "scenes": [{"nodes": [2]}],
            "nodes": [
                {},
                {"translation": [1.5, 3.0, -2.0], "children": [0]},
                {"translation": [10.0, 30.0, -20.0], "children": [1]},
            ],
        });
        assert_eq!(json, expected);
    }

    #[test]
    fn a_center_may_be_binary_and_scenes_be_missing() {
        let mut bytes = tile(r#"{"RTC_CENTER": {"byteOffset": 4}}"#, "", b"");
        let floats: Vec<u8> = [9f32, 1.0, 2.0, 3.0].iter().flat_map(|x| x.to_le_bytes()).collect();
        bytes[16..20].copy_from_slice(&16u32.to_le_bytes());
        let bytes = [&bytes[..], &floats, b"glTF"].concat();
        let found = unwrap(&bytes).unwrap();
        assert_eq!(found.center, Some([1.0, 2.0, 3.0]));
        let mut json = json!({ "scenes": [], "nodes": [{"children": [1]}, {}] });
        found.apply_to(&mut json).unwrap();
        assert_eq!(json["scenes"], json!([{"nodes": [2]}]));
        assert_eq!(json["nodes"][2]["children"], json!([0]));
    }

    #[test]
    fn every_scene_is_moved_and_shared_roots_once() {
        let mut json = json!({
            "extensions": {RTC: {"center": [1, 2, 3]}},
            "scene": 1,
            "scenes": [{"nodes": [3, 0]}, {"nodes": [0, 1, 2]}, {"nodes": [4]}, {}],
            "nodes": [{}, {"children": [4]}, {}, {}, {}],
        });
        unwrap(b"{}").unwrap().apply_to(&mut json).unwrap();
        let scenes = json!([{"nodes": [5, 6]}, {"nodes": [6, 7]}, {"nodes": [4]}, {}]);
        assert_eq!(json["scenes"], scenes, "node 4 moves with its parent");
        let moved = |roots: [usize; 1]| json!({"translation": [1.0, 3.0, -2.0], "children": roots});
        assert_eq!(json["nodes"][5], moved([3]));
        assert_eq!(json["nodes"][6], moved([0]));
        assert_eq!(json["nodes"][7]["children"], json!([1, 2]));
    }

    #[test]
    fn what_cannot_be_moved_is_an_error() {
        let rtc = |center: Value| json!({ RTC: { "center": center } });
        let plain = unwrap(b"{}").unwrap();
        for mut json in [
            json!({ "extensions": rtc(json!([10, 20])), "scenes": [{"nodes": [0]}], "nodes": [{}] }),
            json!({ "extensions": rtc(json!([1, "a", 2, 3])), "nodes": [{}] }),
            json!({ "extensions": rtc(json!([1, 2, 3])), "scenes": {"0": {"nodes": [0]}} }),
            json!({ "extensions": rtc(json!([1, 2, 3])), "scene": 7, "scenes": [{"nodes": [0]}] }),
            json!({ "extensions": rtc(json!([1, 2, 3])), "scenes": [{"nodes": [0]}] }),
        ] {
            assert!(plain.apply_to(&mut json).is_err(), "{json}");
        }
    }

    #[test]
    fn damaged_tiles_are_errors() {
        let whole = tile("{}", "", b"glTF");
        assert!(unwrap(&whole).is_ok());
        for (bytes, part) in [
            (&whole[..20], "ends inside"),
            (&tile("{}", "", b"")[..], "no GLB"),
            (&tile("{", "", b"glTF")[..], "feature table"),
            (&tile(r#"{"RTC_CENTER": {"byteOffset": 0}}"#, "", b"glTF")[..], "three finite"),
            (b"i3dm", "instances"),
        ] {
            let message = unwrap(bytes).unwrap_err().to_string();
            assert!(message.contains(part), "{message}");
        }
        let mut long = whole.clone();
        long[12..16].fill(0xff);
        assert!(unwrap(&long).is_err());
    }
}
