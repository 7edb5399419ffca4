//! Arrays of a Draco stream, in the types declared by glTF.

use draco_core::{
    DataType, DecodeLimits, DecoderBuffer, ErrorKind, Mesh, MeshDecoder, PointAttribute, PointIndex,
};

use super::contained::contained;
use super::header;
use super::header::{Ceiling, TOO_LARGE};
use crate::gltf::document::component;
use crate::gltf::document::schema::Accessor;

/// Decoded array. Elements other than indices are aligned to four bytes.
pub(crate) struct Array {
    /// Component type, by the number of the specification.
    pub component: u32,
    /// Components per element.
    pub width: usize,
    pub count: usize,
    pub bytes: Vec<u8>,
    /// Bytes from one element to the next, if there is padding between them.
    pub stride: Option<usize>,
}

impl Array {
    /// Returns the minimum and maximum of each component.
    pub fn extent(&self) -> [Vec<f64>; 2] {
        let size = component::size(self.component).unwrap_or(4);
        let stride = self.stride.unwrap_or(self.width * size);
        let mut extent = [vec![f64::INFINITY; self.width], vec![f64::NEG_INFINITY; self.width]];
        for element in self.bytes.chunks(stride) {
            for (k, component) in element.chunks(size).take(self.width).enumerate() {
                let value = number(self.component, component);
                extent[0][k] = extent[0][k].min(value);
                extent[1][k] = extent[1][k].max(value);
            }
        }
        extent
    }
}

/// Decoded stream.
pub(crate) struct Decoded(Mesh);

impl Decoded {
    /// Decodes a stream of triangles.
    ///
    /// # Errors
    /// The reason given by the decoder, or that it panicked, without the location.
    pub fn from_stream(stream: &[u8], ceiling: Ceiling) -> Result<Self, String> {
        header::check(stream, &ceiling)?;
        let limits = DecodeLimits::default()
            .with_max_faces(ceiling.faces as u64)
            .with_max_points(ceiling.bytes as u64)
            .with_max_decoded_bytes(ceiling.bytes as u64);
        let decoded = contained(|| {
            let mut buffer = DecoderBuffer::new(stream).with_limits(limits);
            let mut mesh = Mesh::new();
            MeshDecoder::new().decode(&mut buffer, &mut mesh).map(|()| mesh)
        });
        let mesh = match decoded {
            Some(Ok(mesh)) => mesh,
            Some(Err(error)) if error.kind() == ErrorKind::LimitExceeded => {
                return Err(TOO_LARGE.to_owned());
            }
            Some(Err(error)) => {
                let error = error.to_string().replace(char::is_control, " ");
                return Err(format!(
                    "its Draco stream cannot be decoded ({error}); export the file again"
                ));
            }
            None => {
                return Err("its Draco stream is damaged; export the file again".to_owned());
            }
        };
        if u32::try_from(mesh.num_points()).is_err() {
            return Err("its Draco stream has more points than 32 bits can number".to_owned());
        }
        Ok(Self(mesh))
    }

    pub fn points(&self) -> usize {
        self.0.num_points()
    }

    pub fn faces(&self) -> usize {
        self.0.num_faces()
    }

    /// Returns the size of all arrays of the stream, in bytes.
    pub fn size(&self) -> usize {
        let attributes = (0..self.0.num_attributes()).map(|id| self.0.attribute(id));
        let of_point: usize = attributes.map(element_size).sum();
        12 * self.faces() + of_point * self.points()
    }

    /// Returns the corners of all faces, in two bytes each if possible.
    pub fn indices(&self) -> Array {
        let corners = self.0.faces().as_flattened().iter().map(|point| point.0);
        // The greatest index of a type restarts primitives.
        let (component, bytes) = if self.points() <= usize::from(u16::MAX) {
            (component::U16, corners.flat_map(|i| (i as u16).to_le_bytes()).collect())
        } else {
            (component::U32, corners.flat_map(u32::to_le_bytes).collect())
        };
        Array { component, width: 1, count: 3 * self.faces(), bytes, stride: None }
    }

    /// Returns the values of an attribute at all points, in the type of an accessor.
    ///
    /// # Errors
    /// The problem, as the end of a sentence that begins with the name of the attribute.
    pub fn attribute(&self, id: u32, accessor: &Accessor) -> Result<Array, String> {
        let Some(attribute) = self.0.attribute_by_unique_id(id) else {
            return Err(format!("is not in its Draco stream, which has no attribute {id}"));
        };
        let shape = &accessor.shape;
        let width =
            component::width(shape).ok_or_else(|| format!("has the unknown type {shape:?}"))?;
        let found = usize::from(attribute.num_components());
        if found != width {
            return Err(format!("has {found} components in its Draco stream, but is {shape}"));
        }
        let component = accessor.component_type;
        let size = component::size(component)
            .ok_or_else(|| format!("has the unknown component type {component}"))?;
        let stride = (width * size).next_multiple_of(4);
        let mut bytes = Vec::with_capacity(stride * self.points());
        for point in 0..self.points() as u32 {
            let value = value_at(attribute, point)
                .ok_or_else(|| format!("has no value at point {point} of its Draco stream"))?;
            if component_of(attribute.data_type()) == Some(component) {
                bytes.extend_from_slice(value);
            } else {
                convert(attribute, value, component, &mut bytes)
                    .map_err(|reason| format!("has a value at point {point} {reason}"))?;
            }
            bytes.resize(bytes.len().next_multiple_of(4), 0);
        }
        let stride = (stride > width * size).then_some(stride);
        Ok(Array { component, width, count: self.points(), bytes, stride })
    }
}

fn element_size(attribute: &PointAttribute) -> usize {
    usize::from(attribute.num_components()) * attribute.data_type().byte_length()
}

/// Returns the bytes of an attribute's value at a point.
fn value_at(attribute: &PointAttribute, point: u32) -> Option<&[u8]> {
    let entry = attribute.mapped_index(PointIndex(point)).0 as usize;
    let size = element_size(attribute);
    let start = entry.checked_mul(size)?;
    attribute.buffer().data().get(start..start.checked_add(size)?)
}

/// Appends the components of a value, converted to another type.
fn convert(
    attribute: &PointAttribute,
    value: &[u8],
    component: u32,
    out: &mut Vec<u8>,
) -> Result<(), String> {
    let from = attribute.data_type();
    for bytes in value.chunks(from.byte_length().max(1)) {
        let mut value = scalar(from, bytes).ok_or("of a type that glTF does not know")?;
        if component == component::F32 {
            if attribute.normalized() && from.is_integral() {
                value /= greatest(from);
            }
            out.extend((value as f32).to_le_bytes());
            continue;
        }
        let fits = |least: f64, most: f64| (least..=most).contains(&value) && value.fract() == 0.0;
        let whole = value as i64;
        match component {
            component::I8 if fits(-128.0, 127.0) => out.extend((whole as i8).to_le_bytes()),
            component::U8 if fits(0.0, 255.0) => out.push(whole as u8),
            component::I16 if fits(-32768.0, 32767.0) => out.extend((whole as i16).to_le_bytes()),
            component::U16 if fits(0.0, 65535.0) => out.extend((whole as u16).to_le_bytes()),
            component::U32 if fits(0.0, f64::from(u32::MAX)) => {
                out.extend((whole as u32).to_le_bytes());
            }
            _ => return Err(format!("that component type {component} cannot hold: {value}")),
        }
    }
    Ok(())
}

/// Returns the glTF component type equal to a type of Draco.
fn component_of(data: DataType) -> Option<u32> {
    Some(match data {
        DataType::Int8 => component::I8,
        DataType::Uint8 => component::U8,
        DataType::Int16 => component::I16,
        DataType::Uint16 => component::U16,
        DataType::Uint32 => component::U32,
        DataType::Float32 => component::F32,
        _ => return None,
    })
}

/// Reads one component of a type of Draco; `None` for types that no writer of glTF uses.
fn scalar(data: DataType, bytes: &[u8]) -> Option<f64> {
    Some(match data {
        DataType::Int32 => f64::from(i32::from_le_bytes(bytes.try_into().ok()?)),
        DataType::Float64 => f64::from_le_bytes(bytes.try_into().ok()?),
        DataType::Bool => f64::from(*bytes.first()?),
        _ => number(component_of(data)?, bytes),
    })
}

/// Reads one component of a glTF type.
fn number(kind: u32, bytes: &[u8]) -> f64 {
    match kind {
        component::I8 => f64::from(bytes[0] as i8),
        component::U8 => f64::from(bytes[0]),
        component::I16 => f64::from(i16::from_le_bytes(first(bytes))),
        component::U16 => f64::from(u16::from_le_bytes(first(bytes))),
        component::U32 => f64::from(u32::from_le_bytes(first(bytes))),
        _ => f64::from(f32::from_le_bytes(first(bytes))),
    }
}

fn first<const N: usize>(bytes: &[u8]) -> [u8; N] {
    std::array::from_fn(|k| bytes[k])
}

/// Returns the value that represents 1 in a normalised integer type.
fn greatest(data: DataType) -> f64 {
    match data {
        DataType::Int8 => 127.0,
        DataType::Uint8 => 255.0,
        DataType::Int16 => 32767.0,
        DataType::Uint16 => 65535.0,
        DataType::Int32 => f64::from(i32::MAX),
        DataType::Uint32 => f64::from(u32::MAX),
        _ => 1.0,
    }
}
