//! PLY vertices: their positions, and attribute layers of the other properties.

use meshlod_mesh::{Layer, LayerKind};

use super::body::{BodyReader, Row};
use super::header::{Element, Property, Shape};
use super::layers;
use super::layers::LayerColumns;
use super::scalar::Scalar;
use crate::error::ParseError;

/// Vertices of a file.
#[derive(Default)]
pub(super) struct Vertices {
    pub positions: Vec<[f64; 3]>,
    /// Attribute layers, one wedge per vertex.
    pub layers: Vec<Layer>,
    /// Types of layer properties that differ from the default types, by name.
    pub types: Vec<(String, Scalar)>,
    /// Names of the lists, which are skipped.
    pub lists: Vec<String>,
    /// Values of other layers that are not exact in 32 bits.
    pub rounded: usize,
    /// Values of layers other than normals that are not finite in 32 bits, read as 0.
    pub not_finite: usize,
}

/// Reads all rows of the element.
pub(super) fn read<B: BodyReader>(body: &mut B, element: &Element) -> Result<Vertices, ParseError> {
    if element.count > u64::from(u32::MAX) {
        let most = body.most_rows(element);
        return Err(ParseError::part(
            "header",
            format!(
                "the header declares {} vertices, but at most {most} can follow",
                element.count
            ),
        ));
    }
    let xyz = coordinates(element)?;
    let columns = layers::columns(&element.properties);
    let mut vertices = Vertices::default();
    let rows = body.most_rows(element).min(element.count as usize);
    let mut first = 0;
    if columns.is_empty() {
        first = body.bulk_positions(element, xyz, &mut vertices.positions);
    }
    vertices.positions.reserve_exact(rows - first as usize);
    let list = |p: &&Property| matches!(p.shape, Shape::List { .. });
    vertices.lists = element.properties.iter().filter(list).map(|p| p.name.clone()).collect();
    vertices.types = types(element, &columns);
    vertices.layers = columns.iter().map(|columns| columns.layer(rows)).collect();

    let mut numbers = vec![0.0; element.properties.len()];
    for index in first..element.count {
        let row = Row { element, index };
        body.begin_row();
        read_numbers(body, row, &mut numbers)?;
        vertices.add(body, xyz, &columns, &numbers)?;
        body.end_row(row)?;
    }
    Ok(vertices)
}

/// Lists the types of colours and other layers, except the default ones.
fn types(element: &Element, columns: &[LayerColumns]) -> Vec<(String, Scalar)> {
    let mut types = Vec::new();
    for layer in columns {
        let usual = match layer.kind {
            LayerKind::Color(_) => Scalar::U8,
            LayerKind::Other => Scalar::F32,
            LayerKind::Label => Scalar::I32,
            _ => continue,
        };
        // Colours are written under the usual names, whatever they were called.
        let written = layers::set_names(layer.kind);
        for (i, column) in layer.columns.iter().enumerate() {
            if column.kind != usual {
                let own = || element.properties[column.property].name.clone();
                types.push((written.get(i).cloned().unwrap_or_else(own), column.kind));
            }
        }
    }
    types
}

/// Returns the indices of the properties x, y and z.
pub(super) fn coordinates(element: &Element) -> Result<[usize; 3], ParseError> {
    let mut xyz = [0; 3];
    for (at, name) in xyz.iter_mut().zip(["x", "y", "z"]) {
        let found = element
            .properties
            .iter()
            .position(|property| property.name == name && matches!(property.shape, Shape::One(_)));
        *at = found.ok_or_else(|| {
            ParseError::part("header", format!("element vertex has no scalar property {name}"))
        })?;
    }
    Ok(xyz)
}

/// Reads one number per property, skipping lists.
fn read_numbers<B: BodyReader>(
    body: &mut B,
    row: Row,
    numbers: &mut [f64],
) -> Result<(), ParseError> {
    for (number, property) in numbers.iter_mut().zip(&row.element.properties) {
        match property.shape {
            Shape::One(kind) => *number = body.number(kind, row)?,
            list @ Shape::List { .. } => body.skip_property(list, row)?,
        }
    }
    Ok(())
}

impl Vertices {
    /// Adds the vertex of a row.
    fn add(
        &mut self,
        body: &impl BodyReader,
        xyz: [usize; 3],
        columns: &[LayerColumns],
        numbers: &[f64],
    ) -> Result<(), ParseError> {
        let vertex = self.positions.len();
        let position = xyz.map(|property| numbers[property]);
        if !position.iter().all(|x| x.is_finite()) {
            return Err(body.wrong(format!(
                "vertex {vertex} has a coordinate that is not finite: {position:?}"
            )));
        }
        self.positions.push(position);
        for (layer, columns) in self.layers.iter_mut().zip(columns) {
            for column in &columns.columns {
                let number = numbers[column.property];
                let value = (number / column.unit) as f32;
                let is_rounded = f64::from(value) != number || column.kind.may_round(number);
                if value.is_finite() && layer.kind.is_named() && is_rounded {
                    self.rounded += 1;
                }
                layer.values.push(value);
            }
            let from = layer.values.len() - columns.columns.len();
            self.not_finite += make_finite(layer.kind, &mut layer.values[from..]);
        }
        Ok(())
    }
}

/// Replaces values of a vertex that are not finite by 0, and counts them. A normal becomes zero as
/// a whole, and is later computed and counted like other zero normals.
pub(super) fn make_finite(kind: LayerKind, values: &mut [f32]) -> usize {
    let odd = values.iter().filter(|x| !x.is_finite()).count();
    if odd == 0 {
        return 0;
    }
    if kind == LayerKind::Normal {
        values.fill(0.0);
        return 0;
    }
    values.iter_mut().filter(|x| !x.is_finite()).for_each(|x| *x = 0.0);
    odd
}

impl LayerColumns {
    /// Creates the layer, empty, with capacity for the given number of wedges.
    pub(super) fn layer(&self, wedges: usize) -> Layer {
        let width = self.columns.len();
        let values = Vec::with_capacity(wedges * width);
        Layer { kind: self.kind, name: self.name.clone(), width, values }
    }
}
