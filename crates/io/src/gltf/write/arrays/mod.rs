//! Encoding of a primitive's vertices and indices as glTF arrays.

pub(crate) mod blob;
pub(crate) mod quantize;
pub(crate) mod vertex_cache;

use meshlod_mesh::{Layer, LayerKind, Mesh, VertexId, WedgeId};

use crate::error::Unsupported;
use crate::gltf::document::component;
use crate::gltf::document::schema::parse_target_name;
use crate::gltf::read::mesh::flip_v;
use crate::gltf::write::arrays::blob::{extent, floats};
use crate::gltf::write::quantized::grid::QuantizationGrid;
use crate::gltf::write::settings::Compression;
use crate::gltf::write::strip_mesh::StripCorner;
use crate::meshopt::Filter;
use crate::scene::influences;
use crate::scene::influences::Weights;
use blob::{Blob, Part, Usage};

/// Arrays of a primitive.
pub(crate) struct Arrays {
    /// Positions of the vertices.
    pub positions: Blob,
    /// The requested layers, in order.
    pub layers: Vec<Blob>,
    /// Arrays of indices: of faces, three each, or of strips.
    pub indices: Vec<Blob>,
    /// Largest distance that a vertex moved.
    pub position_error: f64,
}

/// Number formats of the arrays: compression options and grid, if any.
#[derive(Clone, Copy, Default)]
pub(crate) struct Numbers<'a> {
    pub compression: Option<&'a Compression>,
    /// Grid that the positions are quantized to, if any.
    pub grid: Option<&'a QuantizationGrid>,
}

/// Layer with its component type in the source file, if any.
#[derive(Clone, Copy)]
pub(crate) struct Typed<'a> {
    pub layer: &'a Layer,
    pub component: Option<u32>,
}

/// Builds the arrays for the given faces. Every distinct pair of vertex and wedge becomes a vertex
/// of the primitive, in the order of wedges: the order of the file, if the mesh came from one.
/// Compressed arrays are instead sorted for the vertex cache.
///
/// # Errors
/// If a coordinate exceeds 32 bits, or glTF has no type for the width of a layer.
pub(crate) fn arrays(
    mesh: &Mesh,
    faces: &[u32],
    layers: &[Typed<'_>],
    numbers: Numbers<'_>,
) -> Result<Arrays, Unsupported> {
    let corners: Vec<u64> = faces.iter().flat_map(|&face| keys(mesh, face as usize)).collect();
    let mut vertices = vertices_of(&corners);
    let mut indices = indices_of(&corners, &vertices);
    if numbers.compression.is_some() {
        let old = vertex_cache::arrange(indices.as_chunks_mut().0, vertices.len());
        vertices = old.iter().map(|&v| vertices[v as usize]).collect();
    }
    let indices = vec![index_blob(&indices, vertices.len())];
    with_vertices(mesh, &vertices, layers, numbers, indices)
}

/// Builds the arrays for strips, each given by its corners; all share the vertices.
///
/// # Errors
/// Errors of [`arrays`].
pub(crate) fn strip_arrays(
    mesh: &Mesh,
    strips: &[&[StripCorner]],
    layers: &[Typed<'_>],
) -> Result<Arrays, Unsupported> {
    let keys: Vec<u64> = strips.iter().copied().flatten().map(|&(v, w)| key(v, w)).collect();
    let vertices = vertices_of(&keys);
    let all = indices_of(&keys, &vertices);
    let mut rest = &all[..];
    let indices = strips.iter().map(|strip| {
        let (these, others) = rest.split_at(strip.len());
        rest = others;
        index_blob(these, vertices.len())
    });
    let indices = indices.collect();
    with_vertices(mesh, &vertices, layers, Numbers::default(), indices)
}

fn with_vertices(
    mesh: &Mesh,
    vertices: &[u64],
    layers: &[Typed<'_>],
    numbers: Numbers<'_>,
    indices: Vec<Blob>,
) -> Result<Arrays, Unsupported> {
    let mut values: Vec<Vec<f32>> =
        layers.iter().map(|typed| values_at(typed.layer, vertices)).collect();
    let weights = match numbers.compression {
        Some(_) => Weights::Bytes,
        None => Weights::Floats,
    };
    let kinds: Vec<LayerKind> = layers.iter().map(|typed| typed.layer.kind).collect();
    influences::normalize(&kinds, &mut values, weights);
    let blobs = layers
        .iter()
        .zip(values)
        .map(|(&typed, values)| layer_blob(typed, values, vertices.len(), numbers));
    let layers = blobs.collect::<Result<_, _>>()?;
    let (positions, position_error) = positions(mesh, vertices, numbers.grid)?;
    Ok(Arrays { layers, positions, indices, position_error })
}

/// Lists the distinct corners in order.
fn vertices_of(corners: &[u64]) -> Vec<u64> {
    let mut vertices = corners.to_vec();
    vertices.sort_unstable();
    vertices.dedup();
    vertices
}

fn indices_of(corners: &[u64], vertices: &[u64]) -> Vec<u32> {
    let find = |corner| vertices.binary_search(corner).expect("every corner is a vertex") as u32;
    corners.iter().map(find).collect()
}

/// Builds a primitive with one degenerate face at `point`, as glTF does not allow empty meshes.
pub(crate) fn nothing(point: [f64; 3]) -> Result<Arrays, Unsupported> {
    let face = [VertexId(0); 3];
    arrays(&Mesh::new(vec![point], vec![face]), &[0], &[], Numbers::default())
}

/// Packs wedge and vertex of each corner into one number, the wedge in the high half.
fn keys(mesh: &Mesh, face: usize) -> [u64; 3] {
    let (vertices, wedges) = (mesh.faces[face], mesh.corner_wedges(face));
    std::array::from_fn(|i| key(vertices[i], wedges[i]))
}

fn key(vertex: VertexId, wedge: WedgeId) -> u64 {
    u64::from(wedge.0) << 32 | u64::from(vertex.0)
}

fn wedge_of(key: u64) -> WedgeId {
    WedgeId((key >> 32) as u32)
}

fn index_blob(indices: &[u32], vertices: usize) -> Blob {
    // The largest value of an index type is reserved for primitive restart.
    let (component, bytes): (_, Vec<u8>) = if vertices < usize::from(u16::MAX) {
        (component::U16, indices.iter().flat_map(|&i| (i as u16).to_le_bytes()).collect())
    } else {
        (component::U32, indices.iter().flat_map(|i| i.to_le_bytes()).collect())
    };
    Blob {
        component,
        shape: "SCALAR",
        normalized: false,
        count: indices.len(),
        bytes,
        stride: None,
        extent: None,
        usage: Usage::Indices,
        part: Part::Connectivity,
        filter: Filter::None,
    }
}

fn positions(
    mesh: &Mesh,
    vertices: &[u64],
    grid: Option<&QuantizationGrid>,
) -> Result<(Blob, f64), Unsupported> {
    let mut points = Vec::with_capacity(vertices.len());
    for &key in vertices {
        let vertex = key as u32;
        let position = mesh.positions[vertex as usize].map(|x| x as f32);
        if !position.iter().all(|x| x.is_finite()) {
            let reason = "a coordinate does not fit in 32-bit floats, the only type that glTF has";
            return Err(Unsupported::new(format!("v{vertex}"), reason));
        }
        points.push(position);
    }
    if let Some(grid) = grid {
        let places = vertices.iter().map(|&key| mesh.positions[key as u32 as usize]);
        return Ok(quantize::positions(&places.collect::<Vec<_>>(), grid));
    }
    let blob = Blob {
        extent: Some(extent(&points)),
        part: Part::Positions,
        ..floats("VEC3", points.len(), points.as_flattened())
    };
    Ok((blob, 0.0))
}

/// Lists the values of a layer at the vertices, with the texture origin of glTF.
fn values_at(layer: &Layer, vertices: &[u64]) -> Vec<f32> {
    let mut values: Vec<f32> =
        vertices.iter().flat_map(|&key| layer.of(wedge_of(key))).copied().collect();
    if matches!(layer.kind, LayerKind::Uv(_)) {
        flip_v(&mut values);
    }
    values
}

/// Encodes the values of a layer: quantized, as integers, or as floats.
///
/// # Errors
/// If glTF has no type for the width of the layer.
fn layer_blob(
    typed: Typed<'_>,
    values: Vec<f32>,
    count: usize,
    numbers: Numbers<'_>,
) -> Result<Blob, Unsupported> {
    let Typed { layer, component } = typed;
    let shape = shape_of(layer)?;
    // 16-bit colours keep their precision.
    let small = numbers.compression.filter(|_| component != Some(component::U16));
    let small = small
        .and_then(|compression| quantize::layer(layer.kind, layer.width, &values, compression));
    if let Some(blob) = small {
        return Ok(blob);
    }
    let Some((component, scale)) = integers(typed, &values, numbers) else {
        return Ok(float_blob(layer, shape, &values, numbers.grid));
    };
    let (bytes, stride) = whole_numbers(&values, layer.width, component, scale);
    Ok(Blob {
        component,
        normalized: scale > 1.0,
        bytes,
        stride: (stride != layer.width * component_size(component)).then_some(stride),
        ..floats(shape, count, &[])
    })
}

/// Returns the accessor type of a layer.
fn shape_of(layer: &Layer) -> Result<&'static str, Unsupported> {
    Ok(match layer.width {
        1 => "SCALAR",
        2 => "VEC2",
        3 => "VEC3",
        4 => "VEC4",
        9 => "MAT3",
        16 => "MAT4",
        width => {
            let reason = format!("has {width} components; glTF allows 1 to 4, 9 and 16");
            return Err(Unsupported::new(format!("layer {:?}", layer.name), reason));
        }
    })
}

/// Returns the integer type of a layer and the factor of its values; `None` if it has floats.
fn integers(typed: Typed<'_>, values: &[f32], numbers: Numbers<'_>) -> Option<(u32, f32)> {
    match (typed.layer.kind, typed.component) {
        (LayerKind::Joints(_), _) if values.iter().any(|&x| x > 255.0) => {
            Some((component::U16, 1.0))
        }
        (LayerKind::Joints(_), _) => Some((component::U8, 1.0)),
        (LayerKind::Weights(_), _) if numbers.compression.is_some() => Some((component::U8, 255.0)),
        (LayerKind::Color(_), Some(component::U16)) => Some((component::U16, 65535.0)),
        (LayerKind::Color(_), Some(component::U8)) => Some((component::U8, 255.0)),
        (LayerKind::Color(_), None) if all_are_bytes(values) => Some((component::U8, 255.0)),
        _ => None,
    }
}

/// Encodes a layer as floats, or as grid cells if it moves positions on a grid.
fn float_blob(
    layer: &Layer,
    shape: &'static str,
    values: &[f32],
    grid: Option<&QuantizationGrid>,
) -> Blob {
    let moves = matches!(parse_target_name(&layer.name), Some((_, "POSITION")));
    if let Some(grid) = grid.filter(|_| moves && layer.width == 3) {
        return quantize::deltas(values.as_chunks().0, grid);
    }
    let extent = moves.then(|| extent(values.as_chunks().0));
    Blob { extent, ..floats(shape, values.len() / layer.width, values) }
}

/// Reports whether all colours are multiples of 1/255, which bytes store exactly.
fn all_are_bytes(values: &[f32]) -> bool {
    values.iter().all(|&x| (0.0..=1.0).contains(&x) && (x * 255.0).round() / 255.0 == x)
}

fn component_size(component: u32) -> usize {
    if component == component::U8 { 1 } else { 2 }
}

/// Writes values times `scale` as unsigned integers, each element padded to a multiple of four
/// bytes.
fn whole_numbers(values: &[f32], width: usize, component: u32, scale: f32) -> (Vec<u8>, usize) {
    let stride = (width * component_size(component)).next_multiple_of(4);
    let mut bytes = Vec::with_capacity(values.len() / width * stride);
    for element in values.chunks_exact(width) {
        for &value in element {
            // `as` saturates, so values out of range are clamped.
            let whole = (value * scale).round();
            match component {
                component::U8 => bytes.push(whole as u8),
                _ => bytes.extend_from_slice(&(whole as u16).to_le_bytes()),
            }
        }
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    }
    (bytes, stride)
}
