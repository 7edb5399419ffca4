//! Arrays of numbers to be written as accessors.

use crate::gltf::document::component;
use crate::meshopt::Filter;

/// Array to be written as an accessor of its own.
pub(crate) struct Blob {
    /// Component type, by the number of the specification.
    pub component: u32,
    /// Element type: `SCALAR`, `VEC3`, …
    pub shape: &'static str,
    pub normalized: bool,
    pub count: usize,
    /// Elements, each aligned to four bytes unless they are indices.
    pub bytes: Vec<u8>,
    /// Bytes from one element to the next, if there is padding between them.
    pub stride: Option<usize>,
    /// Minimum and maximum of every component; required for positions.
    pub extent: Option<[[f32; 3]; 2]>,
    pub usage: Usage,
    pub part: Part,
    /// Filter that decodes `bytes` into the elements, if the builder compresses.
    pub filter: Filter,
}

/// Category under which bytes are counted in the report.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Part {
    Positions,
    Connectivity,
    Attributes,
}

/// Buffer view target.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Usage {
    Vertices = 34962,
    Indices = 34963,
}

pub(crate) fn floats(shape: &'static str, count: usize, values: &[f32]) -> Blob {
    Blob {
        component: component::F32,
        shape,
        normalized: false,
        count,
        bytes: values.iter().map(|x| x.to_le_bytes()).collect::<Vec<_>>().into_flattened(),
        stride: None,
        extent: None,
        usage: Usage::Vertices,
        part: Part::Attributes,
        filter: Filter::None,
    }
}

/// Computes the minimum and maximum of each coordinate.
pub(crate) fn extent(points: &[[f32; 3]]) -> [[f32; 3]; 2] {
    let mut extent = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
    for point in points {
        for axis in 0..3 {
            extent[0][axis] = extent[0][axis].min(point[axis]);
            extent[1][axis] = extent[1][axis].max(point[axis]);
        }
    }
    extent
}
