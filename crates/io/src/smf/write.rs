//! Writing SMF files.

use std::io::{self, Write};

use meshlod_mesh::{LayerKind, Mesh};

use crate::precision::Precision;
use crate::remarks;
use crate::text::line_writer::LineWriter;
use crate::vertex_attributes::split_at_seams;

/// Writes a mesh as an SMF file, with the first colours, the normals and the texture coordinates of
/// its vertices, if it has them.
///
/// The format has one set of properties per vertex, so a vertex with several wedges is written once
/// for each. Opacity, other layers, materials and objects are not written. A mesh without seams
/// reads back unchanged, bit for bit at `F64`, except that normals are normalised.
///
/// # Errors
/// Errors of `out`, and a position that `precision` cannot hold.
pub fn write(mesh: &Mesh, precision: Precision, out: &mut dyn Write) -> io::Result<()> {
    write_commented(mesh, &[], precision, out)
}

/// Writes a mesh as [`write()`] does, with comments: the `remarks` of a PLY file.
///
/// # Errors
/// Errors of [`write()`].
pub(crate) fn write_commented(
    mesh: &Mesh,
    remarks: &[String],
    precision: Precision,
    out: &mut dyn Write,
) -> io::Result<()> {
    let split = split_at_seams(mesh);
    let mut lines = LineWriter::new(out, precision.width(mesh));
    for header in [
        "#$SMF 1.0".to_owned(),
        format!("#$vertices {}", split.vertices.len()),
        format!("#$faces {}", split.faces.len()),
    ] {
        lines.word(&header);
        lines.end()?;
    }
    remarks::write(remarks, &mut lines)?;
    for vertex in &split.vertices {
        lines.word("v");
        lines.position(vertex.vertex.index(), mesh.positions[vertex.vertex.index()])?;
        lines.end()?;
    }
    for face in &split.faces {
        lines.word("f");
        for &v in face {
            lines.integer(v as usize + 1);
        }
        lines.end()?;
    }
    for (letter, kind, width) in
        [("c", LayerKind::Color(0), 3), ("n", LayerKind::Normal, 3), ("r", LayerKind::Uv(0), 2)]
    {
        let attributes = mesh.attributes.as_ref();
        let Some(layer) = attributes.and_then(|attributes| attributes.layer(kind)) else {
            continue;
        };
        lines.word(&format!("bind {letter} vertex"));
        lines.end()?;
        for vertex in &split.vertices {
            let mut values = [0.0; 3];
            if let Some(wedge) = vertex.wedge {
                for (value, &x) in values.iter_mut().zip(layer.of(wedge)) {
                    *value = x;
                }
            }
            lines.word(letter);
            lines.attributes(&values[..width]);
            lines.end()?;
        }
    }
    lines.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::smf::read;

    #[test]
    fn what_was_read_is_written_as_it_was() {
        let text = "#$SMF 1.0\n#$vertices 3\n#$faces 1\n\
                    v 0 0 0\nv 1 0.1 0\nv -1e-20 1 0\nf 1 2 3\n\
                    bind c vertex\nc 1 0 0.5\nc 0 0 0\nc 1 1 1\n\
                    bind n vertex\nn 0 0 1\nn 0 0 1\nn 0 1 0\n\
                    bind r vertex\nr 0 0\nr 1 0\nr 0 1\n";
        let mesh = read(text.as_bytes()).unwrap();
        let mut out = Vec::new();
        write(&mesh, Precision::F64, &mut out).unwrap();
        assert_eq!(String::from_utf8(out).unwrap(), text);
    }
}
