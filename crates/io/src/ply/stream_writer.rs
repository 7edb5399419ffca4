//! Writing a file vertex by vertex and face by face, for meshes that are larger than memory.

use std::io::{Result, Write};

use super::write::{BLOCK, append_position, flush_if_full, header_text, invalid};
use crate::precision::{Precision, Width};

/// Sizes and properties of a file that is written in passing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StreamShape {
    /// Number of vertices.
    pub vertices: u64,
    /// Number of faces.
    pub faces: u64,
    /// True if vertices have colours.
    pub has_colors: bool,
    /// Type of the coordinates; 32-bit floats for [`Precision::Auto`].
    pub precision: Precision,
}

/// Writer of a binary little-endian file: all vertices, then all faces.
pub struct StreamWriter<'o> {
    out: &'o mut dyn Write,
    shape: StreamShape,
    width: Width,
    vertices: u64,
    faces: u64,
    block: Vec<u8>,
}

impl<'o> StreamWriter<'o> {
    /// Writes the header, as [`write()`](super::write()) does for such a mesh.
    ///
    /// # Errors
    /// Errors of `out`, and more vertices than 32-bit numbers tell apart.
    pub fn new(out: &'o mut dyn Write, shape: StreamShape) -> Result<Self> {
        if shape.vertices > 1 << 32 {
            return Err(invalid("more than 4,294,967,296 vertices cannot be written"));
        }
        let width = if shape.precision == Precision::F64 { Width::F64 } else { Width::F32 };
        let colors: &[&str] = if shape.has_colors { &["red", "green", "blue"] } else { &[] };
        let colors = colors.iter().map(|name| format!("property uchar {name}")).collect();
        let header = header_text(vec![], width, (shape.vertices, colors), (shape.faces, vec![]));
        out.write_all(header.as_bytes())?;
        let block = Vec::with_capacity(BLOCK + BLOCK / 4);
        Ok(Self { out, shape, width, vertices: 0, faces: 0, block })
    }

    /// Writes a vertex; the colour is passed over if vertices have none.
    ///
    /// # Errors
    /// Errors of `out`.
    pub fn vertex(&mut self, place: [f64; 3], color: [u8; 3]) -> Result<()> {
        append_position(place, self.width, &mut self.block);
        if self.shape.has_colors {
            self.block.extend(color);
        }
        self.vertices += 1;
        flush_if_full(&mut self.block, self.out)
    }

    /// Writes a triangle.
    ///
    /// # Errors
    /// Errors of `out`.
    pub fn face(&mut self, face: [u32; 3]) -> Result<()> {
        self.block.push(3);
        face.iter().for_each(|index| self.block.extend(index.to_le_bytes()));
        self.faces += 1;
        flush_if_full(&mut self.block, self.out)
    }

    /// Writes what is left.
    ///
    /// # Errors
    /// Errors of `out`, and other numbers of vertices and faces than the header has.
    pub fn finish(self) -> Result<()> {
        let StreamShape { vertices, faces, .. } = self.shape;
        if (self.vertices, self.faces) != (vertices, faces) {
            let (own_vertices, own_faces) = (self.vertices, self.faces);
            let reason = format!(
                "{own_vertices} vertices and {own_faces} faces, but the header says {vertices} \
                 and {faces}"
            );
            return Err(invalid(reason));
        }
        self.out.write_all(&self.block)
    }
}

#[cfg(test)]
mod tests {
    use meshlod_samples as samples;

    use super::super::write;
    use super::*;

    #[test]
    fn a_terrain_in_passing_has_the_same_bytes() {
        for (has_colors, precision) in [(false, Precision::Auto), (true, Precision::F64)] {
            let mesh =
                if has_colors { samples::colored_terrain(5_000) } else { samples::terrain(5_000) };
            let (mut expected, mut bytes) = (Vec::new(), Vec::new());
            write(&mesh, precision, &mut expected).unwrap();
            let rows = samples::TerrainRows::new(5_000);
            let [vertices, faces] = rows.sizes();
            let shape = StreamShape { vertices, faces, has_colors, precision };
            let mut writer = StreamWriter::new(&mut bytes, shape).unwrap();
            for place in (0..rows.count()).flat_map(|row| rows.places(row)) {
                writer.vertex(place, samples::terrain_color(place[1])).unwrap();
            }
            let mut faces = (0..rows.count() - 1).flat_map(|row| rows.faces(row));
            faces.try_for_each(|face| writer.face(face)).unwrap();
            writer.finish().unwrap();
            assert!(bytes == expected);
        }
    }

    #[test]
    fn other_counts_than_those_of_the_header_are_refused() {
        let shape =
            StreamShape { vertices: 1, faces: 0, has_colors: false, precision: Precision::Auto };
        let mut bytes = Vec::new();
        assert!(StreamWriter::new(&mut bytes, shape).unwrap().finish().is_err());
        let shape = StreamShape { vertices: (1 << 32) + 1, ..shape };
        assert!(StreamWriter::new(&mut bytes, shape).is_err());
    }
}
