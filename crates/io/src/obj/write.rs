//! Writing OBJ files, with one list each of positions, texture coordinates and normals.

use std::io::{self, Write};

use meshlod_mesh::{Labels, LayerKind, Mesh};

use super::colored_vertices::ColoredVertices;
use super::mtl::{names, one_line};
use super::value_numbers::{UvNumbers, ValueNumbers};
use crate::precision::Precision;
use crate::remarks;
use crate::scene::Scene;
use crate::text::line_writer::LineWriter;

/// Writes all meshes that a scene shows, in world space, as one OBJ file; `libraries` are the file
/// names of the material libraries, see [`write_mtl`](super::write_mtl).
///
/// Equal uvs and equal normals are written once; a face uses the uv set of its base colour texture.
/// Colours follow the positions, without opacity; a vertex with several colours is written once for
/// each. Objects become `o`, materials `usemtl`, with names made unique, and smoothing groups `s`.
/// Comments of a PLY file come first. Positions (at `F64`), uvs and normals read back bit for bit.
/// Other layers are not written.
///
/// # Errors
/// Errors of `out`, and a position that `precision` cannot hold.
pub fn write(
    scene: &Scene,
    precision: Precision,
    out: &mut dyn Write,
    libraries: &[String],
) -> io::Result<()> {
    let mesh = scene.flatten();
    let mut lines = LineWriter::new(out, precision.width(&mesh));
    remarks::write(&scene.ply.remarks, &mut lines)?;
    for name in libraries {
        lines.word("mtllib");
        lines.word(name);
        lines.end()?;
    }
    let colored = ColoredVertices::of(&mesh);
    write_positions(&mesh, colored.as_ref(), &mut lines)?;
    let uvs = UvNumbers::write(&mesh, &scene.texture_sets(), &mut lines)?;
    let normals = ValueNumbers::write(&mesh, LayerKind::Normal, "vn", 0, &mut lines)?;
    let objects = Changes::new("o", mesh.objects.as_ref(), &[]);
    let materials = Changes::new("usemtl", mesh.materials.as_ref(), &names(&scene.materials));
    let changes = FaceChanges { labels: [objects, materials], smoothing: 0 };
    let vertices = colored.as_ref().map(|colored| &colored.split.faces[..]);
    write_faces(&mesh, vertices, &uvs, &normals, changes, &mut lines)?;
    lines.finish()
}

fn write_positions(
    mesh: &Mesh,
    colored: Option<&ColoredVertices>,
    lines: &mut LineWriter,
) -> io::Result<()> {
    let Some(ColoredVertices { colors, split }) = colored else {
        for (v, &position) in mesh.positions.iter().enumerate() {
            lines.word("v");
            lines.position(v, position)?;
            lines.end()?;
        }
        return Ok(());
    };
    for row in &split.vertices {
        lines.word("v");
        lines.position(row.vertex.index(), mesh.positions[row.vertex.index()])?;
        // White, if no face uses the vertex.
        lines.attributes(row.wedge.map_or(&[1.0; 3][..], |wedge| colors.of(wedge)));
        lines.end()?;
    }
    Ok(())
}

/// Writer of a statement for each change of the label.
struct Changes<'a> {
    word: &'static str,
    labels: Option<&'a Labels>,
    names: Vec<String>,
    /// Label in effect; `None` before the first statement.
    current: Option<u32>,
}

impl<'a> Changes<'a> {
    /// `names` replace the first names of the labels.
    fn new(word: &'static str, labels: Option<&'a Labels>, names: &[String]) -> Self {
        let own = labels.map_or(&[][..], |labels| &labels.names);
        let rest = own.iter().skip(names.len()).map(|name| one_line(name, str::trim));
        Self { word, labels, names: names.iter().cloned().chain(rest).collect(), current: None }
    }

    fn write(&mut self, face: usize, lines: &mut LineWriter) -> io::Result<()> {
        let Some(labels) = self.labels else { return Ok(()) };
        let label = labels.of(face);
        if self.current == Some(label) {
            return Ok(());
        }
        let name = &self.names[label as usize];
        // Before the first statement, faces have no name anyway.
        if self.current.is_some() || !name.is_empty() {
            lines.word(self.word);
            lines.word(name);
            lines.end()?;
        }
        self.current = Some(label);
        Ok(())
    }
}

/// Writer of the statements that apply to the following faces.
struct FaceChanges<'a> {
    labels: [Changes<'a>; 2],
    /// Smoothing group in effect.
    smoothing: u32,
}

impl FaceChanges<'_> {
    fn write(&mut self, mesh: &Mesh, face: usize, lines: &mut LineWriter) -> io::Result<()> {
        for change in &mut self.labels {
            change.write(face, lines)?;
        }
        let group = mesh.smoothing().map_or(0, |groups| groups.values[face] as u32);
        if group != self.smoothing {
            self.smoothing = group;
            lines.word("s");
            match group {
                0 => lines.word("off"),
                group => lines.integer(group as usize),
            }
            lines.end()?;
        }
        Ok(())
    }
}

/// Writes the faces; `vertices` replaces the mesh's vertices if they are split.
fn write_faces(
    mesh: &Mesh,
    vertices: Option<&[[u32; 3]]>,
    uvs: &UvNumbers,
    normals: &ValueNumbers,
    mut changes: FaceChanges,
    lines: &mut LineWriter,
) -> io::Result<()> {
    let corners = mesh.attributes.as_ref().map(|attributes| &attributes.corners);
    for (i, face) in mesh.faces.iter().enumerate() {
        changes.write(mesh, i, lines)?;
        let uvs = uvs.of_face(mesh, i);
        lines.word("f");
        let own = vertices.map_or(face.map(|v| v.0), |vertices| vertices[i]);
        for (corner, vertex) in own.into_iter().enumerate() {
            lines.integer(vertex as usize + 1);
            let number = |pool: &ValueNumbers| {
                let wedge = corners?[i][corner];
                Some(pool.of_wedge.as_ref()?[wedge.index()] as usize)
            };
            let (uv, normal) = (number(uvs), number(normals));
            if uv.is_some() || normal.is_some() {
                lines.glue('/', uv);
            }
            if normal.is_some() {
                lines.glue('/', normal);
            }
        }
        lines.end()?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::obj::{read, write_mtl};

    fn written(scene: &Scene, precision: Precision, library: Option<&str>) -> String {
        let mut out = Vec::new();
        let libraries: Vec<String> = library.into_iter().map(str::to_owned).collect();
        write(scene, precision, &mut out, &libraries).unwrap();
        String::from_utf8(out).unwrap()
    }

    const TWO: &str = "mtllib two.mtl\n\
        v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 1 1 0 0 1 0\nv 0 1 0 0 0 1\n\
        vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 0.5 0.25\n\
        vn 0 0 1\n\
        o first\nusemtl red\n\
        f 1/1/1 2/2/1 3/3/1\n\
        o second\nusemtl wood grain\n\
        f 1/5/1 3/3/1 4/4/1\n";

    fn resolve(name: &str) -> Option<Vec<u8>> {
        match name {
            "two.mtl" => Some(
                b"newmtl red\nKd 1 0 0\nd 1\nnewmtl wood grain\nKd 1 1 1\nd 0.5\nmap_Kd w.png\n"
                    .to_vec(),
            ),
            "w.png" => Some(b"\x89PNG".to_vec()),
            _ => None,
        }
    }

    #[test]
    fn what_was_read_is_written_as_it_was() {
        let scene = read(TWO.as_bytes(), &mut resolve).unwrap();
        let again = written(&scene, Precision::F32, Some("two.mtl"));
        // The pools come in the order of wedges.
        let sorted = |text: &str| {
            let mut lines: Vec<String> =
                text.lines().filter(|l| !l.starts_with('f')).map(str::to_owned).collect();
            lines.sort();
            lines
        };
        assert_eq!(sorted(&again), sorted(TWO));
        let mut library = Vec::new();
        write_mtl(&scene, &mut library).unwrap();
        assert_eq!(String::from_utf8(library).unwrap().as_bytes(), resolve("two.mtl").unwrap());
        let twice = read(again.as_bytes(), &mut resolve).unwrap();
        assert_eq!(twice.meshes[0].mesh, scene.meshes[0].mesh);
        assert_eq!(twice.materials, scene.materials);
    }

    #[test]
    fn smoothing_groups_come_back() {
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n\
            f 1 2 3\ns 4294967295\nf 1 2 4\nf 1 3 4\ns off\nf 2 3 4\n";
        let scene = read(text.as_bytes(), &mut |_| None).unwrap();
        assert!(scene.notes.is_empty());
        let most = f64::from(u32::MAX);
        let groups = &scene.meshes[0].mesh.smoothing().unwrap().values;
        assert_eq!(*groups, [0.0, most, most, 0.0]);
        assert_eq!(written(&scene, Precision::F32, None), text);
    }

    #[test]
    fn a_bare_mesh_is_bare() {
        let scene = read(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", &mut |_| None).unwrap();
        let text = written(&scene, Precision::F32, None);
        assert_eq!(text, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    }

    #[test]
    fn normals_without_uvs_have_two_slashes() {
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n";
        let scene = read(text.as_bytes(), &mut |_| None).unwrap();
        assert_eq!(written(&scene, Precision::F64, None), text);
    }

    proptest! {
        #[test]
        fn positions_come_back(
            points in prop::array::uniform3(prop::array::uniform3(-1e30_f64..1e30)),
        ) {
            let mut text = String::new();
            for [x, y, z] in points {
                text += &format!("v {x} {y} {z:e}\n");
            }
            let scene = read((text + "f 1 2 3").as_bytes(), &mut |_| None).unwrap();
            let mesh = &scene.meshes[0].mesh;
            prop_assert_eq!(&mesh.positions[..], &points);
            let long = read(written(&scene, Precision::F64, None).as_bytes(), &mut |_| None);
            prop_assert_eq!(&long.unwrap().meshes[0].mesh, mesh);
            let short = written(&scene, Precision::F32, None);
            let again = read(short.as_bytes(), &mut |_| None).unwrap();
            for (a, b) in again.meshes[0].mesh.positions.iter().zip(&points) {
                prop_assert_eq!(a.map(|x| x as f32), b.map(|x| x as f32));
            }
            prop_assert_eq!(written(&again, Precision::F32, None), short);
        }
    }
}
