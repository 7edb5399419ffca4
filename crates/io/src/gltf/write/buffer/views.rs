//! Buffer views of a source document: their use, and copies of their bytes.

use std::ops::Range;

use serde_json::Value;

use crate::gltf::document::Document;

/// Appends the bytes of some views to a buffer with this index, overlapping ranges once, and points
/// the views at the copies.
pub(crate) fn copy_views(
    document: &Document<'_>,
    mut kept: Vec<usize>,
    views: &mut [Value],
    (number, bytes): (usize, &mut Vec<u8>),
) {
    let range = |view: usize| {
        let view = &document.views[view];
        (view.buffer, view.byte_offset, view.byte_offset + view.byte_length)
    };
    kept.sort_by_key(|&view| range(view));
    // Current run of overlapping views: its buffer, its byte range there, and where the copy of
    // that range begins.
    let mut run: Option<(usize, Range<usize>, usize)> = None;
    for view in kept {
        let (buffer, start, end) = range(view);
        let (run_range, run_at) = match &mut run {
            Some((b, range, at)) if *b == buffer && start < range.end => (range, *at),
            _ => {
                // Same offset modulo 8, so that every alignment holds.
                while bytes.len() % 8 != start % 8 {
                    bytes.push(0);
                }
                let (_, range, at) = run.insert((buffer, start..start, bytes.len()));
                (range, *at)
            }
        };
        if end > run_range.end {
            bytes.extend_from_slice(&document.buffers.held(buffer)[run_range.end..end]);
            run_range.end = end;
        }
        views[view]["buffer"] = number.into();
        views[view]["byteOffset"] = (run_at + start - run_range.start).into();
    }
}

/// Computes one flag per buffer view: true if only free accessors use it, or if it is unused and
/// empty or `dropped`.
pub(crate) fn free_views(
    document: &Document<'_>,
    accessors: &[Value],
    free_accessors: &[bool],
    dropped: &[usize],
) -> Vec<bool> {
    let count = document.views.len();
    let (mut by_free, mut by_others) = (vec![false; count], vec![false; count]);
    for &view in dropped.iter().filter(|&&view| view < count) {
        by_free[view] = true;
    }
    for (accessor, &free) in accessors.iter().zip(free_accessors) {
        mark_views(accessor, if free { &mut by_free } else { &mut by_others });
    }
    let rest = document.json.as_object().into_iter().flatten();
    for (_, value) in rest.filter(|(key, _)| *key != "accessors") {
        mark_views(value, &mut by_others);
    }
    let is_free = |view: usize| by_free[view] || document.views[view].byte_length == 0;
    (0..count).map(|view| is_free(view) && !by_others[view]).collect()
}

/// Marks every number under a key `bufferView`; the JSON parser bounds the depth.
pub(crate) fn mark_views(value: &Value, marks: &mut [bool]) {
    match value {
        Value::Array(values) => values.iter().for_each(|value| mark_views(value, marks)),
        Value::Object(entries) => {
            for (key, value) in entries {
                match value.as_u64().filter(|_| key == "bufferView") {
                    Some(view) => {
                        if let Some(mark) = marks.get_mut(view as usize) {
                            *mark = true;
                        }
                    }
                    None => mark_views(value, marks),
                }
            }
        }
        _ => {}
    }
}
