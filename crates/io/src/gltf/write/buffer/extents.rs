//! Bounds of the accessors that are kept.

use serde_json::{Value, json};

use crate::gltf::document::{Document, component};

/// Corrects wrong `min` and `max` of accessors that are not free: programs use them for culling and
/// cameras, and validators reject wrong ones.
///
/// Missing bounds are not added. 32-bit indices and unreadable accessors stay unchanged.
///
/// Cost: linear in the components of the accessors that have bounds.
pub(crate) fn mend_extents(document: &Document<'_>, free: &[bool], accessors: &mut [Value]) {
    for (index, accessor) in accessors.iter_mut().enumerate() {
        let has_bounds = accessor.get("min").is_some() || accessor.get("max").is_some();
        if !has_bounds || free.get(index) == Some(&true) {
            continue;
        }
        let Some(found) = extent(document, index) else { continue };
        for (key, found) in ["min", "max"].into_iter().zip(found) {
            if accessor.get(key).is_some_and(|said| !says(said, &found)) {
                accessor[key] = json!(found);
            }
        }
    }
}

/// Returns the minimum and maximum of each stored component.
fn extent(document: &Document<'_>, index: usize) -> Option<[Vec<f32>; 2]> {
    if document.accessors.get(index)?.component_type == component::U32 {
        return None;
    }
    let (width, values) = document.stored_numbers(index).ok()?;
    let mut rows = values.chunks_exact(width);
    let first = rows.next()?.to_vec();
    let (mut min, mut max) = (first.clone(), first);
    for row in rows {
        for (k, &x) in row.iter().enumerate() {
            min[k] = min[k].min(x);
            max[k] = max[k].max(x);
        }
    }
    let is_finite = |values: &[f32]| values.iter().all(|x| x.is_finite());
    (is_finite(&min) && is_finite(&max)).then_some([min, max])
}

/// Reports whether a bound of the document equals the computed one in 32 bits.
fn says(said: &Value, found: &[f32]) -> bool {
    let Some(said) = said.as_array() else { return false };
    let is_same = |(said, &found): (&Value, &f32)| said.as_f64().is_some_and(|x| x as f32 == found);
    said.len() == found.len() && said.iter().zip(found).all(is_same)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gltf::document::buffers::Buffers;

    /// Mends an accessor over the floats 0.1, -2 and 0.5, or the bytes of these.
    fn mended(mut accessor: Value, is_free: bool) -> Value {
        let bytes: Vec<u8> = [0.1f32, -2.0, 0.5].iter().flat_map(|x| x.to_le_bytes()).collect();
        accessor["bufferView"] = 0.into();
        accessor["count"] = 3.into();
        accessor["type"] = "SCALAR".into();
        let json = json!({
            "accessors": [accessor], "bufferViews": [{ "buffer": 0, "byteLength": 12 }],
        });
        let buffers = Buffers::new(vec![bytes]);
        let document = Document::new(&json, &buffers).unwrap();
        let mut accessors = vec![accessor];
        mend_extents(&document, &[is_free], &mut accessors);
        accessors.remove(0)
    }

    #[test]
    fn wrong_bounds_are_corrected_and_right_ones_stay() {
        let floats = |min: Value, max: Value| {
            mended(json!({ "componentType": 5126, "min": min, "max": max }), false)
        };
        let right = floats(json!([-2]), json!([0.5]));
        assert_eq!((&right["min"], &right["max"]), (&json!([-2]), &json!([0.5])));
        for wrong in [json!([0]), json!([-2, 0]), json!(3), json!(["x"])] {
            let mended = floats(wrong.clone(), wrong);
            assert_eq!((&mended["min"], &mended["max"]), (&json!([-2.0]), &json!([0.5])));
        }
    }

    #[test]
    fn integers_have_the_bounds_that_are_stored() {
        let accessor = json!({ "componentType": 5121, "normalized": true, "max": [1.0] });
        let mended = mended(accessor, false);
        assert_eq!((mended.get("min"), &mended["max"]), (None, &json!([205.0])));
    }

    #[test]
    fn what_is_free_or_cannot_be_read_stays() {
        let wrong = json!({ "componentType": 5126, "min": [7] });
        assert_eq!(mended(wrong.clone(), true)["min"], json!([7]));
        for kind in [5125, 1] {
            let accessor = json!({ "componentType": kind, "min": [7] });
            assert_eq!(mended(accessor, false)["min"], json!([7]));
        }
    }
}
