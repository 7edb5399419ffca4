//! Writing OFF files.

use std::io::{self, Write};

use meshlod_mesh::{Attributes, LayerKind, Mesh};

use crate::precision::Precision;
use crate::remarks;
use crate::text::line_writer::LineWriter;
use crate::vertex_attributes::split_at_seams;

/// Writes a mesh as a text OFF file, with the normals, the first colours and the texture
/// coordinates of its vertices, if it has them.
///
/// The format has one set of attributes per vertex, so a vertex with several wedges is written once
/// for each. Other layers, materials and objects are not written. A mesh without seams reads back
/// unchanged, bit for bit at `F64`.
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
    const LAYERS: [LayerKind; 3] = [LayerKind::Normal, LayerKind::Color(0), LayerKind::Uv(0)];
    let find = |kind| mesh.attributes.as_ref().and_then(|a: &Attributes| a.layer(kind));
    let [normals, colors, uvs] = LAYERS.map(find);
    let split = split_at_seams(mesh);
    let mut lines = LineWriter::new(out, precision.width(mesh));
    let letters = [(uvs, "ST"), (colors, "C"), (normals, "N")];
    let present = letters.iter().filter(|(layer, _)| layer.is_some());
    lines.word(&(present.map(|&(_, letter)| letter).collect::<String>() + "OFF"));
    lines.end()?;
    remarks::write(remarks, &mut lines)?;
    for count in [split.vertices.len(), split.faces.len(), 0] {
        lines.integer(count);
    }
    lines.end()?;
    for vertex in &split.vertices {
        lines.position(vertex.vertex.index(), mesh.positions[vertex.vertex.index()])?;
        for layer in [normals, colors, uvs].into_iter().flatten() {
            match vertex.wedge {
                Some(wedge) => lines.attributes(layer.of(wedge)),
                None => lines.attributes(&vec![0.0; layer.width]),
            }
        }
        lines.end()?;
    }
    for face in &split.faces {
        lines.word("3");
        for &v in face {
            lines.integer(v as usize);
        }
        lines.end()?;
    }
    lines.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::off::read;

    fn written(mesh: &Mesh, precision: Precision) -> String {
        let mut out = Vec::new();
        write(mesh, precision, &mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn what_was_read_is_written_as_it_was() {
        for text in [
            "OFF\n3 1 0\n0 0 0\n1 0.1 0\n-1e-20 1 0\n3 0 1 2\n",
            "COFF\n3 1 0\n0 0 0 1 0.5 0\n1 0 0 0 0 0\n0 1 0 1 1 1\n3 0 1 2\n",
            "STCNOFF\n3 1 0\n0 0 0 0 0 1 1 0.5 0 1 0 0\n1 0 0 0 0 1 0 0 0 1 1 0\n\
             0 1 0 0 0 1 0 0 0 1 0 1\n3 0 1 2\n",
        ] {
            let mesh = read(text.as_bytes()).unwrap();
            assert_eq!(written(&mesh, Precision::F64), text);
        }
    }

    #[test]
    fn a_seam_is_torn_and_unused_vertices_stay() {
        let mut mesh = read(
            "NOFF\n4 2 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n9 9 9 1 0 0\n3 0 1 2\n3 0 2 1\n"
                .as_bytes(),
        )
        .unwrap();
        let attributes = mesh.attributes.as_mut().unwrap();
        attributes.corners[1][1] = meshlod_mesh::WedgeId(3);
        let again = read(written(&mesh, Precision::F32).as_bytes()).unwrap();
        assert_eq!(again.positions.len(), 5);
        assert_eq!(again.positions[4], [0.0, 1.0, 0.0]);
        assert_eq!(again.attributes.unwrap().layers[0].values[12..], [1.0, 0.0, 0.0]);
    }
}
