//! Component types of accessors, by the numbers of the specification, and the sizes of elements.

pub(crate) const I8: u32 = 5120;
pub(crate) const U8: u32 = 5121;
pub(crate) const I16: u32 = 5122;
pub(crate) const U16: u32 = 5123;
pub(crate) const U32: u32 = 5125;
pub(crate) const F32: u32 = 5126;

/// Returns the components per element of an accessor type such as `VEC3`; `None` if it is unknown.
pub(crate) fn width(shape: &str) -> Option<usize> {
    Some(match shape {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" | "MAT2" => 4,
        "MAT3" => 9,
        "MAT4" => 16,
        _ => return None,
    })
}

/// Returns the bytes of a component type; `None` if it is unknown.
pub(crate) fn size(kind: u32) -> Option<usize> {
    Some(match kind {
        I8 | U8 => 1,
        I16 | U16 => 2,
        U32 | F32 => 4,
        _ => return None,
    })
}
