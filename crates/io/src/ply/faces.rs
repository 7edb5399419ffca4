//! PLY faces and triangle strips, converted to triangles.

use meshlod_mesh::VertexId;

use super::body::{BodyReader, Row};
use super::face_rows::no_list;
use super::face_values::{FaceRow, FaceValues};
use super::header::{Element, Shape};
use crate::error::ParseError;
use crate::polygon::triangulate;

/// Index that ends a strip within a list; it is not a vertex.
const RESTART: u32 = u32::MAX;

/// Triangles read so far, and buffers reused for every row.
#[derive(Default)]
pub(super) struct Faces {
    pub triangles: Vec<[VertexId; 3]>,
    pub values: FaceValues,
    /// Number of faces with fewer than three corners, which have no triangle.
    pub thin: usize,
    row: FaceRow,
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
            return Err(no_list(element));
        };
        let is_strip = element.name == "tristrips";
        self.values.begin(element, list);
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
                    _ => self.values.read(at, &mut self.row, body, row)?,
                }
            }
            body.end_row(row)?;
            self.values.check_row(&mut self.row, self.list.len());
            let before = self.triangles.len();
            if is_strip {
                self.add_strips()
            } else {
                self.thin += usize::from(self.list.len() < 3);
                self.add_polygon(positions)
            }
            self.values.end_row(before, self.triangles.len());
        }
        self.values.finish(self.triangles.len());
        Ok(())
    }

    fn add_polygon(&mut self, positions: &[[f64; 3]]) {
        if self.list.len() == 3 {
            return self.add_triangle([0, 1, 2]);
        }
        let mut corners = std::mem::take(&mut self.corners);
        corners.clear();
        triangulate(positions, &self.list, &mut corners);
        corners.iter().for_each(|&triangle| self.add_triangle(triangle));
        self.corners = corners;
    }

    /// Adds the triangle between these corners of the list.
    #[inline]
    fn add_triangle(&mut self, corners: [u32; 3]) {
        self.values.push(self.triangles.len(), &self.row, corners);
        self.triangles.push(corners.map(|corner| VertexId(self.list[corner as usize])));
    }

    /// Expands strips; triangles that repeat a vertex only join parts and are dropped.
    fn add_strips(&mut self) {
        let mut start = 0;
        for i in 0..self.list.len() {
            if self.list[i] == RESTART {
                start = i + 1;
            } else if i >= start + 2 {
                let (a, b, c) = (i - 2, i - 1, i);
                let [va, vb, vc] = [a, b, c].map(|at| self.list[at]);
                if va != vb && vb != vc && vc != va {
                    let corners = if (i - start) % 2 == 0 { [a, b, c] } else { [b, a, c] };
                    self.add_triangle(corners.map(|at| at as u32));
                }
            }
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
