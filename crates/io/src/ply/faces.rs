//! PLY faces and triangle strips, converted to triangles.

use meshlod_mesh::{VertexId, strip_triangles};

use super::body::{BodyReader, Row};
use super::header::{Element, Shape};
use crate::ParseError;
use crate::polygon::triangulate;

/// Index that ends a strip within a list; no vertex has it.
const RESTART: u32 = u32::MAX;

/// Triangles read so far, and buffers reused for every row.
#[derive(Default)]
pub(super) struct Faces {
    pub triangles: Vec<[VertexId; 3]>,
    list: Vec<u32>,
    corners: Vec<[u32; 3]>,
}

impl Faces {
    /// Reads all rows of the PLY element `face` or `tristrips` as triangles.
    pub fn read<B: BodyReader>(
        &mut self,
        body: &mut B,
        element: &Element,
        positions: &[[f64; 3]],
    ) -> Result<(), ParseError> {
        let Some(list) = element.face_list() else {
            let reason = format!("element {} has no list vertex_indices", element.name);
            return Err(ParseError::part("header", reason));
        };
        let is_strip = element.name == "tristrips";
        let mut first = 0;
        if !is_strip {
            first = body.bulk_triangles(element, positions.len(), &mut self.triangles);
            let rest = (element.count - first).min(body.most_rows(element) as u64);
            self.triangles.reserve(rest as usize);
        }
        for index in first..element.count {
            let row = Row { element, index };
            body.begin_row();
            for (at, property) in element.properties.iter().enumerate() {
                match property.shape {
                    Shape::List { length, item } if at == list => {
                        let length = body.length(length, item, row)?;
                        self.list.clear();
                        for _ in 0..length {
                            let index = body.number(item, row)?;
                            let vertex = match index {
                                -1.0 if is_strip => RESTART,
                                _ => checked(index, positions.len())
                                    .map_err(|reason| body.wrong(format!("{row} {reason}")))?,
                            };
                            self.list.push(vertex);
                        }
                    }
                    shape => body.skip_property(shape, row)?,
                }
            }
            body.end_row(row)?;
            if is_strip { self.add_strips() } else { self.add_polygon(positions) }
        }
        Ok(())
    }

    fn add_polygon(&mut self, positions: &[[f64; 3]]) {
        if let [a, b, c] = self.list[..] {
            self.triangles.push([a, b, c].map(VertexId));
            return;
        }
        self.corners.clear();
        triangulate(positions, &self.list, &mut self.corners);
        let vertex = |corner: u32| VertexId(self.list[corner as usize]);
        self.triangles.extend(self.corners.iter().map(|triangle| triangle.map(vertex)));
    }

    /// Expands strips, without the triangles that repeat a vertex, which only join their parts.
    fn add_strips(&mut self) {
        for strip in self.list.split(|&v| v == RESTART) {
            self.triangles.extend(strip_triangles(strip).map(|triangle| triangle.map(VertexId)));
        }
    }
}

/// Converts a vertex index, or explains why it is invalid.
fn checked(index: f64, vertices: usize) -> Result<u32, String> {
    if index.fract() == 0.0 && (0.0..vertices as f64).contains(&index) {
        return Ok(index as u32);
    }
    Err(format!("refers to vertex {index}, but there are only {vertices}, counted from 0"))
}
